"""Voxels against closed forms, NumPy, tri-dexels and a mesh boolean: small parts, a handful of spacings."""

from math import acos, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from gearsim.cutters.end_mills import ball, flat
from gearsim.errors import InputError
from gearsim.geometry import series
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.rigid import Rigid, frame
from gearsim.geometry.series import Series
from gearsim.geometry.solid import Block
from gearsim.geometry.turned import Turned
from gearsim.motion.sources import CLMotion, CurveMotion
from gearsim.simulation import room
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.operation import operation
from gearsim.simulation.stock import AXES, blank_stock, cut_stock
from gearsim.simulation.voxel_cut import cut_voxels
from gearsim.simulation.voxel_volume import voxel_volume
from gearsim.simulation.voxels import AIR, SIDE, blank_voxels
from gearsim.simulation.workshop import Workshop
from tests.cutters.shapes import every_shape, polygon
from tests.helpers import observed_order

HERE = Rigid(np.eye(3), np.zeros(3))
BLOCK = Block(np.array([-3.0, -3.0, -2.5]), np.array([3.0, 3.0, 0.0]))
PITCHES = (0.4, 0.2, 0.1)
UP = np.array([0.0, 0.0, 1.0])


def line(cutter, *tips, axis=UP):
    motion = CLMotion(np.array(tips, dtype=float), np.tile(axis, (len(tips), 1)))
    return operation("line", cutter, [motion], 1e-9)


def circling(cutter, radius, depth):
    """The tip on a circle about z, the axis along it."""

    def curve(values, order):
        t = Series.variable(values, order)
        turn, none = series.exp(t * 1j), t * 0.0
        tip = series.stack([turn.real * radius, turn.imag * radius, none - depth])
        return PoseSeries(tip, series.stack([none, none, none + 1.0]))

    return operation("circle", cutter, [CurveMotion(curve, 0.0, 2.0 * pi)], 1e-9)


def swinging(cutter, arm, pivot):
    """The tool hangs from a pivot above the block and swings through it, its tip ``arm`` away."""

    def curve(values, order):
        t = Series.variable(values, order)
        turn, none = series.exp(t * 1j), t * 0.0
        tip = series.stack([turn.imag * arm, none, turn.real * -arm + pivot])
        return PoseSeries(tip, series.stack([turn.imag * -1.0, none, turn.real]))

    return operation("swing", cutter, [CurveMotion(curve, -0.9, 0.9)], 1e-9)


def segment(radius, height):
    """Area of a circle beyond a chord at a height."""
    return radius**2 * acos(height / radius) - height * sqrt(radius**2 - height**2)


SWUNG = quad(lambda y: segment(5.0 + sqrt(1.0 - y * y), 5.0), -1.0, 1.0)[0]
CUTS = {
    "blank": ([], 0.0),
    "ball along a line": ([line(ball(2.0, 20.0), (-6, 0.13, -1.3), (6, 0.13, -1.3))], 6 * (0.5 * pi + 0.6)),
    "ball along an arc, turning": ([swinging(ball(2.0, 20.0), 6.0, 5.0)], SWUNG),
    "cylinder plunge": ([line(flat(3.0, 20.0), (0.11, 0.2, 3), (0.11, 0.2, -1.27))], pi * 1.5**2 * 1.27),
    "cone sweep": (
        [line(polygon("cone", (0.0, 0.0), (4.0, 4.0), (0.0, 4.0)), (-9, 0.13, -1.3), (9, 0.13, -1.3))], 6 * 1.3**2,
    ),
    "torus groove": ([circling(ball(1.6, 20.0), 1.7, 0.8)], pi**2 * 1.7 * 0.8**2),
}  # fmt: skip


def box_about(solid, pitch, below=0.2, beyond=0.9):
    """A box around a solid that lies in it as ``below`` and ``beyond`` say, in spacings."""
    lower, upper = solid.box
    return DexelBox(HERE, lower - below * pitch, upper + beyond * pitch, pitch)


