"""Where rays meet the closed-form classes of the machined surface, before trimming."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.element import Element
from gearsim.cutters.profile import Profile
from gearsim.envelope.crossings import Crossings, Kind, together
from gearsim.envelope.poses import BEYOND
from gearsim.envelope.seeds import Seeds, distinct, edge_seeds, joined, standing_tools, with_neighbours
from gearsim.envelope.swept import Chart, Guess, Solved, Swept
from gearsim.geometry.rays import RayBundle
from gearsim.kernels.crossing import Rays

_WALKS = 8
_STEPS = 30
_JOINT_SLACK = 1e-3
_EDGE_SLACK = 1e-9
_WIDE = 8.0


class Candidates:
    """Finds the crossings of every class of one motion of one cutter."""

    def __init__(self, swept: Swept) -> None:
        self.swept = swept
        self._seeds = Seeds(swept)

    def along(self, rays: RayBundle, thorough: bool = False) -> Crossings:
        """Crossings of every class inside the rays' windows.

        Looks near the rays' origins, where a measured surface lies; ``thorough`` looks along the whole windows.
        """
        if not len(rays):
            return together([])
        loaded = self.swept.rays(rays)
        closest = self._seeds.closest(rays) if thorough else None
        found, at_joints = self._envelope(rays, loaded, closest)
        if thorough:
            at_joints = standing_tools(rays, self.swept)
        parts = [found, self._poses(loaded, at_joints)]
        edges = _circles(self.swept.cutter, thorough)
        if edges:
            parts.append(self._edges(rays, loaded, edges, closest))
        every = together(parts)
        inside = (every.tau >= rays.start[every.ray]) & (every.tau <= rays.end[every.ray])
        return Crossings(*(column[inside] for column in every))

    def _envelope(
        self, rays: RayBundle, loaded: Rays, closest: tuple[Guess, NDArray] | None
    ) -> tuple[Crossings, tuple[NDArray, NDArray]]:
        """ENVELOPE crossings, and the (ray, joint) pairs where a contact may have run off its piece.

        A thorough search starts from the ``closest`` poses, too.
        """
        thorough, pieces = closest is not None, self.swept.source.pieces
        seeds = distinct(self._seeds.envelope(rays, thorough), thorough)
        walked = self.swept.solve(loaded, Chart.ENVELOPE, seeds, _WALKS, walk=True).at
        if closest is not None:
            walked = joined([closest[0], walked])
        guess = distinct(with_neighbours(walked, pieces, BEYOND), thorough)
        solved = self.swept.solve(loaded, Chart.ENVELOPE, guess, _STEPS)
        at = solved.at
        early, late = ~solved.settled | (at.t < _JOINT_SLACK), ~solved.settled | (at.t > 1.0 - _JOINT_SLACK)
        ray = np.concatenate([at.ray[early], at.ray[late]])
        joint = np.concatenate([at.piece[early], at.piece[late] + 1])
        found = [_on_the_profile(self.swept.cutter, solved)]
        if thorough:
            found += [self._folded(rays, loaded, kind) for kind in (Chart.ARC, Chart.DISC, Chart.LINE)]
        return together(found), (ray, joint)

    def _folded(self, rays: RayBundle, loaded: Rays, chart: Chart) -> Crossings:
        """ENVELOPE crossings of one kind of element in the chart that is regular where the usual one folds."""
        kind = {Chart.ARC: "arc", Chart.DISC: "flat", Chart.LINE: "line"}[chart]
        elements = [i for i, e in enumerate(self.swept.cutter.elements) if e.kind == kind]
        if not elements:
            return together([])
        solved = self._solve_angles(loaded, chart, self._seeds.angles(rays, chart, elements))
        return _on_the_profile(self.swept.cutter, solved)

    def _edges(
        self, rays: RayBundle, loaded: Rays, edges: tuple[int, ...], closest: tuple[Guess, NDArray] | None
    ) -> Crossings:
        """EDGE crossings: circles of the profile swept along the motion; thorough ones start from ``closest`` poses."""
        if closest is None:
            seeds = self._seeds.circles(rays, edges)
        else:
            seeds = joined([edge_seeds(self.swept, edges, *closest), self._seeds.angles(rays, Chart.CIRCLE, edges)])
        solved = self._solve_angles(loaded, Chart.CIRCLE, seeds)
        good = solved.settled & _within(solved.at.t, 1.0)
        at, n = solved.at, int(good.sum())
        return Crossings(
            at.ray[good], solved.tau[good], np.full(n, Kind.EDGE), at.piece[good], at.t[good],
            np.full(n, -1), np.full(n, np.nan), np.zeros(n),
        )  # fmt: skip

    def _solve_angles(self, loaded: Rays, chart: Chart, seeds: Guess) -> Solved:
        """Newton's method on a chart over (t, angle about the axis)."""
        cutter = self.swept.cutter
        guess = with_neighbours(seeds, self.swept.source.pieces, BEYOND)
        guess = distinct(guess, fine=True, scale=max(1.0, cutter.max_radius / _WIDE))
        return self.swept.solve(loaded, chart, guess, _STEPS)

    def _poses(self, loaded: Rays, near: tuple[NDArray, NDArray]) -> Crossings:
        """JOINT and PATH_END crossings at the given (ray, joint) pairs; joint i is where piece i begins."""
        pieces = self.swept.source.pieces
        ray, joint = np.divmod(np.unique(near[0].astype(np.int64) * (pieces + 1) + near[1]), pieces + 1)
        standing = self.swept.standing(loaded, ray, joint)
        ray, joint = ray[standing.pair], joint[standing.pair]
        first, last = joint == 0, joint == pieces
        lowest = ((standing.before <= 1e-9) | first) & ((standing.after >= -1e-9) | last)
        ray, joint, first, last = (c[lowest] for c in (ray, joint, first, last))
        n = len(ray)
        return Crossings(
            ray, standing.tau[lowest], np.where(first | last, Kind.PATH_END, Kind.JOINT),
            np.where(last, joint - 1, joint), np.where(last, 1.0, 0.0),
            np.full(n, -1), np.full(n, np.nan), np.zeros(n),
        )  # fmt: skip


