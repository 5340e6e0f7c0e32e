"""Slots, round work on the blank and the chain of all operations."""

from dataclasses import replace

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.machines.catalogue import head_b_table_c, phoenix, table_table_ac
from gearsim.motion.program import cutting as cutting_motion
from gearsim.programs.operation import Tool
from gearsim.surfaces.cylindrical_gear import SIDES
from gearsim.surfaces.involute import InvoluteFlank
from gearsim.toolpaths.cylindrical.plan import plan_gear, usual_steps
from gearsim.toolpaths.cylindrical.preparation import bore, face, outside_diameter, reference_ring
from gearsim.toolpaths.cylindrical.settings import Bore, Cutting, Facing, OutsideDiameter, ReferenceRing, Slotting
from gearsim.toolpaths.cylindrical.slots import slot_spaces
from tests.toolpaths.cylindrical_gears import MACHINE, RADIUS, distances, first_space, poses, thesis

FEED = 12000 * 3 * 0.0508


@pytest.mark.parametrize("helix_deg", [0.0, 10.0, -10.0])
def test_slots_keep_their_stock_and_reach_the_root(helix_deg):
    gear = thesis(15, helix_deg)
    operation = slot_spaces(gear, MACHINE)
    tip, axis = (a.reshape(-1, 3) for a in poses(operation.blocks, first_space(operation, gear), np.linspace(0, 1, 31)))
    assert np.hypot(tip[:, 0], tip[:, 1]).min() == pytest.approx(gear.root_radius)
    assert np.abs(axis[:, 2]).max() < 1e-12
    for side in SIDES:
        flank = InvoluteFlank(gear, side)
        u, v = np.meshgrid(np.linspace(*flank.limits, 9), [-0.1, -5.0, -9.9])
        gap, along = distances(flank.jet(u.ravel(), v.ravel()).r, tip, axis)
        nearest = gap[along >= 0.0].min() - RADIUS
        # The helix is steeper outside: flutes there come nearer by r (1 - cos(change of helix angle)).
        assert 0.1 - 1e-6 - RADIUS * (1.0 - np.cos(np.radians(0.3 * abs(helix_deg)))) <= nearest <= 0.1 + 1e-4


def test_slots_turn_round_above_and_below_the_gear():
    gear = thesis(15, 10.0)
    blocks = slot_spaces(gear, MACHINE).blocks
    tip, _ = poses(blocks, np.flatnonzero(blocks.rapid), np.linspace(0.0, 1.0, 11))
    assert tip[..., 2].min() > RADIUS + 0.5
    assert MACHINE.forward(blocks.values)[0][:, 2].min() < -10.0 - RADIUS - 0.5


def test_slots_are_milled_down_on_both_walls():
    """Down on the left, up on the right, the spindle clockwise seen along the radius from outside."""
    gear = thesis(15)
    operation = slot_spaces(gear, MACHINE)
    tip, _ = poses(operation.blocks, first_space(operation, gear), [0.0, 1.0])
    travel = (tip[:, 1] - tip[:, 0])[:, 2]
    walls = ~operation.blocks.rapid[first_space(operation, gear)] & (np.abs(travel) > 10.0)
    side = np.arctan2(tip[:, 0, 1], tip[:, 0, 0])
    off = np.abs(side) > 1e-3
    assert (np.sign(travel) == np.sign(side))[walls & off].all()


def test_slots_are_refused_where_they_cannot_be():
    with pytest.raises(InputError, match="need an external gear"):
        slot_spaces(thesis(-30), MACHINE)
    wide = Cutting(Tool(2, "wide", 16.0, 30.0, 3))
    with pytest.raises(InputError, match="wider than the slot"):
        slot_spaces(thesis(15), MACHINE, Slotting(cutting=wide))
    short = Cutting(Tool(2, "short", 3.175, 5.0, 3))
    with pytest.raises(InputError, match=r"11\.25 mm exceeds the flute length of 5 mm"):
        slot_spaces(thesis(15), MACHINE, Slotting(cutting=short))


