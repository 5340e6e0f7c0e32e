"""Drop-cutter: the tool, its axis +z, is lowered at places (x, y) until it touches the surface. It cannot gouge.

At (x, y) the tip's height is the largest lift of any surface point p: p_z less the height of the tool's underside at
the point's distance from the axis. The largest lift over a grid of points says where to look; there the tip's
place is a smooth function of the contact's (u, v), whose root at (x, y) Newton's method finds to rounding, rims of flat
mills included. Contacts on the surface's border, on a flat bottom or a cone's line are found by narrowing a window.
Every height is that of a point of the surface, so it can be too low by what the search missed, never too high.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.cutters.contact import locate
from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.surfaces.nurbs import NurbsSurface
from gearsim.toolpaths.counts import check_count, check_points
from gearsim.toolpaths.sculptured import AXIS, SculpturedPath, Touches, refined

_KEEP = 3  # places where a tool may touch that are looked into
_NEWTON = 12
_STILL = 1e-10  # of a grid step: what the next step of Newton's method would move is rounding
_SPREAD = 24  # starts about a pole
_SLOPE = 1e-6
_ROOT = 1e-9
_RIM = 1e-9
_TOGETHER = 32  # places looked at on one part of the grid


def underside(cutter: Profile, r: ArrayLike) -> NDArray:
    """Height [mm] of the tool's underside at distances r [mm] from its axis, any shape; inf beyond the tool."""
    r = np.asarray(r, dtype=float)
    z = np.full(r.shape, np.inf)
    for e in cutter.elements:
        first, last = e.start, e.end
        if e.is_arc:
            if e.angles[0] >= 0.0:
                break
            if e.angles[1] > 0.0:
                last = (e.centre[0] + e.radius, e.centre[1])
        if last[0] <= first[0]:
            break
        mine = (r >= first[0] - _RIM) & (r <= last[0] + _RIM)
        at = np.clip(r[mine], first[0], last[0])
        if e.is_arc:
            z[mine] = e.centre[1] - np.sqrt(np.maximum(e.radius**2 - (at - e.centre[0]) ** 2, 0.0))
        else:
            z[mine] = first[1] + (at - first[0]) / (last[0] - first[0]) * (last[1] - first[1])
    return z


def drop(surface: NurbsSurface, cutter: Profile, x: ArrayLike, y: ArrayLike, grid: int = 64) -> Touches:
    """The tool dropped at places x, y [mm], shape (n,), onto a surface; nan where it passes beside it.

    ``grid``: cells a side of the grid that says where to look. Raises InputError for a cutter that is not convex.
    """
    if not cutter.is_convex:
        raise InputError(f"cutter {cutter.name!r} is not convex: dropped, it may hook under the surface")
    place = np.column_stack(np.broadcast_arrays(np.ravel(x), np.ravel(y))).astype(float)
    search = _Search(surface, cutter, grid)
    best_u, best_v, best = search.highest(place)
    jet = surface.jet(np.nan_to_num(best_u, nan=search.u[0]), np.nan_to_num(best_v, nan=search.v[0]))
    tip = np.column_stack([place, best])
    touches = np.isfinite(best)[:, None]
    lift = np.broadcast_to(AXIS, tip.shape)
    point, normal, tip = (np.where(touches, values, np.nan) for values in (jet.r, jet.normal, tip))
    return Touches(best_u, best_v, point, normal, tip, lift)


def drop_path(
    surface: NurbsSurface, cutter: Profile, stepover: float, points: int = 65, *, along: Literal["x", "y"] = "x",
    tolerance: float = 1e-4,
) -> SculpturedPath:  # fmt: skip
    """Passes along x or y wherever the tool touches the surface inside its border; ``tolerance`` [mm] of the steps.

    ``points`` find where a pass begins and ends, and are then spread over it. Raises InputError where there is none.
    """
    if not stepover > 0.0:
        raise InputError(f"stepover must be above 0 mm, got {stepover:g}")
    net = surface.points.reshape(-1, 3)[:, :2]
    reach = 0.999 * cutter.max_radius
    low, high = net.min(axis=0) - reach, net.max(axis=0) + reach
    run = int(along == "y")
    check_count(float((high - low)[1 - run]), stepover)
    across = np.linspace(low[1 - run], high[1 - run], int(np.ceil((high - low)[1 - run] / stepover)) + 1)

    def touch(line: NDArray, place: NDArray) -> Touches:
        return drop(surface, cutter, *((across[line], place) if run else (place, across[line])))

    check_points(len(across) * points)
    line = np.repeat(np.arange(len(across)), points)
    place = np.tile(np.linspace(low[run], high[run], points), len(across))
    inside = _inside(surface, touch(line, place)).reshape(len(across), points)
    kept, first = np.flatnonzero(inside.any(axis=1)), np.argmax(inside, axis=1)
    if not len(kept):
        raise InputError("dropped, the cutter touches the surface nowhere inside its border: is the surface upright?")
    last = points - 1 - np.argmax(inside[:, ::-1], axis=1)
    places = place[:points]
    starts, ends = places[np.maximum(first - 1, 0)][kept], places[np.minimum(last + 1, points - 1)][kept]
    line, place = np.repeat(kept, points), np.linspace(starts, ends, points, axis=1).ravel()
    return refined(touch, line, place, tolerance)


