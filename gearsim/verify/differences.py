"""Normals and curvatures of a surface from differences of its points alone.

Central differences of eighth order along u, v and both diagonals, at steps that halve. Truncation falls and
rounding grows along that ladder; of three rungs in a row that agree best the middle one is taken,
and how far they differ is the error told. No claim of the surface is looked at but its points.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.jets import Curvature, fundamental_curvature

_FIRST = np.array([4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0])
_SECOND = np.array([8.0 / 5.0, -1.0 / 5.0, 8.0 / 315.0, -1.0 / 560.0])
_STEPS = np.arange(1.0, 5.0)
_LARGEST_STEP = 0.5
_RUNGS = 8
_FLAT = 1e-3
_WAYS = ((1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, -1.0))


class Differences(NamedTuple):
    """Unit normals r_u x r_v and curvatures with respect to them, with their own errors, shape (n, ...).

    ``normal_error`` [rad] and ``curvature_error`` (relative to the larger principal curvature) are inf
    where the surface does not exist around a point.
    """

    normal: NDArray
    normal_error: NDArray
    curvature: Curvature
    curvature_error: NDArray


def differentiate(
    points: Callable[[NDArray, NDArray], NDArray], u: NDArray, v: NDArray, joints: tuple[float, ...] = ()
) -> Differences:
    """Differences of ``points(u, v)``, shape (n, 3) [mm], at u and v, shape (n,).

    All points asked for lie in [0, 1] and on the same side of every joint in u.
    """
    step_u, step_v = _first_steps(points, u, v, joints)
    scale = 0.5 ** np.arange(_RUNGS)[:, None]
    normal, curvature = _on_rungs(points, u, v, step_u * scale, step_v * scale)
    with np.errstate(invalid="ignore", divide="ignore"):
        turned = np.linalg.norm(np.cross(normal[1:], normal[:-1]), axis=-1)
        bent = curvature_gap(_each(curvature, slice(1, None)), _each(curvature, slice(None, -1)))
    best_normal, normal_error = _best(turned)
    best_curvature, curvature_error = _best(bent)
    i = np.arange(len(u))
    return Differences(
        normal[best_normal, i], normal_error, _each(curvature, (best_curvature, i)), curvature_error
    )  # fmt: skip


def curvature_gap(a: Curvature, b: Curvature) -> NDArray:
    """Largest difference of two curvatures, relative to the larger principal one of ``b`` (squared for Gaussian).

    A surface flatter than a radius of 1 m is measured against that radius: rounding hides the rest.
    """
    size = np.maximum(np.maximum(np.abs(b.k1), np.abs(b.k2)), _FLAT)
    with np.errstate(invalid="ignore", divide="ignore"):
        linear = [np.abs(getattr(a, k) - getattr(b, k)) / size for k in ("k1", "k2", "mean")]
        return np.max([*linear, np.abs(a.gaussian - b.gaussian) / size**2], axis=0)


def _first_steps(
    points: Callable[[NDArray, NDArray], NDArray], u: NDArray, v: NDArray, joints: tuple[float, ...]
) -> tuple[NDArray, NDArray]:
    """Steps in u and v that move the point by the largest step [mm], or as far as there is room for four."""
    room_u = np.min([np.abs(u - edge) for edge in (0.0, 1.0, *joints)], axis=0)
    room_v = np.minimum(v, 1.0 - v)
    probe_u, probe_v = 1e-3 * room_u, 1e-3 * room_v
    around = points(
        np.concatenate([u + probe_u, u - probe_u, u, u]), np.concatenate([v, v, v + probe_v, v - probe_v])
    ).reshape(2, 2, -1, 3)
    with np.errstate(invalid="ignore", divide="ignore"):
        moved_u, moved_v = np.linalg.norm(around[:, 0] - around[:, 1], axis=-1)
        return (
            np.fmin(0.249 * room_u, _LARGEST_STEP * 2.0 * probe_u / moved_u),
            np.fmin(0.249 * room_v, _LARGEST_STEP * 2.0 * probe_v / moved_v),
        )


def _on_rungs(
    points: Callable[[NDArray, NDArray], NDArray], u: NDArray, v: NDArray, step_u: NDArray, step_v: NDArray
) -> tuple[NDArray, Curvature]:
    """Normals and curvatures at every rung, shape (rungs, n, ...)."""
    steps = np.multiply.outer(np.concatenate([_STEPS, -_STEPS]), np.array(_WAYS))
    du, dv = (np.multiply.outer(steps[..., i], step) for i, step in enumerate((step_u, step_v)))
    middle = points(u, v)
    ahead, back = points((u + du).ravel(), (v + dv).ravel()).reshape(2, 4, *du.shape[1:], 3)
    first = np.tensordot(_FIRST, ahead[:, :2] - back[:, :2], 1)
    second = np.tensordot(_SECOND, (ahead - middle) + (back - middle), 1)
    ru, rv = first
    normal = np.cross(ru, rv)
    with np.errstate(invalid="ignore", divide="ignore"):
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        uu, vv, plus, minus = np.einsum("wrni,rni->wrn", second, normal)
        curvature = fundamental_curvature(ru, rv, uu, 0.25 * (plus - minus), vv)
    return normal, curvature


def _best(gap: NDArray) -> tuple[NDArray, NDArray]:
    """The middle one of the three rungs in a row that agree best, and by how much; inf where there are none."""
    gap = np.where(np.isfinite(gap), gap, np.inf)
    apart = np.maximum(gap[1:], gap[:-1])
    best = np.argmin(apart, axis=0)
    return best + 1, np.take_along_axis(apart, best[None], axis=0)[0]


def _each(curvature: Curvature, index: object) -> Curvature:
    names = ("gaussian", "mean", "k1", "k2", "direction1", "direction2")
    return Curvature(*(getattr(curvature, name)[index] for name in names))
