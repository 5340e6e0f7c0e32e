"""Ends of a whole stock's rays against what is intended: surfaces in all alike spaces, or a solid."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.closest import signed_distance
from gearsim.metrology.samples import SampleGrid
from gearsim.metrology.solid_difference import difference
from gearsim.simulation.stock import AXES, Stock
from gearsim.surfaces.faced_solid import FacedPart
from gearsim.surfaces.machined_solid import MachinedSolid
from gearsim.surfaces.part import NamedFaces

NEAR_MM = 0.5


class SurfaceFigures(NamedTuple):
    """Ends of the stock's rays near an intended surface, in all its spaces: how many, and the deepest and highest [mm].

    The two are not one figure: material left in one place makes up for none that is missing in another. nan: no ends.
    """

    surface: str
    ends: int
    overcut: float
    excess: float
    overcut_place: NDArray[np.floating]
    excess_place: NDArray[np.floating]


def near_surface(grid: SampleGrid, ends: NDArray, spaces: int = 1) -> SurfaceFigures:
    """Signed distances of a stock's cut ends within half a millimetre of an intended surface, in all alike spaces.

    ``ends`` [mm], shape (n, 3), are exact to the cut's tolerance; what lies between rays is not seen.
    """
    close, distance = near(grid, ends, spaces)
    return extremes(grid.patch.name, len(close), ends[close], distance)


def extremes(surface: str, ends: int, points: NDArray, distance: NDArray) -> SurfaceFigures:
    """The deepest and the highest of a surface's points, by their signed distances [mm]; how many ``ends`` they are."""
    if not len(distance):
        nowhere = np.full(3, np.nan)
        return SurfaceFigures(surface, 0, np.nan, np.nan, nowhere, nowhere)
    low, high = int(np.argmin(distance)), int(np.argmax(distance))
    return SurfaceFigures(surface, ends, float(distance[low]), float(distance[high]), points[low], points[high])


def near(grid: SampleGrid, points: NDArray, spaces: int) -> tuple[NDArray, NDArray]:
    """Which points lie within half a millimetre of a surface or one like it in another space, and how far [mm]."""
    turned = _into_one_space(points, grid, spaces)
    lower, upper = (f(grid.point[np.isfinite(grid.point).all(axis=-1)], axis=0) for f in (np.min, np.max))
    close = np.flatnonzero(((turned > lower - NEAR_MM) & (turned < upper + NEAR_MM)).all(axis=1))
    distance, _, _ = signed_distance(grid, turned[close], NEAR_MM)
    real = np.abs(distance) < NEAR_MM
    return close[real], distance[real]


def beside_solid(intended: NamedFaces, stock: Stock) -> tuple[list[SurfaceFigures], tuple[str, ...]]:
    """Signed distances of all of a stock's ends, those of the blank too, from an intended solid; what forbids trust.

    So are, where the solid's own chords are known, those of the middles of all stretches of its rays that only one of
    the two holds; without them pieces between rays escape alone, where the solid is connected: material ends at a piece
    that is missing or too much. Each counts for the face that is nearest.
    """
    ends = all_ends(stock)
    middle: NDArray = np.zeros((0, 3))
    doubts: list[str] = []
    if isinstance(intended, MachinedSolid | FacedPart):
        middle, unseen = difference(intended, stock)
        doubts += _unseen(intended, unseen)
    if not len(ends):
        doubts.append("no ray of the stock holds any material: nothing of the solid was judged")
    points = np.concatenate([ends, middle]) if len(ends) else ends
    distance, face = intended.by_face(points)
    seen = np.bincount(face[: len(ends)], minlength=len(intended.tolerances))
    found = [
        extremes(name, int(seen[k]), points[face == k], distance[face == k])
        for k, name in enumerate(intended.tolerances)
    ]
    unmet = [name for name, count in zip(intended.tolerances, seen, strict=True) if len(ends) and not count]
    if unmet:
        doubts.append(f"no ray of the whole part ends at {', '.join(unmet)}; a finer stock.pitch_mm may meet it")
    return found, tuple(doubts)


def _unseen(intended: MachinedSolid | FacedPart, unseen: tuple[int, ...]) -> list[str]:
    """That shapes taken from a body take nothing from any ray."""
    if not unseen:
        return []
    lower, upper = intended.minus[unseen[0]].box
    where = ", ".join(f"{x:.4g}" for x in 0.5 * (lower + upper))
    return [
        f"no ray meets {len(unseen)} of {len(intended.minus)} shapes that surface.minus takes from the body, one "
        f"about ({where}) mm: it lies off the body, or wants a finer stock.pitch_mm"
    ]


def cut_ends(stock: Stock) -> NDArray:
    """Points [mm], shape (n, 3), where a row ended material."""
    return np.concatenate([_ends(stock, axis, False) for axis in AXES])


def all_ends(stock: Stock) -> NDArray:
    """Points [mm], shape (n, 3), where material ends, cut or the blank's own."""
    return np.concatenate([_ends(stock, axis, True) for axis in AXES])


def _ends(stock: Stock, axis: int, blank: bool) -> NDArray:
    """Points [mm], shape (n, 3), where a row ended material of a bundle, and those of the blank itself if asked for."""
    left, rays = stock.left[axis], stock.box.rays(axis)
    ray, tau = np.tile(left.ray, 2), np.concatenate([left.lo, left.hi])
    made = stock.cut(np.concatenate([left.lo_segment, left.hi_segment]))
    chosen = slice(None) if blank else made
    return rays.origin[ray[chosen]] + tau[chosen, None] * rays.direction[ray[chosen]]


def _into_one_space(points: NDArray, grid: SampleGrid, spaces: int) -> NDArray:
    """Points of all spaces turned about z into that of the grid."""
    if spaces == 1:
        return points
    middle = np.nanmean(grid.point.reshape(-1, 3), axis=0)
    step = 2.0 * np.pi / spaces
    angle = np.arctan2(points[:, 1], points[:, 0]) - np.arctan2(middle[1], middle[0])
    back = -step * np.round(angle / step)
    cos, sin = np.cos(back), np.sin(back)
    x, y, z = points.T
    return np.stack([cos * x - sin * y, sin * x + cos * y, z], axis=1)