def run(operation):
    """Tips (n, m, 3) of all feed blocks, arcs as the machine runs them."""
    motion, t = cutting_motion(operation.blocks), np.linspace(0.0, 1.0, 25)
    piece, time = (a.ravel() for a in np.meshgrid(np.arange(motion.pieces), t, indexing="ij"))
    return motion.pose(piece, time, 0).tip.value.reshape(motion.pieces, len(t), 3)


def test_a_bore_has_its_radius_at_every_level_and_nothing_left_in_the_middle():
    operation = bore(MACHINE, Bore(10.0, 8.0))
    tip = run(operation)
    radius = np.hypot(tip[..., 0], tip[..., 1])
    assert radius.max() == pytest.approx(10.0 - RADIUS)
    for z in np.arange(-8.0, 0.0):
        rings = np.unique(
            np.round(radius[(np.abs(tip[..., 2] - z) < 1e-9).all(axis=1) & (np.ptp(radius, axis=1) < 1e-6)], 6)
        )
        assert rings[0] < RADIUS
        assert rings[-1] == pytest.approx(10.0 - RADIUS)
        assert np.diff(rings).max() < 2.0 * RADIUS * 0.25 + 1e-6
    sweep = operation.blocks.sweep
    assert (sweep >= 0.0).all()  # anticlockwise in a hole: down-milling
    into = np.ptp(tip[..., 2], axis=1)[(tip[..., 2] < 0.0).any(axis=1)]
    assert into.max() <= 0.5 + 1e-9  # of the helix, a turn


def test_facing_reaches_the_edge_at_the_datum():
    tip = run(face(MACHINE, Facing(30.0, allowance=1.5)))
    assert np.hypot(tip[..., 0], tip[..., 1]).max() == pytest.approx(30.0 - RADIUS)
    assert tip[..., 2].min() == 0.0


def test_the_outside_diameter_comes_down_in_steps_and_its_rapids_stay_outside():
    operation = outside_diameter(MACHINE, OutsideDiameter(45.0, 42.5, 10.0))
    tip, blocks = run(operation), operation.blocks
    radius = np.hypot(tip[..., 0], tip[..., 1])
    assert radius.min() == pytest.approx(42.5 + RADIUS)
    assert (blocks.sweep[blocks.sweep != 0.0] < 0.0).all()  # clockwise round the outside: down-milling
    turned = 45.0
    for i in range(len(blocks)):
        if blocks.sweep[i]:
            turned = np.hypot(*blocks.values[i, :2]) - RADIUS if blocks.values[i, 2] == -10.0 else turned
        elif blocks.rapid[i]:
            ends = np.hypot(blocks.values[i, 0], blocks.values[i, 1]), np.hypot(*blocks.before[i, :2])
            assert min(ends) > turned + RADIUS or min(blocks.values[i, 2], blocks.before[i, 2]) == 5.0


