import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.machines.catalogue import head_b_table_c, phoenix, star, table_table_bc
from gearsim.machines.generator import CradleGenerator
from gearsim.toolpaths.roll import roll_axes, roll_motion

GENERATOR = CradleGenerator(
    105.8, -1.51, -0.034, 3.77, tilt=0.32, swivel=-0.35, sliding_base=11.9, blank_offset=25.5,
    machine_centre_to_back=-6.6, modified_roll=(0.02, -0.03),
)  # fmt: skip


def frame_error(path, generator, start, end, parts):
    """Largest difference between the frames a table brings the tool to and the generator's."""
    wanted = generator.frames(np.linspace(start, end, len(path.values)), 0)
    made = path.machine.frame_series(path.machine.constant(path.values))
    return max(np.abs(getattr(made, p).value - getattr(wanted, p).value).max() for p in parts)


angle = st.floats(-0.9, 0.9)
length = st.floats(-60.0, 60.0)


@settings(max_examples=40, deadline=None)
@given(
    machine=st.sampled_from([phoenix(), star()]),
    radial=st.floats(20.0, 150.0),
    cradle=st.floats(-3.0, 3.0),
    ratio=st.floats(1.1, 6.0),
    root=angle, tilt=angle, swivel=angle, base=length, offset=length, back=length, roll=angle,
)  # fmt: skip
def test_any_settings_are_met_row_by_row(machine, radial, cradle, ratio, root, tilt, swivel, base, offset, back, roll):
    generator = CradleGenerator(radial, cradle, root, ratio, tilt, swivel, base, offset, back, (roll,))
    along = np.abs(generator.frames(np.linspace(-0.3, 0.3, 21), 0).axis.value[:, 2])
    assume(along.min() > 0.02 and along.max() < 0.999)
    path = roll_axes(machine, generator.frames, -0.3, 0.3, 21)
    assert frame_error(path, generator, -0.3, 0.3, ("tip", "axis", "radial")) < 1e-10


@pytest.mark.parametrize("machine", [phoenix(), star()], ids=lambda m: m.name)
def test_the_work_axis_goes_on_past_half_a_turn_and_rows_do_not_jump(machine):
    path = roll_axes(machine, GENERATOR.frames, -0.9, 0.9, 181)
    work = path.values[:, machine.axes.index("A")]
    assert np.ptp(work) > np.pi
    assert np.abs(np.diff(path.values[:, 3:], axis=0)).max() < 0.1


@pytest.mark.parametrize("machine", [phoenix(), star(), table_table_bc(), head_b_table_c()], ids=lambda m: m.name)
def test_without_the_tool_s_turn_five_axes_do(machine):
    path = roll_axes(machine, GENERATOR.frames, -0.3, 0.3, 11, with_turn=False)
    assert frame_error(path, GENERATOR, -0.3, 0.3, ("tip", "axis")) < 1e-10


def test_near_picks_the_branch():
    """The Phoenix's B axis: phi, or 180 degrees less phi (Litvin and Chen 16)."""
    straight = roll_axes(phoenix(), GENERATOR.frames, -0.3, 0.3, 11, near=np.zeros(6)).values
    over = roll_axes(phoenix(), GENERATOR.frames, -0.3, 0.3, 11, near=[0, 0, 0, np.pi, np.pi, np.pi]).values
    assert np.abs(straight[:, 4]).max() < 0.5 * np.pi
    assert np.allclose(straight[:, 4] + over[:, 4], np.pi, atol=1e-12)


def test_the_motion_passes_through_the_rows_and_is_linear_between_them():
    path = roll_axes(phoenix(), GENERATOR.frames, -0.3, 0.3, 7, near=np.zeros(6))
    motion = roll_motion(path)
    assert motion.pieces == 6
    middle = 0.5 * (path.values[2] + path.values[3])
    pose = motion.pose(np.array([2, 2]), np.array([0.0, 0.5]), 0)
    tip, axis = path.machine.forward(np.stack([path.values[2], middle]))
    assert np.allclose(pose.tip.value, tip, atol=1e-12)
    assert np.allclose(pose.axis.value, axis, atol=1e-14)
    exact = GENERATOR.frames(np.array([-0.05]), 0).tip.value
    assert 1e-4 < np.linalg.norm(pose.tip.value[1] - exact) < 0.5


def test_the_star_cannot_hold_a_head_square_to_the_work():
    """With B at 90 degrees its slides X and Z are parallel: no tilt and no machine root angle is out of reach."""
    square = CradleGenerator(105.8, -1.51, 0.0, 3.77)
    with pytest.raises(InputError, match="turn the slides into one plane"):
        roll_axes(star(), square.frames, -0.3, 0.3, 5)


def test_impossible_tables_are_refused_with_a_reason():
    with pytest.raises(InputError, match="at least 2 rows"):
        roll_axes(phoenix(), GENERATOR.frames, -0.3, 0.3, 1)
    with pytest.raises(InputError, match="3 rotary axes"):
        roll_axes(table_table_bc(), GENERATOR.frames, -0.3, 0.3, 5)
    short = phoenix().limited(Y=(-50.0, 50.0))
    with pytest.raises(InputError, match=r"axis Y overruns its limit of -?50 mm"):
        roll_motion(roll_axes(short, GENERATOR.frames, -0.3, 0.3, 5))
