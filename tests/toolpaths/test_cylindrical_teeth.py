"""Finishing and roughing of the thesis's gears, judged by the motion of their blocks alone."""

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.geometry.series import Series
from gearsim.programs.operation import Tool
from gearsim.surfaces.cylindrical_gear import SIDES
from gearsim.surfaces.flank_modification import FlankModification
from gearsim.surfaces.involute import InvoluteFlank
from gearsim.toolpaths.cylindrical.axes import GearTable
from gearsim.toolpaths.cylindrical.limits import reached_range
from gearsim.toolpaths.cylindrical.passes import flank_pass
from gearsim.toolpaths.cylindrical.settings import Cutting, Finishing, Roughing
from gearsim.toolpaths.cylindrical.teeth import finish_teeth, rough_teeth
from tests.toolpaths.cylindrical_gears import GEARS, MACHINE, RADIUS, distances, first_space, poses, thesis

T = np.linspace(0.0, 1.0, 7)


@pytest.fixture(scope="module", params=GEARS, ids=lambda g: f"z{g[0]} beta{g[1]:g}")
def gear(request):
    return thesis(*request.param)


@pytest.fixture(scope="module")
def finish(gear):
    return finish_teeth(gear, MACHINE)


@pytest.fixture(scope="module")
def rough(gear):
    return rough_teeth(gear, MACHINE)


def on_flank(gear, side, operation):
    """Rows of space 0 that are passes on a flank: both ends one tool radius from some point of it."""
    rows = first_space(operation, gear)
    rows = rows[~operation.blocks.rapid[rows]]
    flank, f = InvoluteFlank(gear, side), 1 if side == "right" else -1
    touching = []
    for ends in (operation.blocks.before, operation.blocks.values):
        tip, axis = MACHINE.forward(ends[rows])
        heading = ends[rows][:, 4] + 0.5 * np.pi
        z = tip[:, 2] - f * gear.sign * RADIUS * np.sin(gear.base_helix_angle)
        roll = f * (heading - flank.lambda_(z))
        arm = tip - flank.jet(roll, z).r
        gap = np.linalg.norm(arm - (arm * axis).sum(axis=1, keepdims=True) * axis, axis=1) - RADIUS
        touching.append((np.abs(gap) < 1e-9) & (roll > -1e-9))
    return rows[touching[0] & touching[1]]


def roll_at(gear, side, heading, z):
    f = 1 if side == "right" else -1
    return f * (heading - InvoluteFlank(gear, side).lambda_(z))


@pytest.mark.parametrize("side", SIDES)
def test_within_every_block_of_a_pass_the_tool_stands_on_the_exact_involute(gear, finish, side):
    rows = on_flank(gear, side, finish)
    assert len(rows) > 150
    rng = np.random.default_rng(2)
    t = rng.random(5)
    tip, axis = poses(finish.blocks, rows, t)
    tip, axis = tip.reshape(-1, 3), axis.reshape(-1, 3)
    ends = finish.blocks.before[rows][:, 4], finish.blocks.values[rows][:, 4]
    heading = (ends[0][:, None] + (ends[1] - ends[0])[:, None] * t).ravel() + 0.5 * np.pi
    for height in (0.0, 0.3, 1.0):  # of what is engaged
        z = tip[:, 2] * (1.0 - height)
        jet = InvoluteFlank(gear, side).jet(roll_at(gear, side, heading, z), z)
        arm = tip - jet.r
        arm = arm - (arm * axis).sum(axis=1, keepdims=True) * axis
        assert np.abs(np.linalg.norm(arm, axis=1) - RADIUS).max() < 1e-12
        assert (arm * jet.normal).sum(axis=1).min() > RADIUS - 1e-12


def test_no_move_comes_nearer_a_flank_than_its_stock(gear, finish, rough):
    """Brute force: points all over both flanks against the poses of every block of a space, rapids included."""
    for operation, stock in ((finish, 0.0), (rough, 0.1)):
        rows = first_space(operation, gear)
        tip, axis = (a.reshape(-1, 3) for a in poses(operation.blocks, rows, T))
        tip, axis = tip[::3], axis[::3]
        for side in SIDES:
            flank = InvoluteFlank(gear, side)
            low, high = flank.limits
            u, v = np.meshgrid(np.linspace(max(low, 0.02), high, 8), [-0.2, -5.1, -9.9])
            gap, along = distances(flank.jet(u.ravel(), v.ravel()).r, tip, axis)
            assert gap[along >= 0.0].min() > RADIUS + stock - 1e-6


