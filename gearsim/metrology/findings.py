"""Findings: what a gear engineer must be told, with depth and place."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.deviation import Crossing, Deviation
from gearsim.metrology.samples import SampleGrid
from gearsim.surfaces.blank import BevelBlank
from gearsim.surfaces.part import Part, Tolerance

_SEEN_MM = 1e-5
_DEEPER_MM = 1e-6


@dataclass(frozen=True)
class Finding:
    """``depth_um`` (negative: cut into the tooth; positive: material left; None: a collision, whatever its
    depth, or no length) at ``place_mm``, the part's frame.

    Cone distance and height above the root are None off a gear blank. ``fails``: beyond the scene's tolerance.
    """

    kind: str
    patch: str
    depth_um: float | None
    place_mm: tuple[float, float, float]
    cone_distance_mm: float | None
    height_mm: float | None
    fails: bool
    text: str

    @property
    def told(self) -> str:
        """Text and depth, without the place."""
        return self.text if self.depth_um is None else f"{self.text} ({self.depth_um:+.4g} um)"


def cross_cut(grid: SampleGrid, strangers: Deviation, tolerance: Tolerance | None) -> Iterator[Finding]:
    """The deepest cut of operations that are not meant for this surface."""
    worst = _deepest(grid, strangers)
    if worst is not None:
        beyond = _beyond(strangers, worst[0])
        text = f"another pass cuts the {grid.patch.name} surface beyond its intended form{beyond}"
        yield _finding("cross_cut", grid, *worst, tolerance, text)


def deeper_than_last(grid: SampleGrid, whole: Deviation, last: Deviation) -> Iterator[Finding]:
    """Where the rest of the program cuts deeper than the operation that was to finish the surface."""
    depth = np.nan_to_num(whole.value - last.value).ravel()
    i = int(np.argmin(depth))
    if depth[i] <= -_DEEPER_MM:
        text = f"another operation cuts the {grid.patch.name} surface deeper than the last one"
        yield _finding("cross_cut", grid, i, 1e3 * float(depth[i]), None, text)


def rapid_cut(blank: BevelBlank | None, place: NDArray, rays: int, name: str) -> Finding:
    """The first place where a rapid move, called ``name``, touches material: it fails, whatever the depth."""
    text = f"{name} touches material: it cuts {rays} rays that look at the blank"
    return _place("rapid_cut", "blank", blank, place, None, True, text)


def holder_cut(blank: BevelBlank | None, place: NDArray, rays: int, depth: float, name: str, where: str) -> Finding:
    """Where a holder, called ``name``, first touches material, and how deep [mm]: it fails, whatever the depth."""
    text = f"{name} touches material {where}: it cuts {depth:.3g} mm deep into what stands on {rays} rays"
    return _place("holder_cut", "part", blank, place, None, True, text)


def body_hit(part: Part, body: str, place: NDArray, depth: float, name: str, where: str) -> Finding:
    """Where a tool's body, called ``name``, first hits a machine's, and how deep [mm] under its surface it goes."""
    text = f"{name} hits the {body} {where}: it goes {depth:.3g} mm deep into it"
    return _place("machine_hit", body, _blank(part), place, None, True, text)


def axis_beyond(part: Part, kind: str, tip: NDArray, text: str) -> Finding:
    """An axis beyond its travel or faster than it goes, and where the tool's tip is then."""
    return _place(kind, "machine", _blank(part), tip, None, True, text)


def through_material(part: Part, place: NDArray, depth_um: float, name: str) -> Finding:
    """The first place where a rapid move, called ``name``, goes through material that stands before it."""
    text = f"{name} goes through material, {1e-3 * depth_um:.4g} mm of it along a ray"
    return _place("rapid_cut", "blank", _blank(part), place, None, True, text)


def stock_out_of_tolerance(part: Part, surface: str, place: NDArray, depth_um: float) -> Finding:
    """The worst end of a whole stock's rays near a surface, on one side."""
    what = "too much is left of" if depth_um > 0.0 else "too much is taken from"
    text = f"{what} the {surface} surface somewhere on the whole part"
    return _place("stock_out_of_tolerance", surface, _blank(part), place, depth_um, True, text)


def beyond_the_blank(part: Part, surface: str, place: NDArray, depth_um: float) -> Finding:
    """An intended surface that lies outside of what it is to be cut from."""
    text = f"the blank does not hold the {surface} surface, and ends short of it"
    return _place("beyond_the_blank", surface, _blank(part), place, depth_um, True, text)


def _blank(part: Part) -> BevelBlank | None:
    return next((s.patch.blank for s in part.surfaces.values()), None)


def off_the_blank(patch: str, blank: BevelBlank, place: NDArray, depth_um: float | None, text: str) -> Finding:
    """An intended surface that is not what its blank or the scene demands."""
    return _place("off_the_blank", patch, blank, place, depth_um, True, text)


def root_findings(
    patches: Sequence[tuple[SampleGrid, Deviation]], tolerances: Sequence[Tolerance | None]
) -> list[Finding]:  # fmt: skip
    """The deepest cut and the most material left, over fillets and bottom land with a tolerance each."""
    found = []
    cuts = [(k, worst) for k, patch in enumerate(patches) if (worst := _deepest(*patch)) is not None]
    if cuts:
        k, (i, depth) = min(cuts, key=lambda c: c[1][1])
        text = f"the {_where(patches[k][0])} is overcut{_beyond(patches[k][1], i)}"
        found.append(_finding("root_cut", patches[k][0], i, depth, tolerances[k], text))
    return found + _most_left(patches, tolerances)


