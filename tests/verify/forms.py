"""Closed forms written for the tests from Zhou's equations, right and as printed, and bodies known in closed form."""

from dataclasses import replace

import numpy as np

from gearsim.cutters.catalogue import apt
from gearsim.motion.sources import CLMotion
from gearsim.verify import Claimed, ClosedForm

BALL = 2.0


def ball(height=30.0):
    return apt(2.0 * BALL, BALL, 0.0, BALL, 0.0, 0.0, height)


def circular_form(motion, cutter, circles, branch, slide=None):
    """Zhou 4.30 and 4.31: n_E and s = q + rho n_E from circles h, rho and cos(alpha), functions of v.

    ``slide(t)`` [mm] adds a velocity along the axis, the slip of 4.33.
    """

    def points(u, v):
        (tip, tip_rate), (axis, axis_rate) = (s.derivatives() for s in motion.pose(np.zeros(len(u), dtype=int), u, 1))
        h, rho, cosine = (c[:, None] for c in circles(v))
        velocity = tip_rate + h * axis_rate
        if slide is not None:
            velocity = velocity + slide(u)[:, None] * axis
        cross = np.cross(axis, velocity)
        size = np.sum(cross**2, axis=1, keepdims=True)
        square, rise = (np.sum(a * velocity, axis=1, keepdims=True) for a in (velocity, axis))
        with np.errstate(invalid="ignore"):
            root = np.sqrt(size - cosine**2 * square)
        normal = (cosine * square * axis - rise * cosine * velocity + branch * root * cross) / size
        return Claimed(tip + h * axis + rho * normal, -normal, t=u)

    return ClosedForm("from Zhou's equations", motion, cutter, points)


def with_own_normals(form, step=1e-4):
    """The form with normals from differences of its points, on the side its own ones are: a consistent surface."""

    def points(u, v):
        claimed = form.points(u, v)
        at = lambda du, dv: form.points(u + du * step, v + dv * step).point
        normal = np.cross(at(1, 0) - at(-1, 0), at(0, 1) - at(0, -1))
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        side = np.sign(np.sum(normal * claimed.normal, axis=1, keepdims=True))
        return replace(claimed, normal=side * normal)

    return replace(form, points=points)


def changed(form, **changes):
    """The form with some of its claims replaced: each change is a function of u, v and the claims."""

    def points(u, v):
        claimed = form.points(u, v)
        return replace(claimed, **{name: change(u, v, claimed) for name, change in changes.items()})

    return replace(form, points=points)


def corner_of_a_path(lean=0.0):
    """A ball on two straight CL steps at a right angle, and the tubes it leaves below its shank.

    ``lean`` [rad] moves the claimed points ahead on the ball, away from where it touches.
    """
    tips = np.array([[0.0, 0.0, 0.0], [20.0, 0.0, 0.0], [20.0, 15.0, 0.0]])
    motion = CLMotion(tips, np.tile([0.0, 0.0, 1.0], (3, 1)))
    along = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])

    def points(u, v):
        piece = np.minimum((2.0 * u).astype(int), 1)
        t = 2.0 * u - piece
        centre = tips[piece] + t[:, None] * (tips[piece + 1] - tips[piece]) + [0.0, 0.0, BALL]
        angle = np.pi * (1.0 + 0.02 + 0.96 * v)[:, None]
        side = np.cross([0.0, 0.0, 1.0], along[piece])
        spoke = np.cos(angle) * side + np.sin(angle) * np.array([0.0, 0.0, 1.0])
        spoke = np.cos(lean) * spoke + np.sin(lean) * along[piece]
        return Claimed(centre + BALL * spoke, -spoke, t=t, piece=piece)

    return ClosedForm("tubes", motion, ball(), points, joints=(0.5,))
