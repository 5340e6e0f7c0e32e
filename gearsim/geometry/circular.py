"""Envelopes of specific circular surfaces in motion: revolved, canal and tube surfaces in one closed form.

Such a surface (Zhou 2015, 2.11-2.13) is a family of circles whose surface normals meet in one point each,
    S(h, theta) = q(h) + rho(h) n,   n . T(h) = cos alpha(h),   |n| = 1,
with effective centre q, unit circle normal T, effective radius rho and effective angle alpha. For n to be
the normal of S, n . S_h = n . q' + rho' must vanish round the circle (n . n_h = 0, so T' drops out), hence
    q' x T = 0   and   rho' = -cos(alpha) q' . T;
the second one is the errata's test of a family, rho' = -cos(alpha) h', where q = h T. Where q' is not
zero, T is its direction: every such surface is a canal surface, and alpha follows from q and rho.

Moved rigidly, a point of it grazes where n . v_q = 0, which with n . T = cos alpha has two solutions
(Zhou 2.30). All derivatives come from that form by truncated series, so that the terms with dT/dh which
his 2.43 misses are in them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry import series
from gearsim.geometry.grazing import AT_REST, PARALLEL, Grazing, MeridianPoints
from gearsim.geometry.series import Series, cross, dot

_ADMISSIBLE = 1e-9


class CircularSeries(NamedTuple):
    """q [mm] and T (vectors), rho [mm] and cos alpha (scalars) as series in h, at n values of h.

    A negative radius turns the normals towards q: the inside of a bore or of a ring-shaped tool.
    """

    centre: Series
    normal: Series
    radius: Series
    cosine: Series


class MovingFrame(NamedTuple):
    """A moving frame as series in the motion's parameter: x -> rotation @ x + origin, workpiece frame.

    ``origin`` [mm] has coefficients of shape (n, 3), ``rotation`` of shape (n, 3, 3).
    """

    origin: Series
    rotation: Series


# A surface: the values at h, shape (n,), with derivatives up to an order.
CircularSurface = Callable[[NDArray, int], CircularSeries]
Curve = Callable[[NDArray, int], Series]


def canal(centre: Curve, radius: Curve) -> CircularSurface:
    """The envelope of spheres of ``radius`` rho(h) [mm] round ``centre`` q(h) [mm]: cos alpha = -rho'/|q'|.

    Raises InputError, on evaluation, where |rho'| < |q'| fails: such spheres have no common envelope.
    """

    def surface(h: NDArray, order: int) -> CircularSeries:
        q, rho = centre(h, order + 1), radius(h, order + 1)
        speed = series.sqrt(dot(q.derivative(), q.derivative()))
        bad = np.flatnonzero(~(np.abs(rho.derivative().value) < speed.value))
        if len(bad):
            i = int(bad[0])
            raise InputError(
                f"no canal surface at h = {h[i]:g}: |rho'| < |q'| fails, rho' = {rho.c[1][i]:g}, |q'| = "
                f"{speed.value[i]:g}; the spheres must grow more slowly than their centre moves"
            )
        tangent = q.derivative() / speed.column
        return CircularSeries(*(_cut(s, order) for s in (q, tangent, rho, -rho.derivative() / speed)))

    return surface


def tube(centre: Curve, radius: float) -> CircularSurface:
    """The tube of constant ``radius`` [mm] about the curve q(h) [mm]; alpha = 90 deg.

    Raises InputError for a radius that is not positive.
    """
    if not radius > 0.0:
        raise InputError(f"tube radius {radius:g} mm must be positive")

    def constant(h: NDArray, order: int) -> Series:
        return radius + 0.0 * Series.variable(h, order)

    return canal(centre, constant)


def revolution(at: Callable[[NDArray], MeridianPoints]) -> CircularSurface:
    """The surface that a line or circular arc of a meridian sweeps about the z axis; h is its arc length.

    ``at`` gives meridian points at arc lengths [mm], as a profile element's does (Zhou 2.32-2.33). Raises
    InputError, on evaluation, for a disc normal to the axis, whose effective radius r/nr is infinite.
    """

    def surface(h: NDArray, order: int) -> CircularSeries:
        p = at(h)
        if np.any(p.nr == 0.0):
            raise InputError("a disc normal to the axis has no effective radius r/nr; use grazing_points for it")
        step = Series.variable(np.zeros(np.shape(h)), order)
        n = series.exp(step * (1j * p.curvature)) * (p.nr + 1j * p.nz)
        k = np.arange(1, order + 1).reshape(-1, *([1] * np.ndim(h)))
        place = Series(np.concatenate([(p.r + 1j * p.z)[None], 1j * n.c[:-1] / k]))
        rho = place.real / n.real
        q = np.zeros((order + 1, *np.shape(h), 3))
        q[..., 2] = (place.imag - rho * n.imag).c
        axis = np.zeros_like(q)
        axis[0, ..., 2] = 1.0
        return CircularSeries(Series(q), Series(axis), rho, n.imag)

    return surface


def require_admissible(h: NDArray, family: CircularSeries) -> None:
    """Raise InputError where a family of order >= 1 is no specific circular surface, naming the relation."""
    q1 = family.centre.derivative().value
    t, cosine = family.normal.value, family.cosine.value
    along = np.einsum("ni,ni->n", q1, t)
    scale = 1.0 + np.linalg.norm(q1, axis=1)
    rules = [
        ("|T| = 1", np.linalg.norm(t, axis=1) - 1.0),
        ("|cos alpha| < 1", np.where(np.abs(cosine) < 1.0, 0.0, cosine)),
        ("q' x T = 0", np.linalg.norm(np.cross(q1, t), axis=1) / scale),
        ("rho' = -cos(alpha) q'.T", (family.radius.c[1] + cosine * along) / scale),
    ]
    for relation, miss in rules:
        bad = np.flatnonzero(~(np.abs(miss) <= _ADMISSIBLE))
        if len(bad):
            i = int(bad[0])
            raise InputError(f"no specific circular surface: {relation} fails at h = {h[i]:g} by {miss[i]:.3g}")


def circular_grazing(surface: CircularSurface, h: NDArray, frame: MovingFrame, branch: NDArray) -> Grazing:
    """Closed-form grazing points with first derivatives by h (as ``_s``) and by the motion (``_t``).

    ``h`` and ``branch`` (+1 or -1, the sign of n . (T x v_q)) have shape (n,); ``frame`` is of order 2 or
    more. They exist where |cos alpha| <= sin of the angle between T and v_q, whatever alpha (the text after
    Zhou 2.25 allows alpha <= 90 deg only), and v_q is not parallel to T, where all or none of the circle grazes.
    Raises InputError for an inadmissible family.
    """
    family = surface(h, 1)
    require_admissible(h, family)
    origin, rotation = frame.origin.derivatives(), frame.rotation.derivatives()
    velocity = _turned(rotation[1], family.centre) + origin[1]
    across = np.cross(_turned(rotation[0], family.normal).value, velocity.value)
    size, speed = np.linalg.norm(across, axis=1), np.linalg.norm(velocity.value, axis=1)
    parts = np.linalg.norm(velocity.value - origin[1], axis=1) + np.linalg.norm(origin[1], axis=1)
    exists = (np.abs(family.cosine.value) * speed <= size) & (size > PARALLEL * parts) & (parts > AT_REST)
    side = np.where(exists, branch, np.nan)
    with np.errstate(invalid="ignore", divide="ignore"):
        n_h = _normal(_turned(rotation[0], family.normal), velocity, family.cosine, side)
        point_h = _turned(rotation[0], family.centre) + origin[0] + family.radius.column * n_h
        centre_t = _turned(frame.rotation, family.centre.value) + frame.origin
        n_t = _normal(_turned(frame.rotation, family.normal.value), centre_t.derivative(), family.cosine.value, side)
        point_t = centre_t + n_t * family.radius.value[:, None]
    return Grazing(exists, point_h.value, n_h.value, point_h.c[1], point_t.c[1], n_h.c[1], n_t.c[1])


def _normal(t: Series, v: Series, cosine: Series | NDArray, branch: NDArray) -> Series:
    """Zhou 2.30 as a series; the branch is labelled by the sign of n . (T x v)."""
    across = cross(t, v)
    size2, speed2 = dot(across, across), dot(v, v)
    root = series.sqrt(size2 - speed2 * cosine * cosine) * branch
    lengthwise, back = speed2 * cosine, dot(t, v) * cosine
    return (lengthwise.column * t - back.column * v + root.column * across) / size2.column


def _turned(rotation: NDArray | Series, vector: NDArray | Series) -> Series:
    """rotation @ vector, one of them a series."""
    a = rotation.c if isinstance(rotation, Series) else rotation
    b = vector.c if isinstance(vector, Series) else vector
    return Series(np.einsum("...ij,...j->...i", a, b))


def _cut(s: Series, order: int) -> Series:
    return Series(s.c[: order + 1])