def _circles(cutter: Profile, thorough: bool) -> tuple[int, ...]:
    """Sharp edges of the profile; if ``thorough``, the rims of its discs and annuli too.

    A disc that slides in its own plane has no grazing point, and its rim sweeps what it leaves.
    """
    flats = [i for i, e in enumerate(cutter.elements) if e.is_flat] if thorough else []
    rims = [i for i in flats if cutter.elements[i].end[0] > 0.0]
    rims += [(i - 1) % len(cutter.elements) for i in flats if cutter.elements[i].start[0] > 0.0]
    return tuple(sorted({*cutter.edges, *rims}))


def _on_the_profile(cutter: Profile, solved: Solved) -> Crossings:
    """The settled solutions that lie on their piece of the path and their element of the profile.

    Past the axis a ball's arc or a disc runs back over itself: such places are turned back onto the element.
    """
    at = solved.at
    length = np.array([e.length for e in cutter.elements])[at.element]
    starts, ends = np.array([_on_the_axis(e) for e in cutter.elements])[at.element].T
    s = np.where(starts, np.abs(solved.s), solved.s)
    s = np.where(ends, length - np.abs(length - s), s)
    good = solved.settled & _within(at.t, 1.0) & _within(s, length)
    n = int(good.sum())
    return Crossings(
        at.ray[good], solved.tau[good], np.full(n, Kind.ENVELOPE), at.piece[good], at.t[good],
        at.element[good], s[good], at.branch[good],
    )  # fmt: skip


def _on_the_axis(e: Element) -> tuple[bool, bool]:
    """Whether the element crosses the axis at right angles where it starts, and where it ends."""
    square = e.is_flat or (e.is_arc and abs(e.centre[0]) < 1e-12)
    return square and e.start[0] < 1e-12, square and e.end[0] < 1e-12


def _within(value: NDArray, length: NDArray | float) -> NDArray:
    return (value >= -_EDGE_SLACK) & (value <= length + _EDGE_SLACK)