def _most_left(
    patches: Sequence[tuple[SampleGrid, Deviation]], tolerances: Sequence[Tolerance | None]
) -> list[Finding]:
    """The most material left; where a limit is set, what lies within it needs no pass of its own and is not told.

    Where a limit is set an uncut sample is beyond it: how much stands there is not known.
    """
    limits = [inf if t is None else t.excess_um for t in tolerances]
    heights = [_height(deviation, grid) for grid, deviation in patches]
    unknown = [(d.crossing.ravel() == Crossing.UNCUT) & (x < inf) for (_, d), x in zip(patches, limits, strict=True)]
    worst = [np.where(u, inf, h) for u, h in zip(unknown, heights, strict=True)]
    k = max(range(len(patches)), key=lambda k: float(worst[k].max()))
    i = int(np.argmax(worst[k]))
    depth = 1e3 * float(heights[k][i])
    if depth <= 0.0 or (depth <= limits[k] < inf and not unknown[k][i]):
        return []
    text = f"stock is left on the {_where(patches[k][0])}{_beyond(patches[k][1], i)}; it takes a pass of its own"
    tolerance = Tolerance.both(0.0) if unknown[k][i] else tolerances[k]
    return [_finding("root_stock", patches[k][0], i, depth, tolerance, text)]


def stock_left(grid: SampleGrid, deviation: Deviation, tolerance: Tolerance | None) -> Iterator[Finding]:
    """The most material left where overcut alone is limited, beyond that limit: it fails nothing and is known."""
    um = 1e3 * _height(deviation, grid)
    i = int(np.argmax(um))
    if tolerance is not None and tolerance.excess_um == inf and um[i] > tolerance.overcut_um:
        text = f"stock is left on the {_where(grid)}{_beyond(deviation, i)}, which no tolerance limits"
        yield _finding("stock_left", grid, i, float(um[i]), tolerance, text)


def out_of_tolerance(
    grid: SampleGrid, deviation: Deviation, tolerance: Tolerance | None, how: str
) -> Iterator[Finding]:
    """Samples without a measured value, and the value farthest out of the tolerance; ``how`` they came about.

    Those that are uncut are no fault where nothing limits what is left: `stock_left` tells of them.
    """
    any_left = tolerance is not None and tolerance.excess_um == inf
    crossing, what = deviation.crossing.ravel(), f"the {grid.patch.name} surface"
    for kind, state in ((Crossing.UNCUT, "uncut"), (Crossing.THROUGH, "through")):
        where = np.flatnonzero(crossing == kind)
        if len(where) and not (kind == Crossing.UNCUT and any_left):
            window = 1e3 * (grid.outward if kind == Crossing.UNCUT else -grid.inward).ravel()
            i = int(where[np.argmax(np.abs(window[where]))])
            text = f"{len(where)} samples of {what} are {state} {how}: beyond the measuring window"
            yield _finding(state, grid, i, float(window[i]), Tolerance.both(0.0), text)
    if tolerance is None:
        return
    um = np.where(np.isfinite(deviation.value), 1e3 * deviation.value, 0.0).ravel()
    i = int(np.argmax(np.maximum(um - tolerance.excess_um, -tolerance.overcut_um - um)))
    if not tolerance.allows(um[i]):
        yield _finding("out_of_tolerance", grid, i, float(um[i]), tolerance, f"{what} is out of tolerance {how}")


def _deepest(grid: SampleGrid, deviation: Deviation) -> tuple[int, float] | None:
    """Index and depth [um] of the deepest overcut, or None where there is none worth telling."""
    depth = np.where(deviation.crossing == Crossing.THROUGH, -grid.inward, np.nan_to_num(deviation.value))
    i = int(np.argmin(depth))
    return (i, 1e3 * float(depth.ravel()[i])) if depth.ravel()[i] < -_SEEN_MM else None


def _height(deviation: Deviation, grid: SampleGrid) -> NDArray:
    """Material left [mm], at least, flat."""
    uncut = deviation.crossing == Crossing.UNCUT
    return np.where(uncut, grid.outward, np.nan_to_num(deviation.value)).ravel()


def _beyond(deviation: Deviation, i: int) -> str:
    """That a depth is the measuring window's, which is no more than a bound."""
    bounds = (Crossing.UNCUT, Crossing.THROUGH)
    return " beyond the measuring window" if deviation.crossing.ravel()[i] in bounds else ""


def _where(grid: SampleGrid) -> str:
    return "bottom land" if grid.patch.name == "bottom" else grid.patch.name


def _finding(kind: str, grid: SampleGrid, i: int, depth_um: float, tolerance: Tolerance | None, text: str) -> Finding:
    point = grid.point.reshape(-1, 3)[i]
    fails = tolerance is not None and not tolerance.allows(depth_um)
    return _place(kind, grid.patch.name, grid.patch.blank, point, depth_um, fails, text)


def _place(
    kind: str, patch: str, blank: BevelBlank | None, point: NDArray, depth_um: float | None, fails: bool, text: str
) -> Finding:
    x, y, z = (float(c) for c in point)
    if blank is None:
        return Finding(kind, patch, depth_um, (x, y, z), None, None, fails, text)
    cone, height = blank.cone_height(point)
    above_root = float(height + blank.dedendum_at(cone))
    return Finding(kind, patch, depth_um, (x, y, z), float(cone), above_root, fails, text)
