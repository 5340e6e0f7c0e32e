"""Programs on real machines: nominal inverse and real forward at every instant, backlash by hand, compiled tables."""

from math import cos, pi, radians, sin

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.machines.catalogue import MACHINES, head_b_table_c, table_table_bc
from gearsim.machines.errors import Growth, MachineErrors, RealMachine, RotaryErrors, SlideErrors
from gearsim.motion.lost_motion import _played
from gearsim.motion.program import ProgramMotion
from gearsim.motion.real_motion import RealMotion
from gearsim.motion.segments import compile_motion
from tests.motion.test_program import block_table, sampled, some_values

FIVE_AXES = sorted(set(MACHINES) - {"cradle"})


def backlash(machine, **play):
    slides = {n: SlideErrors(backlash=b) for n, b in play.items() if n in "XYZ"}
    return MachineErrors(slides, {n: RotaryErrors(backlash=b) for n, b in play.items() if n in "ABC"}).real(machine)


@pytest.mark.parametrize("name", FIVE_AXES)
def test_a_machine_without_errors_moves_as_its_control_means(name, rng):
    """Tip control through the nominal inverse, series of order 2 and all, is the straight tip line again."""
    machine = MACHINES[name]()
    values = some_values(machine, rng, 5)
    program = ProgramMotion(block_table(machine, values, tip_control=[True, False, True, True]))
    real, t = RealMotion(program, RealMachine(machine, MachineErrors())), np.array([0.0, 0.3, 1.0])
    for ours, theirs in zip(sampled(real, t, 2), sampled(program, t, 2), strict=True):
        assert np.allclose(ours.c, theirs.c, rtol=0.0, atol=1e-9)


def test_under_tip_control_the_control_knows_nothing_of_the_pivots_error():
    """A head's B axis 50 um too far off hangs the tip by d (sin B, 0, cos B - 1) off the line, all along the block."""
    machine, d = head_b_table_c(200.0), 0.05
    values = np.array([[0.0, 0.0, 0.0, 0.0, 0.0], [30.0, -10.0, 5.0, 1.0, 0.0]])
    program = ProgramMotion(block_table(machine, values, tip_control=[True]))
    longer = MachineErrors(rotaries={"B": RotaryErrors(offset=(0.0, 0.0, d))}).real(machine)
    t = np.linspace(0.0, 1.0, 9)
    off = sampled(RealMotion(program, longer), t).tip.value - sampled(program, t).tip.value
    assert off == pytest.approx(np.stack([-d * np.sin(t), 0.0 * t, d * (1.0 - np.cos(t))], axis=1), abs=1e-12)
    assert np.abs(off - np.outer(t, off[-1])).max() > 1e-3  # ends alone do not tell it


def test_backlash_is_taken_up_before_a_carriage_turns_back():
    """0, 10, 4, 4 (Y moves), 3.995, 8 with 20 um: it stays at 10 until the drive stands at 9.98, and at 4.015 then."""
    machine = table_table_bc()
    x, y = [0.0, 10.0, 4.0, 4.0, 3.995, 8.0], [0.0, 0.0, 0.0, 5.0, 5.0, 5.0]
    program = ProgramMotion(block_table(machine, machine.values(X=x, Y=y), seconds=np.full(5, 6.0)))
    source = RealMotion(program, backlash(machine, X=0.02))
    assert source.rows.tolist() == [0, 1, 1, 2, 3, 4, 4]
    assert source.share == pytest.approx([1.0, 0.02 / 6.0, 1.0 - 0.02 / 6.0, 1.0, 1.0, 0.02 / 4.005, 1 - 0.02 / 4.005])
    ends = sampled(source, np.array([0.0, 1.0])).tip.value[:, 0].reshape(-1, 2)
    by_hand = [[0, 10], [10, 10], [10, 4.02], [4.02, 4.02], [4.02, 4.015], [4.015, 4.015], [4.015, 8]]
    assert ends == pytest.approx(np.array(by_hand, dtype=float), abs=1e-12)


def test_a_way_smaller_than_the_play_moves_nothing_and_all_of_it_moves_everything():
    machine = table_table_bc()
    for way, found in ((0.01, [0.01, 0.01, 0.01]), (0.02, [0.02, 0.02, 0.02]), (0.03, [0.03, 0.03, 0.02])):
        program = ProgramMotion(block_table(machine, machine.values(X=[0.0, way, 0.0])))
        source = RealMotion(program, backlash(machine, X=0.02))
        ends = sampled(source, np.array([1.0])).tip.value[:, 0]
        assert ends == pytest.approx(found[: source.pieces], abs=1e-15)


def test_other_tools_blocks_move_the_axes_too():
    """Of the second tool's blocks alone the first starts with what the first tool's way back has lost."""
    machine = table_table_bc()
    blocks = block_table(machine, machine.values(X=[0.0, -5.0, -6.0, -7.0]), tool=[1, 2, 2])
    source = RealMotion(ProgramMotion(blocks, blocks.tool == 2), backlash(machine, X=0.02))
    assert source.rows.tolist() == [1, 2]
    assert sampled(source, np.array([0.0, 1.0])).tip.value[:, 0] == pytest.approx([-4.98, -5.98, -5.98, -6.98])