@pytest.mark.parametrize("side", SIDES)
def test_the_tool_touches_the_flank_over_the_reached_range_and_only_there(gear, finish, side):
    z = np.array([-0.1, -0.6, -5.3, -9.55, -9.99])
    low, high = reached_range(gear, side, z, RADIUS, 0.5)
    rows = first_space(finish, gear)
    rows = rows[~finish.blocks.rapid[rows]]
    tip, axis = (a.reshape(-1, 3) for a in poses(finish.blocks, rows, np.linspace(0.0, 1.0, 25)))
    flank = InvoluteFlank(gear, side)
    for i, height in enumerate(z):
        inside = np.linspace(low[i] + 2e-4, high[i] - 2e-4, 6)
        gap, along = distances(flank.jet(inside, np.full(6, height)).r, tip, axis)
        assert np.where(along > -0.03, gap, np.inf).min(axis=1).max() < RADIUS + 4e-4
        outside = np.array([u for u in (low[i] - 0.04, high[i] + 0.04) if flank.limits[0] < u < flank.limits[1]])
        if len(outside):
            gap, along = distances(flank.jet(outside, np.full(len(outside), height)).r, tip, axis)
            assert np.where(along > -1e-9, gap, np.inf).min() > RADIUS + 1e-5


def test_speeds_of_tool_and_contact_never_exceed_the_feed(gear, finish, rough):
    for operation, feed in ((finish, 12000 * 3 * 0.0254), (rough, 12000 * 3 * 0.0508)):
        blocks, rows = operation.blocks, first_space(operation, gear)
        rows = rows[~blocks.rapid[rows]]
        change = (blocks.values - blocks.before)[rows] / blocks.seconds[rows, None]
        fastest = 0.0
        for t in (0.0, 0.5, 1.0):
            at = blocks.before[rows] + t * (blocks.values - blocks.before)[rows]
            pose = MACHINE.forward_series([Series(np.stack([at[:, i], change[:, i]])) for i in range(5)])
            engaged = np.maximum(-pose.tip.value[:, 2], 0.0) / pose.axis.value[:, 2]
            for part in (0.0, 0.5, 1.0):
                speed = np.linalg.norm(pose.tip.c[1] + part * engaged[:, None] * pose.axis.c[1], axis=1)
                assert 60.0 * speed.max() <= feed * (1.0 + 1e-9)
                fastest = max(fastest, 60.0 * speed.max())
        assert fastest > 0.97 * feed
        if operation is finish:
            for side in SIDES:
                passes = on_flank(gear, side, finish)
                f = 1 if side == "right" else -1
                rate = np.abs(blocks.values - blocks.before)[passes, 4] / blocks.seconds[passes]
                for ends in (blocks.before, blocks.values):
                    for height in (0.0, 1.0):
                        level = MACHINE.forward(ends[passes])[0][:, 2]
                        level = level - f * gear.sign * RADIUS * np.sin(gear.base_helix_angle)
                        z = level * (1.0 - height)
                        roll = roll_at(gear, side, ends[passes, 4] + 0.5 * np.pi, z)
                        assert 60.0 * (rate * gear.base_radius * roll).max() <= feed * (1.0 + 1e-9)


def test_every_flank_is_milled_down(gear, finish):
    """The spindle turns clockwise: in the direction of travel the material lies on the right."""
    for side in SIDES:
        rows = on_flank(gear, side, finish)
        tip, _ = poses(finish.blocks, rows, [0.0, 1.0])
        middle = 0.5 * (finish.blocks.before[rows, 4] + finish.blocks.values[rows, 4]) + 0.5 * np.pi
        z = tip[:, :, 2].mean(axis=1)
        normal = InvoluteFlank(gear, side).jet(roll_at(gear, side, middle, z), z).normal
        travel = tip[:, 1] - tip[:, 0]
        right = np.stack([travel[:, 1], -travel[:, 0]], axis=1)
        assert ((right * -normal[:, :2]).sum(axis=1) > 0.0).all()


def test_rapids_keep_above_the_face_or_clear_of_the_tip_cylinder(gear, finish, rough):
    for operation in (finish, rough):
        rapids = np.flatnonzero(operation.blocks.rapid)[:200]
        tip, axis = poses(operation.blocks, rapids, np.linspace(0.0, 1.0, 21))
        for part in np.linspace(0.0, 1.0, 5):
            top = np.minimum(tip[..., 2] * (1.0 - part), 0.0)
            point = tip + ((top - tip[..., 2]) / axis[..., 2])[..., None] * axis
            radius = np.hypot(point[..., 0], point[..., 1])
            away = gear.sign * (radius - gear.tip_radius) - RADIUS / np.cos(gear.base_helix_angle)
            assert (away[tip[..., 2] < RADIUS] > 0.49).all()


def test_concave_flanks_are_met_and_left_along_their_normal():
    gear = thesis(-30, 10.0)
    blocks = finish_teeth(gear, MACHINE).blocks
    for side, ends in (("right", -1), ("left", 1)):
        rows = on_flank(gear, side, finish_teeth(gear, MACHINE))
        outer = rows[np.flatnonzero(np.diff(rows, prepend=-9 if ends < 0 else rows[0]) > 1) - (ends > 0)]
        tip, _ = poses(blocks, outer + ends, [0.0, 1.0])
        away = (tip[:, 1] - tip[:, 0]) * ends
        station = blocks.before[outer] if ends < 0 else blocks.values[outer]
        foot = MACHINE.forward(station)[0][:, 2]
        normal = InvoluteFlank(gear, side).jet(roll_at(gear, side, station[:, 4] + 0.5 * np.pi, foot), foot).normal
        assert len(outer) >= 19
        assert np.allclose((away * normal).sum(axis=1), 0.5 * np.cos(gear.base_helix_angle), atol=1e-6)