def every_node(stock):
    """All nodes, where they are, and their distances."""
    node = np.argwhere(np.ones(SIDE * np.array(stock.directory.shape), dtype=bool))
    return stock.box.frame.point(stock.origin + stock.spacing * node), stock.node_values(node)


@pytest.mark.parametrize("name", CUTS)
def test_volumes_lie_within_their_bounds_and_are_of_second_order(name):
    operations, removed = CUTS[name]
    true, errors, bounds = BLOCK.volume - removed, [], []
    for pitch in PITCHES:
        boxes = [box_about(BLOCK, pitch, 0.2 + shift, 0.9 - shift) for shift in (0.0, 0.46)]
        found = [voxel_volume(cut_voxels(blank_voxels(box, BLOCK), operations)) for box in boxes]
        assert all(v.least <= true <= v.most for v in found)
        assert all(abs(v.value - true) <= v.bound for v in found)
        errors.append(np.mean([abs(v.value - true) for v in found]))
        bounds.append(found[0].bound)
    assert observed_order(errors, PITCHES) > 1.7
    assert errors[-1] < 2e-3 * true
    assert observed_order(bounds, PITCHES) > 0.9


def test_a_turned_blank_in_a_box_that_cuts_it_off():
    blank = Turned(np.array([[0.0, -1.0], [2.5, -1.0], [2.0, 1.0], [0.0, 1.0]]))
    box = DexelBox(HERE, np.array([0.0, -3.0, -1.5]), np.array([3.0, 3.0, 1.5]), 0.1)
    found = voxel_volume(blank_voxels(box, blank))
    true = 0.5 * blank.volume
    assert found.least < true < found.most
    assert found.value == pytest.approx(true, rel=4e-3)


@pytest.mark.parametrize("name", ["T-slot", "spindle", "ring"])
def test_nodes_hold_what_numpy_finds(name):
    """The twin: the least distance over many poses, everywhere; where the brick is not kept it is a band or more."""
    cutter = every_shape()[name]
    _, radius, bottom, top = cutter.box
    tips = np.array([[-0.4, 0.1, 0.0], [0.5, -0.2, 0.1]]) + np.array([radius, 0.0, -0.3 * (bottom + top)])
    lean = np.array([[0.0, 0.0, 1.0], [0.0, np.sin(0.03), np.cos(0.03)]])
    path = CLMotion(tips, lean)
    done = operation("lean", cutter, [path], 1e-9)
    stock = cut_voxels(blank_voxels(box_about(BLOCK, 0.4), BLOCK), [done])
    point, value = every_node(stock)
    pose = path.pose(np.zeros(81, dtype=int), np.linspace(0.0, 1.0, 81), 0)
    tip, axis = pose.tip.value, pose.axis.value
    q = point[:, None] - tip
    z = (q * axis).sum(axis=2)
    r = np.linalg.norm(q - z[..., None] * axis, axis=2)
    passed = np.min([part.signed_distance(r, z).min(axis=1) for part in cutter.parts], axis=0)
    true = np.clip(np.maximum(BLOCK.signed_distance(point), -passed), -stock.band, stock.band)
    assert (-passed > BLOCK.signed_distance(point)).any()
    near = np.abs(true) < 0.999 * stock.band
    over = (value - true)[near]
    assert over.min() >= -stock.error
    assert over.max() <= (1.0 + 0.03 * cutter.reach) / 160.0  # the twin's poses are twice that apart
    assert np.median(over) < 1e-5
    assert np.array_equal(np.sign(value)[~near], np.sign(true)[~near])


def test_planes_of_nodes_that_are_faces_give_no_phantom_and_no_gouge():
    """A slot whose walls and floor, and a block whose faces, all lie in planes of nodes."""
    block = Block(np.zeros(3), np.array([4.0, 4.0, 3.0]))
    box = DexelBox(HERE, block.lower - 0.75, block.upper + 0.75, 0.5)
    whole = blank_voxels(box, block)
    stock = cut_voxels(whole, [line(flat(2.0, 20.0), (-3, 2, 1), (7, 2, 1))])
    assert voxel_volume(whole).value == pytest.approx(48.0, abs=1e-12)
    assert voxel_volume(stock).value == pytest.approx(32.0, abs=1e-12)
    point, value = every_node(stock)
    true = np.maximum(block.signed_distance(point), -np.maximum(np.abs(point[:, 1] - 2.0) - 1.0, 1.0 - point[:, 2]))
    assert np.array_equal(np.sign(value), np.sign(true))