def test_plays_by_doubling_are_those_of_a_loop(rng):
    for n in (1, 2, 3, 8, 37):
        way, play = rng.normal(size=(n, 3)) * [0.5, 5.0, 1.0], np.array([1.0, 1.0, 0.0])
        lost, found = np.zeros(3), []
        for step in way:
            lost = np.clip(lost - step, 0.0, play)
            found.append(lost)
        assert _played(way, play) == pytest.approx(np.array(found), abs=1e-12)


def test_an_arc_that_turns_an_axis_with_play_back_is_refused():
    """A quarter from +x to +y turns nothing back; on to -x it turns Y back; X and Z may have play in their ends."""
    machine = table_table_bc()
    for angle, play, wrong in (
        (pi / 2, {"X": 0.01, "Y": 0.01}, ""), (pi, {"X": 0.01}, ""), (pi, {"Z": 0.01}, ""), (pi, {"Y": 0.01}, "Y"),
        (2 * pi, {"X": 0.01}, "X"), (-pi / 2, {"X": 0.01, "Y": 0.01}, ""), (-pi, {"Y": 0.01}, "Y"),
    ):  # fmt: skip
        values = machine.values(X=[10.0, 10.0 * cos(angle)], Y=[0.0, 10.0 * sin(angle)])
        program = ProgramMotion(block_table(machine, values, sweep=[angle]))
        if wrong:
            with pytest.raises(InputError, match=rf"block 1 \(line 1\).*: {wrong} turns back within an arc"):
                RealMotion(program, backlash(machine, **play))
        else:
            RealMotion(program, backlash(machine, **play))


def test_the_spindle_grows_in_feeds_and_their_times_must_be_known():
    """Two feeds of 30 s with a rapid between: 1 um/min gives 0.5 um at the first one's end and 1 um at the last's."""
    machine, growing = table_table_bc(), MachineErrors(growth=Growth(rate=1e-3))
    columns = {"seconds": [30.0, np.nan, 30.0], "rapid": [False, True, False]}
    program = ProgramMotion(block_table(machine, machine.values(X=[0.0, 1.0, 2.0, 3.0]), **columns))
    tips = sampled(RealMotion(program, growing.real(machine)), np.array([0.0, 0.5, 1.0])).tip.value
    down = np.array([0.0, 0.25, 0.5, 0.5, 0.5, 0.5, 0.5, 0.75, 1.0])
    assert tips[:, 2] == pytest.approx(-1e-3 * down, abs=1e-12)
    unknown = ProgramMotion(block_table(machine, machine.values(X=[0.0, 1.0]), seconds=[np.nan]))
    with pytest.raises(InputError, match="line 1: nothing says how long this feed takes"):
        RealMotion(unknown, growing.real(machine))


@pytest.mark.parametrize("held", [False, True])
def test_the_compiled_table_meets_the_real_motion_within_its_tolerance(held, rng):
    """At instants that no check looked at; a coarser tolerance needs fewer rows."""
    machine = head_b_table_c(200.0)
    values = some_values(machine, rng, 6)
    program = ProgramMotion(block_table(machine, values, tip_control=np.full(5, held)))
    errors = MachineErrors(
        {"X": SlideErrors(1e-4, (0.01, 0.02, 0.03), 50.0, (1e-6, 2e-6, 3e-6), backlash=0.02)},
        {"B": RotaryErrors((0.01, 0.0, 0.02), (1e-4, 0.0, 0.0), swing=1e-4, backlash=1e-4)},
        growth=Growth(0.01, 1.0),
    )
    source, rows = RealMotion(program, errors.real(machine)), []
    for tolerance in (1e-9, 1e-5):
        table = compile_motion(source, 30.0, tolerance, radians(40.0))
        x = rng.uniform(-1.0, 1.0, len(table))
        t = table.start + 0.5 * (table.end - table.start) * (1.0 + x)
        true = source.pose(table.piece, t, 0)
        powers = x[:, None] ** np.arange(6)
        tip, axis = (np.einsum("nk,nkc->nc", powers, part) for part in (table.tip, table.axis))
        off = np.linalg.norm(tip - true.tip.value, axis=1) + 30.0 * np.linalg.norm(axis - true.axis.value, axis=1)
        assert off.max() < 1.2 * tolerance
        rows.append(len(table))
    assert rows[0] > rows[1]
    ends = [sampled(source, np.array([t])).tip.value for t in (0.0, 1.0)]
    assert np.abs(ends[0][1:] - ends[1][:-1]).max() < 1e-9  # and it is in one piece


def test_velocities_are_those_of_the_real_motion(rng):
    machine = head_b_table_c(200.0)
    program = ProgramMotion(block_table(machine, some_values(machine, rng, 4), tip_control=np.full(3, True)))
    errors = MachineErrors({"Z": SlideErrors(bow=(0.1, 0.0, 0.0), turn=(0.0, 1e-4, 0.0), backlash=0.02)})
    source = RealMotion(program, errors.real(machine))
    piece, h = np.arange(source.pieces), 1e-4
    at = {d: source.pose(piece, np.full(len(piece), 0.5 + d), 0).tip.value for d in (-h, h)}
    tip = source.pose(piece, np.full(len(piece), 0.5), 2).tip
    assert (at[h] - at[-h]) / (2.0 * h) == pytest.approx(tip.c[1], abs=1e-5)
    assert (at[h] + at[-h] - 2.0 * tip.c[0]) / (2.0 * h**2) == pytest.approx(tip.c[2], abs=1e-3)
