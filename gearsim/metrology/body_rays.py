"""Rays that look at a solid body: through it, and along its surface just below."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rays import RayBundle, join_rays
from gearsim.geometry.solid import Block, Shifted, Solid
from gearsim.geometry.turned import Turned
from gearsim.machines.chain import AT_REST
from gearsim.metrology.chords import stock_chords
from gearsim.simulation.dexels import DexelBox

BELOW_MM = 1e-3
_RAYS, _LINES, _FINEST = 30_000, 50_000, 0.02


def body_rays(solid: Solid, lower: NDArray, upper: NDArray) -> tuple[RayBundle, float]:
    """A solid's chords in a box of its frame: three bundles of about 30,000 rays, and lines along its surface.

    Also how far apart [mm] the bundles' rays stand. The lines run a micrometre below every face, both ways, and along
    every edge, on a body of revolution in chords of its circles; they stand as close, or as 50,000 of them
    do on three sides of the whole body's box.
    """
    pitch = max(_FINEST, _spread(lower, upper, _RAYS))
    middle, half = 0.5 * (lower + upper), np.maximum(0.5 * (upper - lower), 0.6 * pitch)
    box = DexelBox(AT_REST, middle - half, middle + half, pitch)
    lines = join_rays(list(_surface(solid, max(pitch, _spread(*solid.box, _LINES)))))
    centre, reach = lines.origin + 0.5 * lines.end[:, None] * lines.direction, 0.5 * lines.end[:, None] + pitch
    close: NDArray[np.bool_] = np.all(np.abs(centre - middle) <= half + reach, axis=1)
    rays = join_rays([*(box.rays(axis) for axis in range(3)), lines.part(close)])
    return stock_chords(solid, rays, 0.5 * BELOW_MM), pitch


def _spread(lower: NDArray, upper: NDArray, rays: int) -> float:
    """How far apart [mm] so many rays stand on three sides of a box."""
    a, b, c = (float(x) for x in np.maximum(upper - lower, 0.0))
    return float(np.sqrt((a * b + b * c + c * a) / rays))


def _surface(solid: Solid, pitch: float) -> Iterator[RayBundle]:
    if isinstance(solid, Shifted):
        for lines in _surface(solid.solid, pitch):
            yield RayBundle(lines.origin + solid.by, lines.direction, lines.start, lines.end)
    elif isinstance(solid, Block):
        yield from _of_block(solid, pitch)
    elif isinstance(solid, Turned):
        yield from _of_turned(solid, pitch)
    else:
        raise TypeError(f"no lines are known on the surface of a {type(solid).__name__}")


def _between(start: NDArray, end: NDArray) -> RayBundle:
    """Rays from points to points, both shape (n, 3), those of no length left out."""
    way = end - start
    length = np.linalg.norm(way, axis=1)
    some = length > BELOW_MM
    return RayBundle(start[some], way[some] / length[some, None], np.zeros(int(some.sum())), length[some])


def _of_block(block: Block, pitch: float) -> Iterator[RayBundle]:
    lower, upper = block.lower + BELOW_MM, block.upper - BELOW_MM
    for along in range(3):
        others = [k for k in range(3) if k != along]
        grids = [np.linspace(lower[k], upper[k], 1 + int(np.ceil((upper[k] - lower[k]) / pitch))) for k in others]
        first, second = (g.ravel() for g in np.meshgrid(*grids, indexing="ij"))
        outside = np.isin(first, grids[0][[0, -1]]) | np.isin(second, grids[1][[0, -1]])
        start = np.empty((int(outside.sum()), 3))
        start[:, along], start[:, others[0]], start[:, others[1]] = lower[along], first[outside], second[outside]
        end = start.copy()
        end[:, along] = upper[along]
        yield _between(start, end)


def _of_turned(turned: Turned, pitch: float) -> Iterator[RayBundle]:
    """Along each face its meridians, and circles as polygons that lie in the material."""
    polygon = turned.polygon
    r, z = polygon.T
    outward = np.sign(r @ np.roll(z, -1) - z @ np.roll(r, -1))
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        length = float(np.linalg.norm(b - a))
        if a[0] == b[0] == 0.0 or length <= 4.0 * BELOW_MM:
            continue
        along = (b - a) / length
        normal = outward * np.array([along[1], -along[0]])
        start, end = (p - BELOW_MM * normal for p in (a + BELOW_MM * along, b - BELOW_MM * along))
        count = max(8, int(np.ceil(2.0 * np.pi * r.max() / pitch)))
        angle = 2.0 * np.pi * np.arange(count) / count
        yield _between(_at(start[0], angle, start[1]), _at(end[0], angle, end[1]))
        for p in start + np.linspace(0.0, 1.0, 2 + int(length / pitch))[:, None] * (end - start):
            yield _ring(max(float(p[0]), 0.0), float(p[1]), pitch, hollow=normal[0] < 0.0)


def _ring(radius: float, z: float, pitch: float, hollow: bool) -> RayBundle:
    """The sides of a regular polygon in a circle, or of a ``hollow`` face around it."""
    count = max(8, int(np.ceil(2.0 * np.pi * radius / pitch)))
    angle = 2.0 * np.pi * np.arange(count + 1) / count
    corners = _at(radius / np.cos(np.pi / count) if hollow else radius, angle, z)
    return _between(corners[:-1], corners[1:])


def _at(radius: float, angle: NDArray, z: float) -> NDArray:
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(len(angle), z)])
