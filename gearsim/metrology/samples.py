"""Where the tooth is measured: grids of points on a patch of the intended surface, with their normals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rays import RayBundle
from gearsim.metrology.kept import Kept
from gearsim.surfaces.patch import Jet, Patch, ToothSurface


@dataclass(frozen=True)
class SampleGrid:
    """Points of one patch on a grid: rows from root to tip, columns from toe to heel.

    ``length`` (columns,) and ``height`` (rows,) are the fractions of Patch.locate; ``u``, ``v``
    (rows, columns) the surface parameters; ``point`` [mm] and ``normal`` (out of the material), shape
    (rows, columns, 3), nan where there is no surface; ``inward``, ``outward`` [mm], shape (rows, columns),
    the measuring window: on a tooth half its thickness, and half the slot's width or what the blank leaves.
    """

    patch: Patch
    length: NDArray[np.floating]
    height: NDArray[np.floating]
    u: NDArray[np.floating]
    v: NDArray[np.floating]
    point: NDArray[np.floating]
    normal: NDArray[np.floating]
    inward: NDArray[np.floating]
    outward: NDArray[np.floating]

    @property
    def shape(self) -> tuple[int, int]:
        return (len(self.height), len(self.length))

    def rays(self) -> RayBundle:
        """Rays along the normals, row-major, material behind their origins."""
        n = self.point.size // 3
        return RayBundle(
            self.point.reshape(n, 3), self.normal.reshape(n, 3), -self.inward.ravel(), self.outward.ravel()
        )


def sample_grid(patch: Patch, rows: int, columns: int, margin: float = 0.0, window: float = 1.0) -> SampleGrid:
    """A grid of ``rows`` x ``columns`` points that leaves ``margin`` (a fraction) free at every edge.

    ``window`` scales the measuring windows. Grids are kept: jobs beside each other share their patches.
    """
    key = (id(patch), rows, columns, margin, window)
    return _GRIDS.get(key, lambda: _made(patch, rows, columns, margin, window))


_GRIDS: Kept[SampleGrid] = Kept(32)  # by the patch's id, which lives as long as its grid


def _made(patch: Patch, rows: int, columns: int, margin: float, window: float) -> SampleGrid:
    height = np.linspace(margin, 1.0 - margin, rows)
    length = np.linspace(margin, 1.0 - margin, columns)
    u, v = patch.locate(*np.broadcast_arrays(length[None, :], height[:, None]))
    jet = patch.jet(u.ravel(), v.ravel())
    rays = window_rays(patch, u.ravel(), v.ravel(), jet.normal, window)
    shape = (rows, columns)
    return SampleGrid(
        patch, length, height, u, v, jet.r.reshape(*shape, 3), jet.normal.reshape(*shape, 3),
        -rays.start.reshape(shape), rays.end.reshape(shape),
    )  # fmt: skip


def grid_on_lines(patch: Patch, u: NDArray, v: NDArray, jet: Jet) -> SampleGrid:
    """A grid on lines of the parameters u (columns,) and v (rows,), with the ``jet`` of its points, row-major."""
    shape, corners = (len(v), len(u)), patch.locate(np.array([0.0, 1.0]), np.array([0.0, 1.0]))
    length, height = ((x - end[0]) / (end[1] - end[0]) for x, end in zip((u, v), corners, strict=True))
    uu, vv = np.meshgrid(u, v)
    inward, outward = (w.reshape(shape) for w in patch.windows(uu.ravel(), vv.ravel()))
    return SampleGrid(
        patch, length, height, uu, vv, jet.r.reshape(*shape, 3), jet.normal.reshape(*shape, 3), inward, outward
    )


def window_rays(patch: Patch, u: NDArray, v: NDArray, direction: NDArray, window: float = 1.0) -> RayBundle:
    """Rays from points of a patch, shape (n,) parameters, with their measuring windows.

    The patch's windows times ``window``, but not past the stock's surface: beyond it there was never any
    material to leave.
    """
    origin = patch.jet(u, v).r
    inward, outward = (window * w for w in patch.windows(u, v))
    if patch.blank is None:
        return RayBundle(origin, direction, -inward, outward)
    ray, start, end = patch.blank.stock.chords(origin, direction)
    holds = (start <= 0.0) & (end > 0.0)
    outward[ray[holds]] = np.minimum(outward[ray[holds]], end[holds])
    return RayBundle(origin, direction, -inward, outward)


def profile_rays(patch: ToothSurface, offsets: NDArray, contact_height: float) -> tuple[RayBundle, RayBundle]:
    """Rays of the mean profile: at profile heights ``offsets`` [mm] from the contact height over the root cone.

    Zhou 2015, figure 4.15: the points L0 to L6 in the profile plane of the mean point. Returns the rays
    along the surface normal and those along the profile's normal in that plane.
    """
    u, v, across = patch.mean_profile(contact_height, np.asarray(offsets, dtype=float))
    normal = patch.jet(u, v).normal
    in_plane = normal - (normal @ across)[:, None] * across
    in_plane /= np.linalg.norm(in_plane, axis=1, keepdims=True)
    return window_rays(patch, u, v, normal), window_rays(patch, u, v, in_plane)
