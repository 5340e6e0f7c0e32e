"""The theory of gearing's way: the equation of meshing, and curvature carried from the tool to the gear.

A second road to what `grazing` gives in closed form; it shares no formula with it. Tool: a surface of
revolution with axis l; u the radial unit vector through a tool point, w = l x u the circumferential one, p'
and l' the rates of tip and axis; a pose without spin turns with l x l', and spin about the axis changes
neither the contact nor the generated surface. Arrays broadcast; vectors have xyz last.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry.grazing import MeridianPoints, PoseJet
from gearsim.geometry.jets import Curvature

_NEWTON_STEPS = 50


def meshing_coefficients(
    pose: PoseJet, meridian: MeridianPoints, x: NDArray, y: NDArray
) -> tuple[NDArray, NDArray, NDArray]:
    """A, B, C of the equation of meshing n . v = A cos theta + B sin theta - C, shape (...).

    theta turns the radial vector from x to y, unit vectors of the tool normal to its axis. For given rotations
    Litvin's (10) and (26) have this form in theta on any surface of revolution. With n = nr u + nz l and the
    velocity v = p' + (l x l') x (z l + r u) of the tool's point,
        n . v = u . (nr p' + (z nr - r nz) l') + nz l . p'.
    """
    lever = meridian.z * meridian.nr - meridian.r * meridian.nz
    a, b = (meridian.nr * _dot(e, pose.tip_rate) + lever * _dot(e, pose.axis_rate) for e in (x, y))
    return a, b, -meridian.nz * _dot(pose.axis, pose.tip_rate)


def meshing_angle(a: NDArray, b: NDArray, c: NDArray, branch: NDArray) -> NDArray:
    """theta [rad] from A cos theta + B sin theta = C in closed form; branch +1 or -1, nan without a solution."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.arctan2(b, a) + branch * np.arccos(c / np.hypot(a, b))


def meshing_angle_newton(
    a: NDArray, b: NDArray, c: NDArray, start: NDArray | float, tolerance: float = 1e-13
) -> NDArray:
    """theta [rad] from the same equation by Newton's method, as the literature solves it, all points at once.

    From one start for all, shape (...) or a number: it settles on the branch the start is near. Raises
    InputError where it does not converge.
    """
    theta = np.broadcast_to(np.asarray(start, dtype=float), np.shape(a))
    for _ in range(_NEWTON_STEPS):
        cosine, sine = np.cos(theta), np.sin(theta)
        step = (a * cosine + b * sine - c) / (b * cosine - a * sine)
        theta = theta - step
        if np.max(np.abs(step), initial=0.0) <= tolerance:
            return theta
    raise InputError(
        f"Newton's method did not solve the equation of meshing in {_NEWTON_STEPS} steps: "
        "start nearer to the contact, if there is one"
    )


def meshing_lever(pose: PoseJet, nr: float, nz: float, radial: NDArray) -> NDArray:
    """Lever z nr - r nz [mm] of the contact on a cone's generatrix through a given radial vector u, shape (...).

    On a line of the meridian the lever rises like its arc length, and the equation of meshing is linear in it;
    so Litvin and Chen eliminate s (11). Their (10) prints +(O_oA x w_p), which has to be -(O_oA x w_p).
    """
    rise = nr * _dot(radial, pose.tip_rate) + nz * _dot(pose.axis, pose.tip_rate)
    return -rise / _dot(radial, pose.axis_rate)


def tool_point(pose: PoseJet, meridian: MeridianPoints, radial: NDArray) -> tuple[NDArray, NDArray]:
    """Points [mm] and the tool's outward normals at meridian points and radial unit vectors, (..., 3) each."""
    r, z, nr, nz = (np.asarray(m)[..., None] for m in meridian[:4])
    return pose.tip + z * pose.axis + r * radial, nr * radial + nz * pose.axis


def generated_curvature(pose: PoseJet, meridian: MeridianPoints, radial: NDArray) -> Curvature:
    """Curvature of the generated surface from the tool's and the motion, normal out of the gear's material.

    ``radial``, shape (..., 3), must solve the equation of meshing. Let the contact point run over both surfaces,
    with velocity x on the tool and x + v on the gear, while the motion's parameter runs at rate 1, and let
    S1, S2 be their shape operators for the tool's normal n, omega the tool's rotation. The normals' rates agree,
        S2 (x + v) = S1 x - omega x n,   hence   (S1 - S2)(x + v) = g,   g = S1 v + omega x n,
    and so does the equation of meshing's derivative along any such x,
        g . x = n . a + v . (omega x n),   hence   g . (x + v) = D,   D = n . a + v . (omega x n) + g . v,
    with the acceleration a of the tool's point. The first holds for every x + v that the second one allows:
    S1 - S2 = g g^T / D. These are Litvin's two systems of linear equations in coordinates free of the unknown
    principal directions; g is normal to the line of contact, D = 0 is an edge of regression.
    """
    r, z, nr, nz, bend = meridian
    across = np.cross(pose.axis, radial)
    a, b = _dot(radial, pose.axis_rate), _dot(across, pose.axis_rate)
    along = nr[..., None] * pose.axis - nz[..., None] * radial
    v_along = nr * (_dot(pose.axis, pose.tip_rate) - r * a) - nz * (_dot(radial, pose.tip_rate) + z * a)
    v_across = _dot(across, pose.tip_rate) + z * b
    k_along, k_across = -bend, -nr / r
    g_along, g_across = k_along * v_along - a, k_across * v_across + nz * b
    acceleration = nr * _dot(radial, pose.tip_rate2) + nz * _dot(pose.axis, pose.tip_rate2)
    acceleration += (z * nr - r * nz) * _dot(radial, pose.axis_rate2) - a * a * r * nr - (a * a + b * b) * z * nz
    d = acceleration + (g_along - a) * v_along + (g_across + nz * b) * v_across
    with np.errstate(invalid="ignore", divide="ignore"):
        s11, s12, s22 = g_along**2 / d - k_along, g_along * g_across / d, g_across**2 / d - k_across
    mean, half = 0.5 * (s11 + s22), 0.5 * (s11 - s22)
    spread, angle = np.hypot(half, s12), 0.5 * np.arctan2(s12, half)
    c, s = np.cos(angle)[..., None], np.sin(angle)[..., None]
    return Curvature(
        s11 * s22 - s12 * s12, mean, mean + spread, mean - spread, c * along + s * across, c * across - s * along
    )


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("...i,...i->...", a, b)
