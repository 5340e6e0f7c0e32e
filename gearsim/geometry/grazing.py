"""The grazing condition: where a surface of revolution in motion touches its own envelope.

A point of the tool is tip + z l + r u, with the meridian point (r, z), the axis l and a unit radial
vector u; its normal is nr u + nz l. The envelope condition, normal . velocity = 0, then reads
    u . g + b = 0,   g = nr p' + (z nr - r nz) l',   b = nz l . p'
with tip velocity p' and axis velocity l'. For nr != 0, g is nr times the velocity of the effective centre
q = tip + (z - r nz/nr) l of Zhou 2015 (2.20, 2.33); the form used here also serves the flat disc, whose
effective radius is infinite. It has two solutions, the branches: the sign of u . (l x g).

Where g has no part across the axis the circle has no grazing point of its own: it moves along the axis
or stands still (a spinning tool), so that none of its points grazes, or all of them at once. The surface
is then made by a profile edge or by the tool standing at the path's ends.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.jets import Curvature, weingarten_curvature

# A circle that moves less than this [mm] in a unit of the motion's parameter stands still; one whose effective
# centre moves across its axis by less than this share of the motions it is made of moves along it.
AT_REST = 1e-10
PARALLEL = 1e-11


class MeridianPoints(NamedTuple):
    """Points of a meridian in the (r, z) half plane with outward normals, each of shape (n,).

    ``curvature`` [1/mm] is the meridian's own (positive on a convex arc, 0 on a line); the tangent along
    rising arc length is (-nz, nr).
    """

    r: NDArray
    z: NDArray
    nr: NDArray
    nz: NDArray
    curvature: NDArray


class PoseJet(NamedTuple):
    """A pose and its first two derivatives by the motion's parameter, each of shape (n, 3)."""

    tip: NDArray
    axis: NDArray
    tip_rate: NDArray
    axis_rate: NDArray
    tip_rate2: NDArray
    axis_rate2: NDArray


class Grazing(NamedTuple):
    """Grazing points X(s, t) [mm], shape (n, 3): s the profile's arc length, t the motion's parameter.

    ``normal`` points out of the tool, so into the gear; ``exists``, shape (n,), is False where the
    direction of motion is too steep for the profile's angle (Zhou 2.24), where it is along the axis and where
    the circle stands still; the rest is nan there. Derivatives are nan where the two branches meet.
    """

    exists: NDArray
    point: NDArray
    normal: NDArray
    point_s: NDArray
    point_t: NDArray
    normal_s: NDArray
    normal_t: NDArray

    def curvature(self) -> Curvature:
        """Curvature of the machined surface, normal out of the material (opposite to the tool's)."""
        return weingarten_curvature(self.point_s, self.point_t, -self.normal_s, -self.normal_t)


def grazing_points(pose: PoseJet, meridian: MeridianPoints, branch: NDArray) -> Grazing:
    """Closed-form grazing points of the given branch (+1 or -1), with first derivatives (Zhou 2.30-2.31)."""
    r, z, nr, nz, bend = (a[:, None] for a in meridian)
    lever = z * nr - r * nz
    lever_s = 1.0 - bend * (r * nr + z * nz)
    g = nr * pose.tip_rate + lever * pose.axis_rate
    rise = _dot(pose.axis, pose.tip_rate)
    b = nz * rise
    along = _dot(pose.axis, g)
    flat = g - along * pose.axis
    size2 = _dot(flat, flat)
    travel2, spin2 = _dot(pose.tip_rate, pose.tip_rate), _dot(pose.axis_rate, pose.axis_rate)
    parts2 = nr**2 * travel2 + ((z * nr) ** 2 + (r * nz) ** 2) * spin2
    moves = (size2 > PARALLEL**2 * parts2) & (travel2 + (r**2 + z**2) * spin2 > AT_REST**2)
    size2 = np.where(moves & (size2 >= b * b), size2, np.nan)
    with np.errstate(invalid="ignore", divide="ignore"):
        side = np.cross(pose.axis, flat)
        root = np.sqrt(size2 - b * b)
        u = (branch[:, None] * root * side - b * flat) / size2
        w = np.cross(pose.axis, u)
        across = _dot(w, g)
        across = np.where(across == 0.0, np.nan, across)
        g_s = -bend * nz * pose.tip_rate + lever_s * pose.axis_rate
        u_s = -(_dot(u, g_s) + bend * nr * rise) / across * w
        g_t = nr * pose.tip_rate2 + lever * pose.axis_rate2
        b_t = nz * (_dot(pose.axis_rate, pose.tip_rate) + _dot(pose.axis, pose.tip_rate2))
        tilt = _dot(u, pose.axis_rate)
        u_t = (tilt * along - _dot(u, g_t) - b_t) / across * w - tilt * pose.axis
    return Grazing(
        np.isfinite(size2[:, 0]),
        pose.tip + z * pose.axis + r * u,
        nr * u + nz * pose.axis,
        nr * pose.axis - nz * u + r * u_s,
        pose.tip_rate + z * pose.axis_rate + r * u_t,
        bend * (nr * pose.axis - nz * u) + nr * u_s,
        nr * u_t + nz * pose.axis_rate,
    )


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("ij,ij->i", a, b)[:, None]