def test_the_table_turns_on_without_jumps(gear, finish):
    turn = np.diff(finish.blocks.values[:, 4], prepend=finish.blocks.start[4])
    assert np.abs(turn).max() < 2.2
    assert np.abs(turn[~finish.blocks.rapid]).max() < 0.5
    assert np.ptp(finish.blocks.values[:, 3]) == 0.0
    spaces = (len(finish.blocks) + 1) // gear.count
    values = np.vstack([finish.blocks.start, finish.blocks.values])
    assert np.allclose(values[spaces : 2 * spaces, :4], values[:spaces, :4])
    assert np.allclose(values[spaces : 2 * spaces, 4] - values[:spaces, 4], gear.pitch_angle)


@pytest.mark.parametrize("beta", [0.0, 10.0, -10.0])
@pytest.mark.parametrize("teeth", [15, -30])
def test_a_modification_is_touched_by_the_tools_end_and_by_the_flutes_above(teeth, beta):
    """Linear modifications are touched all along the tool, at its radius from the modified flank's points."""
    gear = thesis(teeth, beta)
    bent = FlankModification(profile_slope=0.004, helix_slope=0.01)
    tool = RADIUS
    for side in SIDES:
        low, high = reached_range(gear, side, [-8.0, 0.0], tool, 0.5)
        rolls = np.linspace(low.max() + 0.06, high.min() - 0.06, 9)
        made = flank_pass(gear, side, -8.0, rolls, tool, bent)
        tip, axis = MACHINE.forward(GearTable(MACHINE, gear.base_helix_angle).values(made.heading, made.tip, made.lean))
        flank = InvoluteFlank(gear, side, 0, bent)
        for z in (-8.0, -5.0, -1.0):
            r = flank.jet(rolls - flank.sign * gear.twist * (z + 8.0), np.full(9, z)).r
            off = r - tip - ((r - tip) * axis).sum(axis=1, keepdims=True) * axis
            assert np.abs(np.linalg.norm(off, axis=1) - tool).max() < 2e-7


def test_finer_steps_and_equal_rolls_make_more_points():
    gear = thesis(15)
    coarse = finish_teeth(gear, MACHINE, Finishing(axial_step=5.0))
    fine = finish_teeth(gear, MACHINE, Finishing(axial_step=5.0, involute_step=0.1))
    rolled = finish_teeth(gear, MACHINE, Finishing(axial_step=5.0, involute_step=0.01, spacing="roll"))
    passes = on_flank(gear, "right", rolled)
    turn = np.abs(rolled.blocks.values - rolled.blocks.before)[passes, 4]
    assert len(fine.blocks) > 5 * len(coarse.blocks)
    assert turn.max() <= 0.01 + 1e-12
    assert np.ptp(turn) < 1e-9


def test_roughing_opens_the_whole_space_down_to_its_stock():
    """No web is left in the middle: every point between the flanks' stock lies in some pose's tool."""
    for teeth in (15, -30):
        gear = thesis(teeth)
        operation = rough_teeth(gear, MACHINE, Roughing(axial_step=5.0))
        tip, _ = (a.reshape(-1, 3) for a in poses(operation.blocks, first_space(operation, gear), T))
        start, end = (35.3, 42.0) if teeth > 0 else (70.6, 76.0)
        for radius in np.linspace(start, end, 8):
            half = float(gear.half_space(radius)) - 0.15 / radius
            angle = np.linspace(-half, half, 15)
            points = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0.0 * angle - 5.0], axis=-1)
            gap = np.linalg.norm(points[:, None, :2] - tip[None, tip[:, 2] < -4.9, :2], axis=-1)
            assert gap.min(axis=1).max() < RADIUS + 0.02


def test_a_face_width_beyond_the_flutes_is_refused_with_both_lengths():
    with pytest.raises(InputError, match=r"15 mm exceeds the flute length of 12\.7 mm"):
        finish_teeth(thesis(15, facewidth=15.0), MACHINE)


def test_a_tool_wider_than_the_space_is_refused():
    thick = Cutting(Tool(2, "thick", 12.0, 30.0, 3))
    with pytest.raises(InputError, match="cannot enter the spaces"):
        finish_teeth(thesis(-30), MACHINE, Finishing(cutting=thick))


def test_impossible_conditions_are_refused():
    with pytest.raises(InputError, match="feed_per_tooth must be positive"):
        Cutting(feed_per_tooth=0.0)
    with pytest.raises(InputError, match="axial_step must be positive"):
        Finishing(axial_step=-1.0)
    with pytest.raises(InputError, match="radial_immersion is at most 1"):
        Roughing(radial_immersion=1.5)
