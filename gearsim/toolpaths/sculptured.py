"""3-axis passes over a NURBS surface that follow contact points: CC to CL. The tool touches there; it may gouge.

The tool axis is +z. Passes run along u or v; the other parameter is spaced evenly so that no two neighbours are farther
apart than the stepover. Between two locations the tip runs straight; where such a step would lie deeper than the
surface allows, along the normal, by more than the tolerance, a location is put in between. It is looked at in its
quarters: a depth that bends one way is nowhere more than 1.5 times as large.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.contact import ANGLE, locate
from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.motion.sources import CLMotion
from gearsim.surfaces.nurbs import NurbsSurface
from gearsim.toolpaths.counts import check_count, check_points

AXIS = np.array([0.0, 0.0, 1.0])
_ROUNDS = 10
_PROBES = 33
_LOOKS = (0.25, 0.75, 0.5)


class Touches(NamedTuple):
    """Tools that touch a surface: parameters (n,), contact points and unit normals (n, 3), tips (n, 3) [mm].

    ``lift``: unit directions (n, 3) in which a tip must not lie lower. Tips are nan where there is no contact.
    """

    u: NDArray
    v: NDArray
    point: NDArray
    normal: NDArray
    tip: NDArray
    lift: NDArray


@dataclass(frozen=True)
class SculpturedPath:
    """Passes with the tool axis +z; ``line`` (n,) numbers the pass of every location, ``place`` (n,) rises along it.

    ``chord`` [mm] bounds how much deeper than the surface allows the worst step lies.
    """

    line: NDArray[np.integer]
    place: NDArray
    touches: Touches
    chord: float

    def __len__(self) -> int:
        return len(self.line)

    @property
    def runs(self) -> list[NDArray[np.integer]]:
        """Indices of the locations of each run of at least two: a pass, parted where there is no contact."""
        exists = np.isfinite(self.touches.tip[:, 0])
        new = np.ones(len(self), dtype=bool)
        new[1:] = (self.line[1:] != self.line[:-1]) | ~exists[1:] | ~exists[:-1]
        parts = np.split(np.arange(len(self)), np.flatnonzero(new)[1:])
        return [p for p in parts if len(p) > 1]

    def motions(self) -> list[CLMotion]:
        """One motion a run; the ways between runs lie off the part. Raises InputError where there is none."""
        tips = [self.touches.tip[run] for run in self.runs]
        if not tips:
            raise InputError("the cutter touches the surface nowhere along the toolpath: is the surface's normal up?")
        return [CLMotion(t, np.broadcast_to(AXIS, t.shape)) for t in tips]


def contact_path(
    surface: NurbsSurface, cutter: Profile, stepover: float, points: int = 65, *, along: Literal["u", "v"] = "u",
    margin: float = 0.0, tolerance: float = 1e-4,
) -> SculpturedPath:  # fmt: skip
    """Passes through contact points.

    ``points`` a pass to begin with; ``margin``: the share of the domain left free at every edge; ``tolerance`` [mm]:
    see the module. Raises InputError for a cutter that is not convex or a stepover that is not positive.
    """
    count = line_count(surface, stepover, along, margin)
    check_points(count * points)
    across = np.linspace(margin, 1.0 - margin, count)

    def touch(line: NDArray, place: NDArray) -> Touches:
        shares = (place, across[line]) if along == "u" else (across[line], place)
        u, v = surface.locate(*shares)
        jet = surface.jet(u, v)
        from_above = jet.normal[:, 2:] >= -ANGLE
        tip = np.where(from_above, locate(cutter, jet.r, jet.normal).tip, np.nan)
        return Touches(u, v, jet.r, jet.normal, tip, jet.normal)

    line = np.repeat(np.arange(count), points)
    place = np.tile(np.linspace(margin, 1.0 - margin, points), count)
    return refined(touch, line, place, tolerance)


def refined(
    touch: Callable[[NDArray, NDArray], Touches], line: NDArray, place: NDArray, tolerance: float
) -> SculpturedPath:
    """A path through the places of its lines, more of them where straight steps would cut too deep."""
    found = touch(line, place)
    fresh = np.ones(len(line), dtype=bool)  # whether the step from a location to the next is still to be looked at
    worst = 0.0
    for last in (*[False] * _ROUNDS, True):
        step = np.flatnonzero((line[1:] == line[:-1]) & fresh[:-1])
        depth, middle = np.zeros(len(step)), found
        for share in _LOOKS:
            at = place[step] + share * (place[step + 1] - place[step])
            between = touch(line[step], at)
            chord = found.tip[step] + share * (found.tip[step + 1] - found.tip[step])
            deeper = 1.5 * np.nan_to_num(np.einsum("ni,ni->n", between.tip - chord, between.lift))
            depth = np.maximum(depth, deeper)
            middle = between if share == 0.5 else middle
        bad = (depth > tolerance) & (not last)
        worst = max(worst, float(np.max(depth[~bad], initial=0.0)))
        if not bad.any():
            return SculpturedPath(line, place, found, worst)
        check_points(len(line) + bad.sum())
        order = np.argsort(np.concatenate([np.arange(len(line)), step[bad] + 0.5]), kind="stable")
        fresh[:] = False
        fresh[step[bad]] = True
        fresh = np.concatenate([fresh, np.ones(int(bad.sum()), dtype=bool)])[order]
        half = 0.5 * (place[step[bad]] + place[step[bad] + 1])
        line, place = np.concatenate([line, line[step[bad]]])[order], np.concatenate([place, half])[order]
        found = Touches(*(np.concatenate([a, b[bad]])[order] for a, b in zip(found, middle, strict=True)))
    raise AssertionError


def line_count(surface: NurbsSurface, stepover: float, along: str, margin: float) -> int:
    """How many passes keep neighbours within the stepover [mm]: by the longest step between even places across."""
    if not stepover > 0.0:
        raise InputError(f"stepover must be above 0 mm, got {stepover:g}")
    share = np.linspace(margin, 1.0 - margin, _PROBES)
    one, other = np.meshgrid(share, share, indexing="ij")
    shares = (one, other) if along == "v" else (other, one)
    u, v = surface.locate(*shares)
    r = surface.jet(u.ravel(), v.ravel()).r.reshape(_PROBES, _PROBES, 3)
    fastest = float(np.max(np.linalg.norm(np.diff(r, axis=0), axis=2))) * (_PROBES - 1)
    check_count(fastest, stepover)
    return max(2, int(np.ceil(fastest / stepover)) + 1)
