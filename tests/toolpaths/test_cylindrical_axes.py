from math import cos, pi, radians, sin

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.machines.catalogue import (
    head_b_table_a,
    head_b_table_c,
    head_head_cb,
    phoenix,
    star,
    table_table_ac,
    table_table_bc,
)
from gearsim.toolpaths.cylindrical.axes import GearTable

TURNING = [table_table_bc(), table_table_ac(), head_b_table_c(), phoenix(), star()]
TILTS = [0.0, 0.16, -0.16, 0.5 * pi]
CASES = [(m, t) for m in TURNING for t in TILTS if (m.name, t) != ("star", 0.5 * pi)]  # its slides fall into a plane


@pytest.mark.parametrize(("machine", "tilt"), CASES, ids=lambda x: getattr(x, "name", None))
def test_tip_and_axis_come_out_as_asked(machine, tilt):
    rng = np.random.default_rng(1)
    heading, tip = rng.uniform(-9.0, 9.0, 50), rng.uniform(-80.0, 80.0, (50, 3))
    got_tip, got_axis = machine.forward(GearTable(machine, tilt).values(heading, tip))
    axis = np.stack([-np.sin(heading) * sin(tilt), np.cos(heading) * sin(tilt), np.full(50, cos(tilt))], axis=-1)
    assert np.allclose(got_tip, tip, rtol=0, atol=1e-11)
    assert np.allclose(got_axis, axis, rtol=0, atol=1e-12)


@pytest.mark.parametrize(("machine", "tilt"), CASES, ids=lambda x: getattr(x, "name", None))
def test_a_lean_is_a_little_more_tilt(machine, tilt):
    rng = np.random.default_rng(2)
    heading, tip, lean = rng.uniform(-9.0, 9.0, 20), rng.uniform(-80.0, 80.0, (20, 3)), rng.uniform(-0.01, 0.01, 20)
    got_tip, got_axis = machine.forward(GearTable(machine, tilt).values(heading, tip, lean))
    s, c = np.sin(tilt + lean), np.cos(tilt + lean)
    assert np.allclose(got_tip, tip, rtol=0, atol=1e-11)
    assert np.allclose(got_axis, np.stack([-np.sin(heading) * s, np.cos(heading) * s, c], axis=-1), rtol=0, atol=1e-12)


@pytest.mark.parametrize(("machine", "tilt"), CASES, ids=lambda x: getattr(x, "name", None))
def test_what_is_linear_in_the_turning_frame_is_linear_in_all_axes(machine, tilt):
    t = np.linspace(0.0, 1.0, 11)
    heading = 3.0 + 2.0 * t
    frame = np.stack([40.0 + 2.0 * t, -5.0 + 30.0 * t, -9.0 * t], axis=-1)
    c, s = np.cos(heading), np.sin(heading)
    tip = np.stack([c * frame[:, 0] - s * frame[:, 1], s * frame[:, 0] + c * frame[:, 1], frame[:, 2]], axis=-1)
    values = GearTable(machine, tilt).values(heading, tip)
    assert np.abs(np.diff(values, 2, axis=0)).max() < 1e-11
    still = np.delete(values[:, 3:], GearTable(machine, tilt).column - 3, axis=1)
    assert np.ptp(still, axis=0).max() == 0.0


@pytest.mark.parametrize("tilt", [0.0, 0.16, -0.16])
def test_a_bc_table_turns_a_quarter_behind_the_heading_and_tilts_against_the_helix(tilt):
    values = GearTable(table_table_bc(), tilt).values([7.0], np.zeros((1, 3)))
    assert values[0, 3] == pytest.approx(-tilt, abs=1e-15)
    assert values[0, 4] == pytest.approx(7.0 - 0.5 * pi)


@pytest.mark.parametrize("machine", [head_head_cb(), head_b_table_a()], ids=lambda m: m.name)
def test_machines_that_cannot_turn_the_gear_are_refused(machine):
    with pytest.raises(InputError, match="cannot turn the gear"):
        GearTable(machine, 0.1)


def test_a_table_beside_the_gear_is_refused():
    with pytest.raises(InputError, match="cannot turn the gear"):
        GearTable(table_table_bc(centre=(0.1, 0.0, 0.0)), 0.1)


def test_travel_limits_choose_the_branch():
    machine = table_table_bc().limited(B=(0.0, 1.0))
    values = GearTable(machine, 0.16).values([0.0], np.zeros((1, 3)))
    assert values[0, 3] == pytest.approx(0.16)
    with pytest.raises(InputError, match="axis B must stand at"):
        GearTable(table_table_bc().limited(B=(-0.1, 0.1)), radians(10.0))
