"""The charts of kernels/charts.py in NumPy: points of the classes with their derivatives by t and by place."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.envelope.surface import pose_jet
from gearsim.geometry.grazing import AT_REST
from gearsim.motion.sources import MotionSource


def edge_jet(
    source: MotionSource, cutter: Profile, piece: NDArray, t: NDArray, edge: NDArray, angle: NDArray
) -> tuple[NDArray, NDArray, NDArray]:
    """Points of a profile edge's circle and their derivatives by t and by the angle about the axis.

    The derivative by t keeps the radial direction from turning about the axis; the difference is a motion
    along the circle.
    """
    tip, axis = (s.derivatives() for s in source.pose(piece, t, 1))
    ends = np.array([e.end for e in cutter.elements])[edge]
    u, around = _radial(axis[0], angle)
    r, z = ends[:, :1], ends[:, 1:]
    u_rate = -_dot(u, axis[1]) * axis[0]
    return tip[0] + z * axis[0] + r * u, tip[1] + z * axis[1] + r * u_rate, r * around


def arc_jet(
    source: MotionSource, cutter: Profile, piece: NDArray, t: NDArray, element: NDArray, angle: NDArray
) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray]:
    """The envelope of profile arcs over (t, angle about the axis) instead of (t, arc length).

    For a given radial direction u the envelope condition fixes the meridian normal:
        nr u.(p' + zc l') + nz (l.p' - rc u.l') = 0,
    with the arc's centre (rc, zc). This chart is regular where the other one folds (its branches meet: the
    bottom of a trough). Returns points, their derivatives by t and angle, arc lengths s [mm], branches.
    """
    pose = pose_jet(source, piece, t)
    rows = [(*e.centre, e.radius, *(e.angles if e.is_arc else (0.0, 0.0))) for e in cutter.elements]
    rc, zc, rho, first, last = (np.array(c)[element][:, None] for c in zip(*rows, strict=True))
    middle = 0.5 * (first + last)
    u, around = _radial(pose.axis, angle)
    q_rate, q_rate2 = pose.tip_rate + zc * pose.axis_rate, pose.tip_rate2 + zc * pose.axis_rate2
    lean = _dot(u, pose.axis_rate)
    a = _dot(pose.axis, pose.tip_rate) - rc * lean
    b = -_dot(u, q_rate)
    sign = np.where(a * np.cos(middle) + b * np.sin(middle) < 0.0, -1.0, 1.0)
    size = np.hypot(a, b)
    with np.errstate(invalid="ignore", divide="ignore"):
        nr, nz = sign * a / size, sign * b / size
        a_t = _dot(pose.axis_rate, pose.tip_rate) + _dot(pose.axis, pose.tip_rate2) - rc * _dot(u, pose.axis_rate2)
        b_t = lean * _dot(pose.axis, q_rate) - _dot(u, q_rate2)
        turn_t = (a * b_t - b * a_t) / size**2
        turn_angle = (-a * _dot(around, q_rate) + b * rc * _dot(around, pose.axis_rate)) / size**2
    along = -nz * u + nr * pose.axis
    u_t = -lean * pose.axis
    point = pose.tip + zc * pose.axis + rc * u + rho * (nr * u + nz * pose.axis)
    by_t = q_rate + (rc + rho * nr) * u_t + rho * nz * pose.axis_rate + rho * turn_t * along
    by_angle = (rc + rho * nr) * around + rho * turn_angle * along
    g = nr * pose.tip_rate + ((zc + rho * nz) * nr - (rc + rho * nr) * nz) * pose.axis_rate
    branch = np.where(_dot(u, np.cross(pose.axis, g)) < 0.0, -1.0, 1.0)
    turned = np.arctan2(nz, nr) - first
    s = rho * ((turned + 1.0) % (2.0 * np.pi) - 1.0)
    return point, by_t, by_angle, s[:, 0], branch[:, 0]


def disc_jet(
    source: MotionSource, cutter: Profile, piece: NDArray, t: NDArray, element: NDArray, place: NDArray
) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray]:
    """The envelope of discs and annuli over (t, place along the line of contact) instead of (t, radius).

    In a plane normal to the axis the points x from the axis with l . p' = l' . x graze: a line. This chart is
    regular where the line comes nearest to the axis and the other one folds. ``place`` runs over 0 to 2 pi for
    the whole diameter. Returns what ``arc_jet`` does; nan where the axis does not turn.
    """
    pose = pose_jet(source, piece, t)
    rows = [(e.start[0], e.end[0], e.start[1]) for e in cutter.elements]
    start, end, z = (np.array(c)[element][:, None] for c in zip(*rows, strict=True))
    half = np.maximum(start, end)
    along = half * (place[:, None] / np.pi - 1.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        turn2 = _dot(pose.axis_rate, pose.axis_rate)
        turn2 = np.where(turn2 > AT_REST**2, turn2, np.nan)
        line = np.cross(pose.axis, pose.axis_rate) / np.sqrt(turn2)
        line_t = np.cross(pose.axis, pose.axis_rate2) / np.sqrt(turn2)
        line_t -= _dot(line_t, line) * line
        foot = _dot(pose.axis, pose.tip_rate) / turn2
        rise_t = _dot(pose.axis_rate, pose.tip_rate) + _dot(pose.axis, pose.tip_rate2)
        foot_t = (rise_t - 2.0 * foot * _dot(pose.axis_rate, pose.axis_rate2)) / turn2
    x = foot * pose.axis_rate + along * line
    by_t = pose.tip_rate + z * pose.axis_rate + foot_t * pose.axis_rate + foot * pose.axis_rate2 + along * line_t
    branch = np.where((along < 0.0) == (end > start), -1.0, 1.0)
    s = np.sign(end - start) * (np.linalg.norm(x, axis=1, keepdims=True) - start)
    return pose.tip + z * pose.axis + x, by_t, half / np.pi * line, s[:, 0], branch[:, 0]


def line_jet(
    source: MotionSource, cutter: Profile, piece: NDArray, t: NDArray, element: NDArray, angle: NDArray
) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray]:
    """The envelope of straight elements over (t, angle about the axis) instead of (t, arc length).

    On a generatrix the normal is constant and the envelope condition is linear in the arc length s. This
    chart is regular where a circle's effective centre stands still, so that all of the circle grazes at once
    (a tool that turns about a point of its axis). Returns what ``arc_jet`` does; nan far off the element.
    """
    pose = pose_jet(source, piece, t)
    at = cutter.at(element, np.zeros(len(t)))
    r0, z0, nr, nz = (c[:, None] for c in at[:4])
    length = np.array([e.length for e in cutter.elements])[element][:, None]
    u, around = _radial(pose.axis, angle)
    rise = _dot(pose.axis, pose.tip_rate)
    rise_t = _dot(pose.axis_rate, pose.tip_rate) + _dot(pose.axis, pose.tip_rate2)
    lever, lean, lean_t, lean_angle = (
        z0 * nr - r0 * nz,
        *(_dot(a, b) for a, b in ((u, pose.axis_rate), (u, pose.axis_rate2), (around, pose.axis_rate))),
    )
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        s = -(nr * _dot(u, pose.tip_rate) + lever * lean + nz * rise) / lean
        s = np.where(np.abs(s - 0.5 * length) < length, s, np.nan)
        s_t = -(nr * (_dot(u, pose.tip_rate2) - lean * rise) + (lever + s) * lean_t + nz * rise_t) / lean
        s_angle = -(nr * _dot(around, pose.tip_rate) + (lever + s) * lean_angle) / lean
    way = nr * pose.axis - nz * u
    r, z = r0 - nz * s, z0 + nr * s
    g = nr * pose.tip_rate + (lever + s) * pose.axis_rate
    branch = np.where(_dot(u, np.cross(pose.axis, g)) < 0.0, -1.0, 1.0)
    by_t = pose.tip_rate + z * pose.axis_rate - r * lean * pose.axis + s_t * way
    return pose.tip + z * pose.axis + r * u, by_t, r * around + s_angle * way, s[:, 0], branch[:, 0]


def _radial(axis: NDArray, angle: NDArray) -> tuple[NDArray, NDArray]:
    """Unit vectors normal to the axes at an angle from a fixed direction's projection, and 90 deg on."""
    fixed = np.eye(3)[np.argmin(np.abs(axis), axis=1)]
    x = fixed - _dot(fixed, axis) * axis
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    y = np.cross(axis, x)
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    return c * x + s * y, c * y - s * x


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("ij,ij->i", a, b)[:, None]
