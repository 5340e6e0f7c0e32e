"""A peer with manifold3d: from pose to pose the convex hull of the tool's mesh at both, taken from a block's mesh."""

from __future__ import annotations

from math import cos, pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.bench.peer_work import LOWER, UPPER, Work
from gearsim.cutters.profile import Profile
from gearsim.motion.sources import MotionSource


def hull_sweep(manifold3d: Any, work: Work, facets: int, steps: int = 1) -> Any:
    """The machined block, a Manifold; the tool has ``facets`` around, each piece of the motion ``steps``.

    For a convex tool. Two sources of error: facets (second order) and, where the tool turns, hulls, which fill
    in what it leaves between two poses (first order in the step where it twists across its path).
    """
    piece, k = (a.ravel() for a in np.indices((work.source.pieces, steps)))
    mesh = tool_mesh(work.cutter, facets)
    hulls = [
        manifold3d.Manifold.hull_points(np.concatenate(_placed(work.source, mesh, p, np.array([t, t + 1.0]) / steps)))
        for p, t in zip(piece.tolist(), k.tolist(), strict=True)
    ]
    block = manifold3d.Manifold.cube((UPPER - LOWER).tolist()).translate(LOWER.tolist())
    machined = manifold3d.Manifold.batch_boolean([block, *hulls], manifold3d.OpType.Subtract)
    machined.num_tri()  # booleans wait until they are asked for
    return machined


def tool_mesh(cutter: Profile, facets: int) -> NDArray:
    """Vertices [mm] of a tool's mesh, shape (n, 3), half of the facets' error outside of the tool, half inside."""
    rings = [np.array([cutter.elements[0].start])]
    for e in cutter.elements[:-1]:
        count = max(1, round(facets * abs(e.angles[1] - e.angles[0]) / (2.0 * pi))) if e.is_arc else 1
        p = e.at(e.length * np.arange(count + 1) / count)
        half = 0.5 * e.length / count / e.radius if e.is_arc else 0.0
        out = e.radius * (2.0 / (1.0 + cos(half)) - 1.0)
        rings.append(np.stack([p.r + out * p.nr, p.z + out * p.nz], axis=1))
    r, z = np.concatenate(rings).T
    r = r * 2.0 / (1.0 + cos(pi / facets))
    angle = 2.0 * pi * np.arange(facets) / facets
    round_about = np.stack([np.outer(r, np.cos(angle)), np.outer(r, np.sin(angle))], axis=-1).reshape(-1, 2)
    return np.column_stack([round_about, np.repeat(z, facets)])


def _placed(source: MotionSource, mesh: NDArray, piece: int, t: NDArray) -> NDArray:
    """The mesh at poses t (n,) of a piece, shape (n, vertices, 3)."""
    pose = source.pose(np.full(len(t), piece), t, 0)
    tip, axis = pose.tip.value, pose.axis.value
    x = np.cross(np.array([0.0, 1.0, 0.0]), axis)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    frames = np.stack([x, np.cross(axis, x), axis], axis=2)
    return tip[:, None, :] + np.einsum("cij,nj->cni", frames, mesh)


def cast(machined: Any, work: Work) -> NDArray:
    """Where material first ends along each ray [mm] of a machined block."""
    surface = work.rays.end.copy()
    ends = work.rays.origin + work.rays.end[:, None] * work.rays.direction
    for i, (origin, end) in enumerate(zip(work.rays.origin.tolist(), ends.tolist(), strict=True)):
        out = [h.distance for h in machined.ray_cast(origin, end) if np.dot(h.normal, work.rays.direction[i]) > 0.0]
        surface[i] *= min(out, default=1.0)
    return surface
