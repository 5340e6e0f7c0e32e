"""Hypoid pinion settings carried to the Phoenix and the Star: tables, what linear axes cost, one surface by all roads.

Litvin and Chen 1994, sections 1 to 3; the report's formulas stand in hypoid_report.py.
"""

from __future__ import annotations

import numpy as np
import pytest

from gearsim.cutters.catalogue import conical
from gearsim.envelope.machined import machined_along
from gearsim.machines.catalogue import head_b_table_c, phoenix, star
from gearsim.metrology.deviation import measure
from gearsim.metrology.samples import sample_grid
from gearsim.motion.segments import compile_motion
from gearsim.motion.sources import CurveMotion
from gearsim.simulation.removal import cut as remove
from gearsim.toolpaths.roll import roll_axes, roll_motion
from tests.helpers import observed_order
from tests.surfaces.test_hypoid import SETTINGS, least_distance, make_generator, make_pinion, rolled
from tests.validation.hypoid_report import GEAR_TO_REPORT, M_CP, PHI_P, R_C, X_E, report_path, rx, ry

MACHINES = {"phoenix": phoenix(X_E), "star": star()}


def table(name, rows, start, end, **options):
    near = None if not options.get("with_turn", True) else report_path(name)[np.argmin(np.abs(PHI_P + start / M_CP))]
    return roll_axes(MACHINES[name], make_generator().frames, start, end, rows, near=near, **options)


@pytest.mark.parametrize("name", ["phoenix", "star"])
def test_the_table_is_the_report_s_and_brings_the_head_to_its_frame(name):
    """Equations (16)-(19) against the machine's chain and inverse; mu is carried."""
    start, end = -M_CP * PHI_P[[0, -1]]
    path = table(name, len(PHI_P), start, end)
    assert not path.messages()
    assert np.allclose(path.values, report_path(name), atol=1e-10)
    frames = make_generator().frames(-M_CP * PHI_P, 0)
    for made, wanted in zip(MACHINES[name].frame_series(MACHINES[name].constant(path.values)), frames, strict=True):
        assert np.abs(made.value - wanted.value).max() < 1e-10


def test_a_head_that_is_a_body_of_revolution_needs_no_turn():
    still = table("phoenix", 15, -0.2, 0.2, with_turn=False)
    five = roll_axes(head_b_table_c(), make_generator().frames, -0.2, 0.2, 15, with_turn=False)
    pose = make_generator().poses(np.linspace(-0.2, 0.2, 15), 0)
    assert np.all(still.values[:, MACHINES["phoenix"].axes.index("C")] == 0.0)
    for path in (still, five):
        for made, wanted in zip(path.machine.forward(path.values), pose, strict=True):
            assert np.abs(made - wanted.value).max() < 1e-10


def interpolated(name, values, start, end):
    """Poses of a table run linearly, by the report's matrices alone, as a function of the cradle angle."""
    roll = np.linspace(start, end, len(values))

    def poses(phi):
        x, y, z, a, b, _ = (np.interp(phi, roll, column) for column in values.T)
        if name == "phoenix":
            l_pm = rx(a) @ ry(b)
            tip, into = np.einsum("nij,nj->ni", l_pm, np.stack([x, y, z], -1)) - [X_E, 0.0, 0.0], l_pm[..., 2]
        else:
            lifted = np.einsum("nij,nj->ni", ry(b), np.stack([0.0 * x, y, z], -1)) + np.stack([x, 0.0 * x, 0.0 * x], -1)
            tip, into = np.einsum("nij,nj->ni", rx(a), lifted), (rx(a) @ ry(b))[..., 0]
        return tip @ GEAR_TO_REPORT, -into @ GEAR_TO_REPORT

    return poses


@pytest.mark.parametrize("name", ["phoenix", "star"])
@pytest.mark.parametrize("side", ["concave", "convex"])
def test_what_linear_axes_between_rows_cost(name, side):
    """Brute force: deviation of the flank cut from N rows; it falls by the second order of the step.

    The concave flank is overcut, the convex one is left standing: 33 rows for 33 deg of cradle cost 0.9 to
    3.5 um and 0 to 2.6 um on the Phoenix, 0.9 to 3.5 um and 0 to 2.8 um on the Star.
    """
    pinion = make_pinion()
    start, end = pinion.cut(side).motion_range
    grid = sample_grid(pinion.flank(side), 5, 7)
    errors, rows = [], np.array([9, 17, 33, 65, 129])
    for n in rows:
        values = table(name, n, start, end).values
        deviation, _ = least_distance(interpolated(name, values, start, end), (start, end), grid.point.reshape(-1, 3))
        errors.append(np.abs(deviation).max())
        assert np.all((deviation < 0.0) if side == "concave" else (deviation > -1e-9))
    assert 1.9 < observed_order(errors, 1.0 / (rows - 1)) < 2.1
    assert 2e-3 < errors[2] < 4e-3


def outside_blades():
    """A solid of the head's outside: it cuts the concave flank as the ring does."""
    angle, e = SETTINGS["outer_angle"], SETTINGS["edge_radius"]
    return conical(R_C["concave"] - e * (1.0 - np.sin(angle)) / np.cos(angle), e, angle, SETTINGS["blade_height"])


@pytest.mark.parametrize("side", ["concave", "convex"])
def test_both_roads_and_brute_force_see_one_surface(side):
    """The exact motion leaves the closed form to the nanometre; of 33 rows all see the same deviations.

    The removal road cuts the concave flank with a solid of the outside blades.
    """
    pinion = make_pinion()
    cut = pinion.cut(side)
    start, end = cut.motion_range
    rays = sample_grid(pinion.flank(side), 5, 7, margin=0.01).rays()
    path = table("phoenix", 33, start, end)
    linear = roll_motion(path), interpolated("phoenix", path.values, start, end)
    for exact, (source, poses) in ((True, (CurveMotion(cut.poses, start, end), rolled(cut))), (False, linear)):
        found = machined_along(rays, [source], cut.head).deviation
        machined = rays.origin + found[:, None] * rays.direction
        assert np.abs(least_distance(poses, (start, end), machined)[0]).max() < 2e-9
        assert (np.abs(found).max() < 1e-9) == exact
        if side == "concave":
            tool = outside_blades()
            removed = remove(rays, compile_motion(source, tool.reach), tool).require_trust().removed
            assert np.abs(measure(rays, removed).value - found).max() < 1e-9
