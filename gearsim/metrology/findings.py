"""Findings: what a gear engineer must be told, with depth and place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.bevel import FlankResult, PatchResult
from gearsim.metrology.deviation import Crossing, Deviation
from gearsim.metrology.rapid_check import RapidTouch
from gearsim.metrology.samples import SampleGrid
from gearsim.metrology.surface import SurfaceResult
from gearsim.surfaces.blank import BevelBlank

_SEEN_MM = 1e-5


@dataclass(frozen=True)
class Finding:
    """``depth_um`` (negative: cut into the tooth; positive: material left; None: a collision, whatever its
    depth) at ``place_mm``, gear frame.

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


def flank_findings(flank: FlankResult, tolerance_um: float) -> list[Finding]:
    """Cross-cuts by other passes, and what is out of tolerance after all passes."""
    found = []
    if flank.others is not None:
        worst = _deepest(flank.grid, flank.others)
        if worst is not None:
            text = f"another pass cuts the {flank.side} flank beyond its intended surface"
            found.append(_finding("cross_cut", flank.grid, *worst, tolerance_um, text))
    what = f"the {flank.side} flank", "after all passes"
    return found + _out_of_tolerance(flank.grid, flank.all_passes, tolerance_um, what)


def rapid_findings(touch: RapidTouch | None, blank: BevelBlank | None, name: str) -> list[Finding]:
    """The first place where a rapid move, called ``name``, touches material: it fails, whatever the depth."""
    if touch is None:
        return []
    text = f"{name} touches material: it cuts {touch.rays} rays that look at the blank"
    return [_place("rapid_cut", "blank", blank, touch.place, None, True, text)]


def root_findings(patches: Sequence[PatchResult], tolerance_um: float) -> list[Finding]:
    """The deepest cut and the most material left, over fillets and bottom land."""
    found = []
    cuts = [(p, worst) for p in patches if (worst := _deepest(p.grid, p.deviation)) is not None]
    if cuts:
        patch, (i, depth) = min(cuts, key=lambda c: c[1][1])
        text = f"the {_where(patch.grid)} is overcut"
        found.append(_finding("root_cut", patch.grid, i, depth, tolerance_um, text))
    left = [(p, int(np.argmax(_height(p.deviation, p.grid)))) for p in patches]
    patch, i = max(left, key=lambda c: _height(c[0].deviation, c[0].grid)[c[1]])
    depth = 1e3 * float(_height(patch.deviation, patch.grid)[i])
    if depth <= 0.0:
        return found
    text = f"stock is left on the {_where(patch.grid)}; it takes a pass of its own"
    found.append(_finding("root_stock", patch.grid, i, depth, np.inf, text))
    return found


def surface_findings(surface: SurfaceResult, judged: Sequence[str], tolerance_um: float) -> list[Finding]:
    """What is out of tolerance on a generated surface under the judged motions."""
    found: list[Finding] = []
    for name in judged:
        what = f"the {surface.grid.patch.name} surface", f"under the motion {name}"
        found += _out_of_tolerance(surface.grid, surface.deviations[name], tolerance_um, what)
    return found


def _out_of_tolerance(
    grid: SampleGrid, deviation: Deviation, tolerance_um: float, what: tuple[str, str]
) -> list[Finding]:
    """Samples without a measured value, and the largest value if it is beyond the tolerance."""
    found = []
    crossing = deviation.crossing.ravel()
    for kind, state in ((Crossing.UNCUT, "uncut"), (Crossing.THROUGH, "through")):
        where = np.flatnonzero(crossing == kind)
        if len(where):
            window = 1e3 * (grid.outward if kind == Crossing.UNCUT else -grid.inward).ravel()
            i = int(where[np.argmax(np.abs(window[where]))])
            text = f"{len(where)} samples of {what[0]} are {state} {what[1]}: beyond the measuring window"
            found.append(_finding(state, grid, i, float(window[i]), 0.0, text))
    um = np.where(np.isfinite(deviation.value), 1e3 * deviation.value, 0.0).ravel()
    i = int(np.argmax(np.abs(um)))
    if abs(um[i]) > tolerance_um:
        text = f"{what[0]} is out of tolerance {what[1]}"
        found.append(_finding("out_of_tolerance", grid, i, float(um[i]), tolerance_um, text))
    return found


def _deepest(grid: SampleGrid, deviation: Deviation) -> tuple[int, float] | None:
    """Index and depth [um] of the deepest overcut, or None where there is none worth telling."""
    depth = np.where(deviation.crossing == Crossing.THROUGH, -grid.inward, np.nan_to_num(deviation.value))
    i = int(np.argmin(depth))
    return (i, 1e3 * float(depth.ravel()[i])) if depth.ravel()[i] < -_SEEN_MM else None


def _height(deviation: Deviation, grid: SampleGrid) -> NDArray:
    """Material left [mm], at least, flat."""
    uncut = deviation.crossing == Crossing.UNCUT
    return np.where(uncut, grid.outward, np.nan_to_num(deviation.value)).ravel()


def _where(grid: SampleGrid) -> str:
    return "bottom land" if grid.patch.name == "bottom" else grid.patch.name


def _finding(kind: str, grid: SampleGrid, i: int, depth_um: float, tolerance_um: float, text: str) -> Finding:
    point = grid.point.reshape(-1, 3)[i]
    fails = abs(depth_um) > tolerance_um
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