@given(st.tuples(*[st.sampled_from([0.0, 0.5]) | st.floats(0.0, 1.0)] * 3), st.sampled_from([0.3, 0.25]))
@settings(max_examples=8, deadline=None, derandomize=True)
def test_wherever_the_grid_lies_signs_are_the_parts(shift, pitch):
    block = Block(np.zeros(3), np.array([3.0, 3.0, 2.0]))
    low, high = block.lower - pitch * (0.5 + np.array(shift)), block.upper + pitch * (1.5 - np.array(shift))
    stock = blank_voxels(DexelBox(HERE, low, high, pitch), block)
    stock = cut_voxels(stock, [line(flat(1.5, 20.0), (-3, 1.5, 0.75), (7, 1.5, 0.75))])
    point, value = every_node(stock)
    slot = np.maximum(np.abs(point[:, 1] - 1.5) - 0.75, 0.75 - point[:, 2])
    true = np.maximum(block.signed_distance(point), -slot)
    told = np.abs(true) > stock.error
    assert np.array_equal(np.sign(value)[told], np.sign(true)[told])
    assert np.abs(value)[~told].max(initial=0.0) <= 2.0 * stock.error
    found = voxel_volume(stock)
    edges = 4 * (3 + 3 + 2) + 4 * 3 + 4 * 1.25
    assert found.value == pytest.approx(18.0 - 3.0 * 1.5 * 1.25, abs=0.25 * pitch**2 * edges)


def test_sides_are_certain_and_distances_linear_between_nodes(rng):
    stock = cut_voxels(blank_voxels(box_about(BLOCK, 0.2), BLOCK), CUTS["cylinder plunge"][0])
    point = rng.uniform(-3.5, 3.5, (4000, 3))
    hole = np.maximum(np.hypot(point[:, 0] - 0.11, point[:, 1] - 0.2) - 1.5, -1.27 - point[:, 2])
    true = np.maximum(BLOCK.signed_distance(point), -hole)
    side = stock.side(point)
    assert np.array_equal(side[side != 0], np.sign(true)[side != 0])
    assert np.all(side[np.abs(true) > np.linalg.norm(stock.spacing)] != 0)
    inside = (true < 0.0) & (true > -0.3)
    off = np.abs(stock.distance(point) - true)[inside]
    assert off.max() <= 0.5 * np.linalg.norm(stock.spacing) + stock.error
    assert np.median(off) < 2e-3
    assert stock.side(np.array([[99.0, 0.0, 0.0], [-99.0, 0.0, 0.0]])).tolist() == [1, 1]


def test_the_order_of_cuts_does_not_matter_and_nothing_is_cut_twice():
    blank = blank_voxels(box_about(BLOCK, 0.25), BLOCK)
    cuts = CUTS["torus groove"][0] + CUTS["cone sweep"][0]
    one, other = cut_voxels(blank, cuts), cut_voxels(blank, cuts[::-1])
    assert np.array_equal(one.directory, other.directory)
    assert np.abs(one.values - other.values).max() <= one.error
    again = cut_voxels(one, cuts)
    assert np.array_equal(again.values, one.values)
    alone = cut_voxels(blank, cuts, threads=1)
    assert np.array_equal(alone.values, one.values)
    assert np.array_equal(alone.brick, one.brick)


def test_a_turned_box_gives_the_same_volume():
    turned = frame(np.array([0.1, 0.2, 0.3]), np.array([0.6, 0.8, 0.0]), UP)
    operations, removed = CUTS["cylinder plunge"]
    box = DexelBox(turned, np.full(3, -5.0), np.full(3, 5.0), 0.2)
    found = voxel_volume(cut_voxels(blank_voxels(box, BLOCK), operations))
    assert found.value == pytest.approx(BLOCK.volume - removed, rel=6e-3)


