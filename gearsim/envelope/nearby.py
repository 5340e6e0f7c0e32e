"""The nearest of many points, on a device."""

from __future__ import annotations

import numpy as np
import warp as wp
from numpy.typing import NDArray

from gearsim.kernels import nearby as kernels

_GROUP = 24


class PointCloud:
    """Points, shape (n, 3), that are asked which of them is nearest; quickest where neighbours stand side by side."""

    def __init__(self, points: NDArray, device: str = "cpu") -> None:
        self._device = device
        ends = np.append(np.arange(0, len(points), _GROUP), len(points))
        share = np.diff(ends)[:, None]
        middle = np.add.reduceat(points, ends[:-1], axis=0) / share if len(points) else np.empty((0, 3))
        apart = np.linalg.norm(points - np.repeat(middle, share[:, 0], axis=0), axis=1)
        self._data = kernels.Cloud()
        self._data.points = wp.array(points, dtype=wp.vec3d, device=device)
        self._data.size = _GROUP
        self._data.middle = wp.array(middle, dtype=wp.vec3d, device=device)
        spread = np.maximum.reduceat(apart, ends[:-1]) if len(points) else apart
        self._data.spread = wp.array(spread * (1.0 + 1e-12), dtype=wp.float64, device=device)

    def nearest(self, points: NDArray, reach: NDArray) -> NDArray[np.integer]:
        """The number of the nearest point within ``reach`` [mm], shape (m,), of each point (m, 3); -1 where none is."""
        found = wp.empty(len(points), dtype=wp.int32, device=self._device)
        at = wp.array(points, dtype=wp.vec3d, device=self._device)
        far = wp.array(np.minimum(reach, 1e300), dtype=wp.float64, device=self._device)
        if len(points):
            wp.launch(kernels.nearest_of_cloud, len(points), [self._data, at, far], [found], device=self._device)
        nearest: NDArray[np.integer] = found.numpy()
        return nearest