def test_the_reference_ring_is_cut_from_wall_to_wall_by_the_table():
    operation = reference_ring(MACHINE, ReferenceRing(84.0, 89.0, 2.0))
    blocks = operation.blocks
    tip = run(operation)
    bottom = tip[(np.abs(tip[..., 2] + 2.0) < 1e-9).all(axis=1)]
    radius = np.hypot(bottom[..., 0], bottom[..., 1])
    assert radius.min() == pytest.approx(84.0 + RADIUS)
    assert radius.max() == pytest.approx(89.0 - RADIUS)
    turn = np.diff(blocks.values[:, 4], prepend=blocks.start[4])
    full = turn > 6.0
    assert np.degrees(turn[full]) == pytest.approx(np.full(full.sum(), 380.0))
    last = np.flatnonzero(full)[-1]
    assert np.hypot(*blocks.values[last, :2]) == pytest.approx(89.0 - RADIUS)  # the outer ring, too
    speed = turn[full] * np.hypot(blocks.values[full, 0], blocks.values[full, 1]) / blocks.seconds[full]
    assert 60.0 * speed == pytest.approx(np.full(full.sum(), FEED))


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: bore(MACHINE, Bore(1.0, 5.0)), "does not fit a radius of 1 mm"),
        (lambda: bore(MACHINE, Bore(10.0, 13.0)), "13 mm exceeds the flute length"),
        (lambda: outside_diameter(MACHINE, OutsideDiameter(40.0, 42.0, 5.0)), "must exceed 42 mm"),
        (lambda: reference_ring(MACHINE, ReferenceRing(84.0, 86.0, 1.0)), "less than the tool's diameter"),
        (lambda: bore(phoenix(), Bore(10.0, 5.0)), "right-handed frame"),
    ],
)
def test_impossible_round_work_is_refused(call, words):
    with pytest.raises(InputError, match=words):
        call()


def test_arcs_run_at_the_feed():
    operation = bore(MACHINE, Bore(10.0, 4.0))
    blocks = operation.blocks
    arcs = np.flatnonzero(blocks.sweep)
    length = np.hypot(
        blocks.sweep[arcs] * np.hypot(blocks.values[arcs, 0], blocks.values[arcs, 1]),
        blocks.values[arcs, 2] - blocks.before[arcs, 2],
    )
    assert 60.0 * length / blocks.seconds[arcs] == pytest.approx(np.full(len(arcs), FEED))


@pytest.mark.parametrize("machine", [MACHINE, table_table_ac(), head_b_table_c()], ids=lambda m: m.name)
@pytest.mark.parametrize("teeth", [15, -30])
def test_a_whole_gear_is_planned_on_every_table_machine(machine, teeth):
    gear = thesis(teeth, 10.0)
    first = Bore(gear.tip_radius, 10.0) if gear.is_internal else OutsideDiameter(45.0, gear.tip_radius, 10.0)
    operations = plan_gear(gear, machine, (first, *usual_steps(gear)))
    assert [o.name for o in operations][-2:] == ["tooth roughing", "tooth finishing"]
    same = plan_gear(gear, MACHINE, (first, *usual_steps(gear)))
    for i, (operation, other) in enumerate(zip(operations, same, strict=True)):
        assert (operation.blocks.operation == i).all()
        assert np.isfinite(operation.blocks.seconds[~operation.blocks.rapid]).all()
        rows = np.linspace(0, len(operation.blocks) - 1, 200).astype(int)
        for a, b in zip(
            machine.forward(operation.blocks.values[rows]), MACHINE.forward(other.blocks.values[rows]), strict=True
        ):
            assert np.allclose(a, b, rtol=0, atol=1e-9)


def test_a_machine_without_a_table_about_the_gear_is_refused():
    hanging = replace(MACHINE, work=())
    with pytest.raises(InputError, match="cannot turn the gear"):
        plan_gear(thesis(15), hanging, usual_steps(thesis(15)))


def test_an_operation_begins_on_the_turn_of_the_table_on_which_the_last_one_ended():
    gear = thesis(15)
    before, after = plan_gear(gear, MACHINE, (ReferenceRing(15.0, 22.0, 1.0), Slotting()))
    own = slot_spaces(gear, MACHINE).blocks
    turned = after.blocks.values[:, 4] - own.values[:, 4]
    assert before.blocks.values[-1, 4] > 4.0 * np.pi
    assert abs(after.blocks.start[4] - before.blocks.values[-1, 4]) <= np.pi
    assert np.allclose(turned, turned[0], atol=1e-9)
    assert turned[0] / (2.0 * np.pi) == pytest.approx(round(turned[0] / (2.0 * np.pi)), abs=1e-9)
    assert np.array_equal(after.blocks.values[:, :4], own.values[:, :4])
