"""The least distance of a passing tool against a NumPy twin that looks at many poses and knows no bound."""

import numpy as np
import pytest
import warp as wp

from gearsim.kernels.passing import pass_distance
from gearsim.kernels.pose import Motion
from gearsim.kernels.ring import Ring
from gearsim.motion.segments import compile_motion
from gearsim.simulation.tools import motion_data, section_data
from tests.cutters.shapes import every_shape
from tests.simulation.test_removal import random_path

F64 = wp.float64
TOLERANCE = 1e-7
LOOKS = np.linspace(-1.0, 1.0, 401)


@wp.kernel(enable_backward=False)
def pass_kernel(
    ring: Ring, hollow: int, motion: Motion, row: wp.array(dtype=int), point: wp.array(dtype=wp.vec3d), enough: F64,
    out: wp.array(dtype=wp.vec2d),
):  # fmt: skip
    i = wp.tid()
    out[i] = pass_distance(ring, hollow, motion, row[i], point[i], enough, F64(TOLERANCE))


def passed(part, table, row, point, device, enough=1e9):
    out = wp.zeros(len(row), dtype=wp.vec2d, device=device)
    tool = [section_data(part, 100.0, device), int(part.is_ring), motion_data(table, device)]
    given = [wp.array(row, dtype=wp.int32, device=device), wp.array(point, dtype=wp.vec3d, device=device), enough]
    wp.launch(pass_kernel, len(row), inputs=[*tool, *given], outputs=[out], device=device)
    return out.numpy().T


def twin(part, table, row, point):
    """The least over poses a four-hundredth of the row apart."""
    powers = np.vander(LOOKS, 6, increasing=True)
    tip, axis = (np.einsum("xk,nkc->nxc", powers, c[row]) for c in (table.tip, table.axis))
    q = point[:, None] - tip
    z = (q * axis).sum(axis=2)
    return part.signed_distance(np.linalg.norm(q - z[..., None] * axis, axis=2), z).min(axis=1)


def points_about(part, table, row, rng):
    """Points in and around the tool's middle pose, every eighth on its axis."""
    _, radius, bottom, top = part.box
    heights = rng.uniform(bottom - 2.0, top + 2.0, (len(row), 1))
    aside = rng.normal(size=(len(row), 3)) * 0.7 * radius
    aside[::8] = 0.0
    return table.tip[row, 0] + heights * table.axis[row, 0] + aside


@pytest.mark.parametrize("name", every_shape())
def test_the_least_distance_is_certain(name, device):
    cutter, rng = every_shape()[name], np.random.default_rng(len(name))
    table = compile_motion(random_path(rng), cutter.reach)
    row = rng.integers(len(table), size=200)
    for part in cutter.parts:
        point = points_about(part, table, row, rng)
        found, undecided = passed(part, table, row, point, device)
        sampled = twin(part, table, row, point)
        between = table.speed[row] * (LOOKS[1] - LOOKS[0]) / 2.0
        assert not undecided.any()
        assert np.all(found <= sampled + TOLERANCE + 1e-12)
        assert np.all(found >= sampled - between)
        held = passed(part, table, row, point, device, enough=0.3)[0]
        np.testing.assert_allclose(held, np.minimum(found, 0.3), atol=TOLERANCE + 1e-12)


def test_a_point_on_the_axis_of_a_ball_is_below_its_pole(device):
    """The pole is where two normals of the section meet that rounding may put on either side of the axis."""
    from gearsim.cutters.end_mills import ball
    from gearsim.motion.sources import CLMotion

    still = CLMotion(np.zeros((2, 3)) + np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]), np.tile([0.0, 0.0, 1.0], (2, 1)))
    table = compile_motion(still, 20.0)
    point = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, -1e-12], [0.0, 0.0, 0.0], [1e-15, 0.0, -0.5]])
    found = passed(ball(6.0, 20.0), table, np.zeros(4, dtype=int), point, device)[0]
    np.testing.assert_allclose(found, -point[:, 2], atol=1e-12)
