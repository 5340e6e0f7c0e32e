"""A peer in NumPy: the tool stands still at many poses, each cuts the interval it covers of every ray."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearsim.bench.peer_work import Work
from gearsim.cutters.profile import Element, Profile
from gearsim.geometry.rays import RayBundle

_RAYS, _POSES = 64, 512  # arrays of one step stay in the processor's cache
_TILE = 2.5  # rays that lie in one cell of this size [mm] are worked off together


def instants(work: Work, poses: int, culled: bool = True) -> NDArray:
    """First surface along each ray [mm] of the union of a tapered ball end mill (or ball) at ``poses`` poses.

    The interval of each ray-pose pair is in closed form. What is lost is what the tool cuts between the poses.
    ``culled``: rays are bundled by place and leave out the poses whose box misses theirs.
    """
    rays, cutter = work.rays, work.cutter
    pose = work.source.pose(np.zeros(poses, dtype=int), np.linspace(0.0, 1.0, poses), 0)
    tip, axis = pose.tip.value, pose.axis.value
    surface = rays.end.copy()
    order = _by_place(rays) if culled else np.arange(len(rays))
    for begin in range(0, len(rays), _RAYS):
        mine = order[begin : begin + _RAYS]
        part = rays.part(mine)
        near = _near(part, cutter, tip, axis) if culled else np.arange(poses)
        for first in range(0, len(near), _POSES):
            some = near[first : first + _POSES]
            surface[mine] = np.minimum(surface[mine], _entries(part, cutter, tip[some], axis[some]))
    return surface


def _by_place(rays: RayBundle) -> NDArray:
    middle = rays.origin + (0.5 * (rays.start + rays.end))[:, None] * rays.direction
    return np.lexsort(np.floor(middle / _TILE).astype(int).T)


def _near(rays: RayBundle, cutter: Profile, tip: NDArray, axis: NDArray) -> NDArray:
    """Poses whose box meets that of the rays' windows."""
    ends = np.concatenate([rays.origin + s[:, None] * rays.direction for s in (rays.start, rays.end)])
    top = tip + cutter.height * axis
    low, high = np.minimum(tip, top) - cutter.max_radius, np.maximum(tip, top) + cutter.max_radius
    return np.flatnonzero(np.all((low < ends.max(axis=0)) & (high > ends.min(axis=0)), axis=1))


def _entries(rays: RayBundle, cutter: Profile, tip: NDArray, axis: NDArray) -> NDArray:
    """Where each ray first enters the tool at any of the poses [mm]; infinite where it never does."""
    o, d = rays.origin, rays.direction
    oz, dz = o @ axis.T - np.einsum("pi,pi->p", tip, axis), d @ axis.T
    oo = np.einsum("ri,ri->r", o, o)[:, None] - 2.0 * (o @ tip.T) + np.einsum("pi,pi->p", tip, tip)
    od = np.einsum("ri,ri->r", o, d)[:, None] - d @ tip.T
    with np.errstate(invalid="ignore", divide="ignore"):
        found = np.inf
        for lo, hi in (_ball(cutter.elements[0], oz, dz, oo, od), _cone(cutter.elements[1], oz, dz, oo, od)):
            lo[~((lo < hi) & (hi > rays.start[:, None]))] = np.inf
            found = np.minimum(found, lo.min(axis=1))
    return np.maximum(found, rays.start)


def _ball(e: Element, oz: NDArray, dz: NDArray, oo: NDArray, od: NDArray) -> tuple[NDArray, NDArray]:
    """Interval in the ball at the tip; nan where missed."""
    b = od - e.radius * dz
    root = np.sqrt(b * b - oo + 2.0 * e.radius * oz)
    return -b - root, root - b


def _cone(e: Element, oz: NDArray, dz: NDArray, oo: NDArray, od: NDArray) -> tuple[NDArray, NDArray]:
    """Interval in the frustum over the ball; lo > hi or nan where missed. A ray must not be parallel to the flank."""
    (r0, z0), (r1, z1) = e.start, e.end
    slope = (r1 - r0) / (z1 - z0)
    radius = r0 + slope * (oz - z0)
    a = 1.0 - (1.0 + slope * slope) * dz * dz
    b = od - oz * dz - slope * radius * dz
    root = np.sqrt(b * b - a * (oo - oz * oz - radius * radius))
    lo, hi = (-b - root) / a, (root - b) / a
    steep = a < 0.0  # steeper than the cone: the ray enters or leaves it through the open end
    if steep.any():
        lo[steep & (dz < 0.0)], hi[steep & (dz > 0.0)] = -np.inf, np.inf
    bottom, top = (z0 - oz) / dz, (z1 - oz) / dz
    return np.maximum(lo, np.minimum(bottom, top)), np.minimum(hi, np.maximum(bottom, top))