def _inside(surface: NurbsSurface, touches: Touches) -> NDArray[np.bool_]:
    """Whether a tool touches the surface inside its border."""
    (u0, u1), (v0, v1) = surface.domain
    with np.errstate(invalid="ignore"):
        return (touches.u > u0) & (touches.u < u1) & (touches.v > v0) & (touches.v < v1)


class _Search:
    """The highest lift over one surface: a grid of its points, and the ways to a contact from a grid point."""

    def __init__(self, surface: NurbsSurface, cutter: Profile, cells: int):
        self.surface, self.cutter = surface, cutter
        share = np.linspace(0.0, 1.0, cells + 1)
        self.u, self.v = surface.locate(share, share)
        u, v = (a.ravel() for a in np.meshgrid(self.u, self.v, indexing="ij"))
        self.nodes = surface.jet(u, v).r.reshape(cells + 1, cells + 1, 3)
        self.step = np.array([self.u[1] - self.u[0], self.v[1] - self.v[0]])
        self.low, self.high = np.array([self.u[0], self.v[0]]), np.array([self.u[-1], self.v[-1]])

    def highest(self, place: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """u, v (nan) and height (-inf: none) of the contact at places (n, 2)."""
        if not len(place):
            return np.empty(0), np.empty(0), np.empty(0)
        owner, at = self._peaks(place)
        root = self._newton(place[owner], at)
        height = np.where(np.isfinite(root[:, 0]), self._lift(place[owner], np.nan_to_num(root, nan=0.5)), -np.inf)
        border = (at == self.low) | (at == self.high)
        lost = np.flatnonzero(~(height >= self._lift(place[owner], at)) & ~border.any(axis=1))  # no root, or no maximum
        root[lost], height[lost] = self._narrow(place[owner[lost]], at[lost], (0, 1))
        owners, roots, heights = [owner], [root], [height]
        for k in (0, 1):
            on = border[:, k]
            found, top = self._narrow(place[owner[on]], at[on], (1 - k,))
            owners, roots, heights = [*owners, owner[on]], [*roots, found], [*heights, top]
        return self._best(len(place), np.concatenate(owners), np.concatenate(roots), np.concatenate(heights))

    def _peaks(self, place: NDArray) -> tuple[NDArray, NDArray]:
        """Places and parameters (m, 2) of the highest grid points that no neighbour overtops."""
        found = []
        for begin in range(0, len(place), _TOGETHER):
            some = place[begin : begin + _TOGETHER]
            rows, columns = self._below(some)
            nodes = self.nodes[rows, columns]
            away = nodes[None, ..., :2] - some[:, None, None]
            lift = nodes[None, ..., 2] - underside(self.cutter, np.hypot(away[..., 0], away[..., 1]))
            owner, i, j = self._tops(lift)
            found.append((begin + owner, self.u[rows][i], self.v[columns][j]))
        owner, u, v = (np.concatenate(column) for column in zip(*found, strict=True))
        return self._off_poles(owner, np.column_stack([u, v]))

    def _below(self, place: NDArray) -> tuple[slice, slice]:
        """The part of the grid that holds all points under the tool at any of the places."""
        reach = self.cutter.max_radius + 2.0 * _RIM
        xy = self.nodes[..., :2]
        under = ((xy >= place.min(axis=0) - reach) & (xy <= place.max(axis=0) + reach)).all(axis=2)
        rows, columns = (np.flatnonzero(under.any(axis=axis)) for axis in (1, 0))
        if not len(rows):
            return slice(0, 1), slice(0, 1)
        return slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)

    @staticmethod
    def _tops(lift: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """Which place, row and column the highest points that no neighbour overtops have."""
        padded = np.pad(lift, ((0, 0), (1, 1), (1, 1)), constant_values=-np.inf)
        down = np.maximum(np.maximum(padded[:, :-2], padded[:, 1:-1]), padded[:, 2:])
        around = np.maximum(np.maximum(down[..., :-2], down[..., 1:-1]), down[..., 2:])
        owner, i, j = np.nonzero((lift >= around) & (lift > -np.inf))
        height = lift[owner, i, j]
        lowest = np.min([padded[owner, i + k, j + m] for k in range(3) for m in range(3)], axis=0)
        hopeful = height + (height - lowest) >= lift.max(axis=(1, 2))[owner]
        owner, i, j, height = (a[hopeful] for a in (owner, i, j, height))
        order = np.lexsort((-height, owner))
        owner, i, j = owner[order], i[order], j[order]
        rank = np.arange(len(owner)) - np.searchsorted(owner, owner)
        return owner[rank < _KEEP], i[rank < _KEEP], j[rank < _KEEP]

    def _lift(self, place: NDArray, at: NDArray) -> NDArray:
        r = self.surface.at(at[:, 0], at[:, 1])
        return r[:, 2] - underside(self.cutter, np.linalg.norm(r[:, :2] - place, axis=1))

    def _miss(self, place: NDArray, at: NDArray) -> NDArray:
        """The way (m, 2) from the places to the tips that touch at the given parameters."""
        jet = self.surface.jet(at[:, 0], at[:, 1])
        with np.errstate(invalid="ignore"):
            return locate(self.cutter, jet.r, jet.normal).tip[:, :2] - place

    def _newton(self, place: NDArray, start: NDArray) -> NDArray:
        """Parameters (m, 2) whose contact has its tip at the place; nan where Newton's method finds none."""
        at, left = start.copy(), np.arange(len(start))
        h = _SLOPE * (self.high - self.low)
        for _ in range(_NEWTON):
            if not len(left):
                break
            here, goal = at[left], place[left]
            miss = self._miss(goal, here)
            slopes = []
            for k in (0, 1):
                inward = np.where(here[:, k] + h[k] <= self.high[k], h[k], -h[k])
                aside = here.copy()
                aside[:, k] += inward
                slopes.append((self._miss(goal, aside) - miss) / inward[:, None])
            (a, c), (b, d) = slopes[0].T, slopes[1].T
            with np.errstate(divide="ignore", invalid="ignore"):
                move = -np.column_stack([d * miss[:, 0] - b * miss[:, 1], a * miss[:, 1] - c * miss[:, 0]])
                move /= (a * d - b * c)[:, None]
            move = np.clip(np.nan_to_num(move), -self.step, self.step)
            at[left] = np.clip(here + move, self.low, self.high)
            left = left[(np.abs(move) > _STILL * self.step).any(axis=1)]
        done = np.linalg.norm(self._miss(place, at), axis=1) <= _ROOT
        done &= np.all(np.abs(at - start) <= 3.0 * self.step, axis=1)
        return np.where(done[:, None], at, np.nan)

    def _narrow(self, place: NDArray, at: NDArray, free: tuple[int, ...]) -> tuple[NDArray, NDArray]:
        """Parameters and lift of the highest point near, by windows that shrink about the best of their points."""
        side, shrink, turns = np.linspace(-1.0, 1.0, 9 if len(free) == 1 else 5), 0.6, 42
        if len(free) == 1:
            shrink, turns = 0.3, 18
        offsets = np.zeros((len(side) ** len(free), 2))
        offsets[:, list(free)] = np.stack(np.meshgrid(*[side] * len(free), indexing="ij"), axis=-1).reshape(
            -1, len(free)
        )
        window, rows = self.step.copy(), np.arange(len(at))
        height = self._lift(place, at)
        for _ in range(turns):
            tried = np.clip(at[:, None] + window * offsets, self.low, self.high)
            lift = self._lift(np.repeat(place, len(offsets), axis=0), tried.reshape(-1, 2)).reshape(tried.shape[:2])
            best = np.argmax(lift, axis=1)
            better = lift[rows, best] > height
            at = np.where(better[:, None], tried[rows, best], at)
            height = np.where(better, lift[rows, best], height)
            window = shrink * window
        return at, height

    def _off_poles(self, owner: NDArray, at: NDArray) -> tuple[NDArray, NDArray]:
        """Candidates on a pole, which is one point, spread about it along the parameter that does not move it."""
        jet = self.surface.jet(at[:, 0], at[:, 1])
        moved = self.step * np.column_stack([np.linalg.norm(d, axis=1) for d in (jet.ru, jet.rv)])
        pole = moved <= _RIM * self.surface.size
        owners, places = [owner[~pole.any(axis=1)]], [at[~pole.any(axis=1)]]
        for k in (0, 1):
            first = np.unique(owner[pole[:, k]], return_index=True)[1]
            spread = np.repeat(at[pole[:, k]][first], _SPREAD, axis=0)
            around = np.linspace(self.low[k], self.high[k], _SPREAD)
            spread[:, k] = np.tile(around, len(first))
            spread[:, 1 - k] += np.sign(self.low + self.high - 2.0 * spread)[:, 1 - k] * 0.1 * self.step[1 - k]
            owners, places = [*owners, np.repeat(owner[pole[:, k]][first], _SPREAD)], [*places, spread]
        return np.concatenate(owners), np.concatenate(places)

    @staticmethod
    def _best(count: int, owner: NDArray, at: NDArray, height: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        u, v, top = np.full(count, np.nan), np.full(count, np.nan), np.full(count, -np.inf)
        order = np.argsort(height, kind="stable")
        u[owner[order]], v[owner[order]], top[owner[order]] = at[order, 0], at[order, 1], height[order]
        return u, v, top
