"""Grazing points of a cutter on an exact motion: single points with jets; grids for seeds and pictures."""

from __future__ import annotations

from time import perf_counter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.geometry.grazing import Grazing, PoseJet, grazing_points
from gearsim.motion.sources import MotionSource

BRANCHES = (1.0, -1.0)


def pose_jet(source: MotionSource, piece: NDArray, t: NDArray) -> PoseJet:
    """Exact poses with two derivatives by t, shape (n, 3) each."""
    tip, axis = source.pose(piece, t, 2)
    return PoseJet(*(d for pair in zip(tip.derivatives(), axis.derivatives(), strict=True) for d in pair))


def envelope_points(
    source: MotionSource, cutter: Profile,
    piece: NDArray, t: NDArray, element: NDArray, s: NDArray, branch: NDArray,
) -> Grazing:  # fmt: skip
    """Grazing points at profile arc length s [mm] of ``element`` and t of ``piece``; all shape (n,)."""
    return grazing_points(pose_jet(source, piece, t), cutter.at(element, s), branch)


def radial_axes(axis: NDArray) -> tuple[NDArray, NDArray]:
    """Unit vectors normal to unit axes, shape (n, 3): from these the charts count the angle about the axis."""
    fixed = np.eye(3)[np.argmin(np.abs(axis), axis=1)]
    x = fixed - np.einsum("ij,ij->i", fixed, axis)[:, None] * axis
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    return x, np.cross(axis, x)


class EnvelopeGrid(NamedTuple):
    """Grazing points of a whole motion: axes are pose (i), profile point (j), branch (k: +1, -1).

    ``point`` and ``normal`` (out of the tool) have shape (i, j, k, 3); ``exists`` (i, j, k).
    """

    piece: NDArray
    t: NDArray
    element: NDArray
    s: NDArray
    exists: NDArray
    point: NDArray
    normal: NDArray


def prepare_envelope(device: str = "cpu") -> float:
    """Compile and load the envelope road's kernels ahead of use; seconds taken.

    Raises InputError where what is compiled cannot be kept.
    """
    from gearsim.kernels import approach, crossing, envelope, nearby, pursuit
    from gearsim.kernels.loading import load_kernels

    started = perf_counter()
    for module in (approach, crossing, pursuit, nearby, envelope):
        load_kernels(module, device)
    return perf_counter() - started


def envelope_grid(
    source: MotionSource, cutter: Profile, poses: int, per_element: int, device: str = "cpu"
) -> EnvelopeGrid:
    """Grazing points at about ``poses`` poses and ``per_element`` points of each profile element."""
    import warp as wp

    from gearsim.kernels import envelope as kernels

    each = max(1, -(-poses // source.pieces))
    piece = np.repeat(np.arange(source.pieces), each)
    t = np.tile((np.arange(each) + 0.5) / each, source.pieces)
    fraction = (np.arange(per_element) + 0.5) / per_element
    element = np.repeat(np.arange(len(cutter.elements)), per_element)
    s = np.concatenate([fraction * e.length for e in cutter.elements])
    pose = pose_jet(source, piece, t)
    meridian = np.stack(cutter.at(element, s)[:4], axis=1)
    shape = (len(t), len(s), 2)
    exists = wp.empty(shape, dtype=wp.int32, device=device)
    point, normal = (wp.empty(shape, dtype=wp.vec3d, device=device) for _ in range(2))
    vectors = (pose.tip, pose.axis, pose.tip_rate, pose.axis_rate)
    wp.launch(
        kernels.grazing_grid,
        dim=shape,
        inputs=[wp.array(v, dtype=wp.vec3d, device=device) for v in vectors]
        + [wp.array(meridian, dtype=wp.float64, device=device)],
        outputs=[exists, point, normal],
        device=device,
    )
    return EnvelopeGrid(piece, t, element, s, exists.numpy() == 1, point.numpy(), normal.numpy())
