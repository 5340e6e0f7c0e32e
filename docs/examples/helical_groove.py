"""A helical groove cut by a ball end mill, with its surface in closed form.

Check it with:  gearsim verify --surface docs/examples/helical_groove.py
Lengths in mm, angles in rad. gearsim calls the functions below with arrays and expects arrays.
"""

import numpy as np

from gearsim.cutters.catalogue import apt
from gearsim.verify import Claimed, principal

name = "helical groove"  # optional; what the report calls the surface

# The tool, from the catalogue: here a ball end mill of 3 mm radius.
BALL = 3.0
cutter = apt(d=2 * BALL, r=BALL, e=0.0, f=BALL, alpha=0.0, beta=0.0, h=20.0)

# The ball's centre runs along a helix of this radius and slope, through half a turn.
RADIUS, SLOPE, TURN = 20.0, 0.25, np.pi
LENGTH = np.hypot(1.0, SLOPE)


def helix(angle):
    """Centre, tangent, principal normal and binormal, each of shape (n, 3), and the curvature [1/mm]."""
    c, s, zero = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    centre = RADIUS * np.stack([c, s, SLOPE * angle], axis=1)
    tangent = np.stack([-s, c, zero + SLOPE], axis=1) / LENGTH
    normal = np.stack([-c, -s, zero], axis=1)
    return centre, tangent, normal, np.cross(tangent, normal), 1.0 / (RADIUS * LENGTH**2)


# The motion: tips and unit axes (from the tip to the shank), shape (n, 3), for t from 0 to 1.
# Instead, 'motion' may hold CL data: motion = CLMotion(tips, axes) from gearsim.motion.sources.
def pose(t):
    centre, *_ = helix(TURN * t)
    axis = np.tile([0.0, 0.0, 1.0], (len(t), 1))
    return centre - BALL * axis, axis


# The formula to be checked: points for u and v between 0 and 1. The ball's centre moves along the tangent, so
# the groove is made of circles normal to it; only their lower halves, below the shank, are cut by the ball.
def points(u, v):
    centre, _, normal, binormal, bend = helix(TURN * u)
    angle = np.pi * (1.0 + v)
    c, s = np.cos(angle), np.sin(angle)
    spoke = c[:, None] * normal + s[:, None] * binormal
    around = np.full(len(u), 1.0 / BALL)  # hollow: positive, since the normal points out of the material
    along = -bend * c / (1.0 - BALL * bend * c)
    return Claimed(
        point=centre + BALL * spoke,
        normal=-spoke,  # out of the material, so into the tool
        curvature=principal(around, along),  # optional; principal curvatures in any order
        t=u,  # optional; the pose said to cut the point: without it no point can count as trimmed
    )
