"""The thesis's test gears (tables 5.3 to 5.6) and poses of a program, for the tests beside this file."""

from math import radians

import numpy as np

from gearsim.machines.catalogue import table_table_bc
from gearsim.surfaces.cylindrical_gear import CylindricalGear

RADIUS = 0.5 * 3.175
GEARS = [(15, 0.0), (15, 10.0), (15, -10.0), (-30, 0.0), (-30, 10.0), (-30, -10.0)]
MACHINE = table_table_bc()


def thesis(teeth, helix_deg=0.0, facewidth=10.0):
    return CylindricalGear.from_transverse(teeth, 5.0, radians(20.0), radians(helix_deg), facewidth)


def poses(blocks, rows, t):
    """Tips and axes (n, m, 3) within blocks ``rows`` (n,) at times t (m,) from 0 to 1, all axes linear in time."""
    before, values = blocks.before[rows], blocks.values[rows]
    between = before[:, None] + (values - before)[:, None] * np.asarray(t)[None, :, None]
    tip, axis = blocks.machine.forward(between.reshape(-1, values.shape[1]))
    return tip.reshape(len(rows), -1, 3), axis.reshape(len(rows), -1, 3)


def first_space(operation, gear):
    """The rows of the blocks that cut space 0."""
    return np.arange((len(operation.blocks) + 1) // gear.count - 1)


def distances(points, tip, axis):
    """Distance of points (p, 3) from tool axes (n, 3), and their place along them from the tip: (p, n) each."""
    arm = points[:, None] - tip[None]
    along = (arm * axis[None]).sum(axis=-1)
    return np.linalg.norm(arm - along[..., None] * axis[None], axis=-1), along
