"""NURBS surfaces at large point sets, on the CPU's cores or a CUDA device."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import warp as wp
from numpy.typing import ArrayLike

from gearsim.errors import InputError
from gearsim.geometry.nurbs import SurfaceDerivatives
from gearsim.kernels import nurbs as kernels
from gearsim.kernels.loading import load_kernels
from gearsim.simulation.removal import open_device
from gearsim.surfaces.nurbs import NurbsJet, NurbsSurface

_SLICE = 16384


def evaluate(
    surface: NurbsSurface, u: ArrayLike, v: ArrayLike, device: str = "cpu", threads: int | None = None
) -> NurbsJet:
    """What ``surface.jet(u, v)`` gives, u and v of shape (n,), computed by a kernel.

    ``threads``: CPU threads (default: all cores). Raises InputError for an unknown device and for degrees above the
    kernel's.
    """
    u, v = surface.inside(u, v)
    data = surface_data(surface, device)
    load_kernels(kernels, device)
    inputs = [wp.array(x, dtype=wp.float64, device=device, copy=False) for x in (u, v)]
    outputs = [wp.empty(len(u), dtype=wp.vec3d, device=device) for _ in SurfaceDerivatives._fields]

    def launch(begin: int, size: int) -> None:
        wp.launch(kernels.evaluate_points, size, [data, begin, *inputs], outputs, device=device)

    if wp.get_device(device).is_cpu:
        with ThreadPoolExecutor(threads or os.cpu_count()) as pool:
            starts = range(0, len(u), _SLICE)
            list(pool.map(launch, starts, (min(_SLICE, len(u) - b) for b in starts)))
    else:
        launch(0, len(u))
    return surface.complete(u, v, SurfaceDerivatives(*(np.array(x.numpy(), copy=False) for x in outputs)))


def surface_data(surface: NurbsSurface, device: str) -> Any:
    """The surface as a device knows it (`gearsim.kernels.nurbs.Nurbs`); errors as of ``evaluate``."""
    open_device(device)
    along_u, along_v = surface.along
    if max(along_u.degree, along_v.degree) > kernels.MAX_DEGREE:
        raise InputError(
            f"degrees {along_u.degree} and {along_v.degree} are beyond the kernel's {kernels.MAX_DEGREE}; "
            "NurbsSurface.jet evaluates any"
        )
    data = kernels.Nurbs()
    data.degree_u, data.degree_v = along_u.degree, along_v.degree
    data.last_u, data.last_v = along_u.last_span, along_v.last_span
    data.knots_u, data.knots_v = (wp.array(b.knots, dtype=wp.float64, device=device) for b in surface.along)
    data.net = wp.array(surface.net, dtype=wp.vec4d, device=device)
    return data