def test_a_part_that_is_gone_holds_nothing():
    block = Block(np.full(3, -0.5), np.full(3, 0.5))
    stock = cut_voxels(blank_voxels(box_about(block, 0.1), block), [line(flat(4.0, 9.0), (-3, 0, -2), (3, 0, -2))])
    assert voxel_volume(stock) == (0.0, 0.0, 0.0)
    assert len(stock.brick) == 0
    assert np.all(stock.directory == AIR)
    assert voxel_volume(cut_voxels(stock, CUTS["cone sweep"][0])).most == 0.0


def test_memory_is_asked_for_before_it_is_taken(monkeypatch):
    box = box_about(BLOCK, 0.1)
    monkeypatch.setattr(room, "memory_bytes", lambda: 1e6)
    with pytest.raises(
        InputError, match=r"voxel grid of pitch 0.1 mm .* bricks of 8³ voxels needs about .* GB; .*raise"
    ):
        blank_voxels(box, BLOCK)


def test_a_tolerance_below_what_searches_reach_is_refused():
    with pytest.raises(InputError, match="voxel tolerance 0 mm: expected 1e-09 mm or more"):
        cut_voxels(blank_voxels(box_about(BLOCK, 0.5), BLOCK), [], tolerance=0.0)


def mesh_volume(manifold3d, facets):
    """The block less the ball's groove along a line by a mesh boolean, and a bound of the facets' error."""
    groove = manifold3d.Manifold.sphere(1.0, facets).translate([-6.0, 0.13, -0.3])
    shank = manifold3d.Manifold.cylinder(9.0, 1.0, 1.0, facets).translate([-6.0, 0.13, -0.3])
    ends = [tool.translate([x, 0.0, 0.0]) for tool in (groove, shank) for x in (0.0, 12.0)]
    swept = manifold3d.Manifold.batch_hull(ends)
    block = manifold3d.Manifold.cube((BLOCK.upper - BLOCK.lower).tolist()).translate(BLOCK.lower.tolist())
    return (block - swept).volume(), 6.0 * pi * (1.0 - np.cos(pi / facets))


def sides_along(dexels, axis, stock):
    """Which side the middles of a bundle's stretches are on by the voxels, where they tell, and by the rays."""
    rays, left = dexels.box.rays(axis), dexels.left[axis]
    ray, middle = left.ray, 0.5 * (left.lo + left.hi)
    beyond = left.hi + 0.3 * stock.box.pitch
    at = [rays.origin[ray] + tau[:, None] * rays.direction[ray] for tau in (middle, beyond)]
    told = stock.side(np.concatenate(at))
    assert np.count_nonzero(told == -1) > 0.9 * len(ray)
    known = np.repeat([-1, 1], len(ray))
    return told, np.where(told == 0, 0, known)


def test_dexels_voxels_and_a_mesh_boolean_agree_within_their_bounds():
    manifold3d = pytest.importorskip("manifold3d")
    operations, _ = CUTS["ball along a line"]
    stock = cut_voxels(blank_voxels(box_about(BLOCK, 0.1), BLOCK), operations)
    voxels = voxel_volume(stock)
    dexels = cut_stock(blank_stock(box_about(BLOCK, 0.1), BLOCK), operations, Workshop("cpu"))
    mesh, mesh_bound = mesh_volume(manifold3d, 128)
    # a ray stands for its cell: wrong at most about points within half the cell's diagonal of the surface
    surface = 2 * 36.0 + 24 * 2.5 + 6.0 * (pi + 2 * 0.3)
    dexel_bound = sqrt(2.0) * 0.1 * surface
    for axis in AXES:
        assert abs(dexels.volumes[axis] - mesh) <= dexel_bound + mesh_bound
        assert abs(dexels.volumes[axis] - voxels.value) <= dexel_bound + voxels.bound
        assert np.array_equal(*sides_along(dexels, axis, stock))
    assert abs(voxels.value - mesh) <= voxels.bound + mesh_bound
    assert voxels.value == pytest.approx(mesh, abs=0.3)
    assert voxels.least - mesh_bound <= mesh <= voxels.most + mesh_bound
