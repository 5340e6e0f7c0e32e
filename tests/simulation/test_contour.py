"""Surfaces from tri-dexels: closed, manifold, sharp, and as large as what the rays hold."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from gearsim.cutters.catalogue import apt
from gearsim.cutters.end_mills import ball
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.solid import Block
from gearsim.geometry.triangles import TriangleMesh
from gearsim.geometry.turned import Turned
from gearsim.simulation.contour.cells import quads
from gearsim.simulation.contour.columns import columns
from gearsim.simulation.contour.crossings import across, along
from gearsim.simulation.contour.hits import Hits
from gearsim.simulation.contour.skin import close
from gearsim.simulation.contour.surface import contour
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.intervals import nothing, stretches
from gearsim.simulation.normals import EndNormals
from gearsim.simulation.stock import Stock, blank_stock, cut_stock
from gearsim.simulation.workshop import Workshop
from tests.conftest import random_rotation
from tests.helpers import observed_order
from tests.simulation.solids import Ball, Faceted
from tests.simulation.test_normals import move

HERE = Rigid(np.eye(3), np.zeros(3))
PLATE = Block(np.zeros(3), np.array([12.0, 10.0, 6.0]))
FLAT, ROUND = apt(3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0), ball(4.0, 20.0)
CUTS = [
    move(FLAT, (-3.0, 2.0, 4.0), (15.0, 3.0, 4.0)),
    move(ROUND, (3.0, 8.0, 4.5), (9.0, 7.5, 3.5)),
    move(FLAT, (9.13, 7.11, 7.0), (9.13, 7.11, -1.0)),
]


def cube(half, pitch, frame=HERE):
    return DexelBox(frame, np.full(3, -half), np.full(3, half), pitch)


def surface(box, solid):
    return contour(blank_stock(box, solid), EndNormals(solid, [], "cpu"))


def fans(mesh):
    """How many fans of triangles there are around all its vertices; of a manifold each has one."""
    corner, after, before = (np.roll(mesh.triangles, -k, axis=1).ravel() for k in range(3))
    n, m = len(mesh.points), len(corner)
    leaving, arriving = np.argsort(corner * n + after), np.argsort(corner * n + before)
    assert np.array_equal((corner * n + after)[leaving], (corner * n + before)[arriving])
    return connected_components(coo_matrix((np.ones(m), (leaving, arriving)), shape=(m, m)), directed=False)[0]


def check(found, euler):
    """Whether a surface is closed, manifold, of the right kind, and within its bound."""
    assert found.mesh.open_edges == 0
    assert fans(found.mesh) == len(np.unique(found.mesh.triangles)) == len(found.mesh.points)
    assert found.mesh.euler == euler
    assert abs(found.mesh.volume - found.volume) <= found.bound


@pytest.fixture(scope="module")
def plates():
    """A plate with a slot, a groove and a hole right through, at three pitches."""
    shop = Workshop("cpu")
    stocks = [cut_stock(blank_stock(DexelBox(HERE, *PLATE.box, p), PLATE), CUTS, shop) for p in (0.8, 0.4, 0.2)]
    return [(stock, contour(stock, EndNormals(PLATE, CUTS, "cpu"))) for stock in stocks]


@pytest.mark.parametrize("share", [0.15, 0.5, 0.7])
def test_whatever_nodes_are_material_the_surface_is_closed_and_manifold(share, rng):
    """Noise has every state of a cell, and the two other bundles agree with none of it."""
    shape = (14, 12, 13)
    solid = np.pad(rng.random(shape) < share, ((0, 0), (0, 0), (1, 1))).astype(int)
    steps = np.diff(solid, axis=2).reshape(shape[0] * shape[1], -1)
    ray, lo = np.nonzero(steps == 1)
    _, hi = np.nonzero(steps == -1)
    box = DexelBox(HERE, np.zeros(3), np.array(shape, dtype=float), 1.0)
    noise = stretches(shape[0] * shape[1], ray, lo.astype(float), hi.astype(float), -1)
    left = (nothing(shape[1] * shape[2]), nothing(shape[0] * shape[2]), noise)
    found = contour(Stock(box, left), lambda points, tags: np.tile([0.0, 0.0, 1.0], (len(points), 1)))
    check(found, found.mesh.euler)
    assert found.volume == solid.sum()
    assert found.apart > 1000


def test_a_lattice_may_close_around_its_first_index():
    """A ring of 9 sectors, two nodes wide and high: a torus; cut open it is a bar."""
    for periodic, euler in ((True, 0), (False, 2)):
        bars = stretches(
            9 * 4, 4 * np.repeat(np.arange(9), 2) + np.tile([1, 2], 9), np.full(18, 0.5), np.full(18, 2.5), -1
        )
        runs = columns((9, 4, 4), np.arange(4.0), bars, periodic)
        crossings = [across(runs, 0), across(runs, 1), along(runs)]
        found = quads(crossings, (9 if periodic else 10, 5, 5))
        sides = np.sort(np.stack([found.corners, np.roll(found.corners, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
        edges, count = np.unique(sides, axis=0, return_counts=True)
        assert np.all(count == 2)
        assert len(np.unique(found.corners)) - len(edges) + len(found.corners) == euler


def test_a_polar_lattice_is_contoured_too():
    """A torus about z on rings of nodes, left-handed and closed around z; each edge cut by itself, along its chord."""
    sectors, radii, heights = 60, 3.0 + 0.15 * np.arange(30), -1.4 + 0.15 * np.arange(20)

    def node(index):
        """Where nodes are that are counted as in crossings."""
        angle = 2.0 * np.pi * index[:, 0] / sectors
        r = 3.0 + 0.15 * (index[:, 1] - 1.0)
        return np.column_stack([r * np.cos(angle), r * np.sin(angle), -1.4 + 0.15 * (index[:, 2] - 1.0)])

    def over(p):
        return np.hypot(np.hypot(p[:, 0], p[:, 1]) - 5.0, p[:, 2]) - 1.0

    half = np.sqrt(np.maximum(1.0 - (radii - 5.0) ** 2, 0.0))
    column = (30 * np.arange(sectors)[:, None] + np.flatnonzero(half)).ravel()
    ends = np.tile(half[half > 0.0], sectors)
    runs = columns((sectors, 30, 20), heights, stretches(30 * sectors, column, -ends, ends, -1), periodic=True)
    crossings = [across(runs, 0), across(runs, 1), along(runs)]
    topology = quads(crossings, (sectors, 31, 21))
    index = np.concatenate([c.node for c in crossings])
    start, end = node(index), node(index + np.repeat(np.eye(3, dtype=int), [len(c) for c in crossings], axis=0))
    leaves, low, high = np.concatenate([c.leaves for c in crossings]), np.zeros(len(index)), np.ones(len(index))
    for _ in range(50):
        share = 0.5 * (low + high)
        beyond = (over(start + share[:, None] * (end - start)) < 0.0) == leaves
        low, high = np.where(beyond, share, low), np.where(beyond, high, share)
    point = start + low[:, None] * (end - start)
    ring = 5.0 * np.column_stack([point[:, :2] / np.hypot(point[:, 0], point[:, 1])[:, None], np.zeros(len(point))])
    normal = (point - ring) / np.linalg.norm(point - ring, axis=1)[:, None]
    cell = np.column_stack(np.unravel_index(topology.cell, (sectors, 31, 21)))
    corners = np.array([node(cell + np.array([i, j, k])) for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    at = Hits(point, normal, np.zeros(len(point), dtype=int))
    skin = close(topology, leaves, end - start, at, corners.min(axis=0), corners.max(axis=0))
    mesh = TriangleMesh(skin.points, skin.triangles[:, ::-1], skin.quad)
    assert mesh.open_edges == 0
    assert mesh.euler == 0
    assert fans(mesh) == len(mesh.points)
    assert np.abs(over(mesh.points)).max() < 0.02
    assert mesh.volume == pytest.approx(2.0 * np.pi**2 * 5.0, rel=0.01)


def test_simple_bodies_have_their_euler_characteristic(plates):
    turned = Turned(np.array([[2.0, -1.0], [4.5, -1.5], [4.5, 1.5], [2.0, 1.0]]))
    check(surface(cube(5.0, 0.4), Ball([0.1, 0.0, 0.2], 4.0)), 2)
    check(surface(cube(5.0, 0.4), turned), 0)
    for _, found in plates:
        check(found, 0)
    none = contour(Stock(cube(5.0, 1.0), (nothing(100),) * 3), EndNormals(PLATE, [], "cpu"))
    check(none, 0)
    assert none.mesh.volume == none.volume == 0.0


def test_a_balls_volume_converges_with_the_square_of_the_pitch_and_its_bound_with_the_pitch():
    solid, pitches = Ball([0.03, 0.02, 0.01], 4.0), np.array([0.8, 0.4, 0.2])
    found = [surface(cube(5.0, p), solid) for p in pitches]
    assert observed_order([f.mesh.volume - solid.volume for f in found], pitches) == pytest.approx(2.0, abs=0.2)
    assert observed_order([f.bound for f in found], pitches) == pytest.approx(1.0, abs=0.1)
    for f, pitch in zip(found, pitches, strict=True):
        off = np.linalg.norm(f.mesh.points - solid.centre, axis=1) - solid.radius
        assert np.abs(off).max() < 0.4 * pitch**2 / solid.radius
        assert f.apart == 0


def test_a_cut_plate_has_the_volume_of_its_rays(plates):
    for stock, found in plates:
        spread = max(stock.volumes) - min(stock.volumes)
        assert found.volume == stock.volumes[2]
        assert abs(found.mesh.volume - np.mean(stock.volumes)) < spread + 0.2 * stock.box.pitch**2


def test_faces_tell_what_made_them(plates):
    """The slot's floor is 3 wide along its slanted way over the plate; the hole's wall is round."""
    stock, found = plates[-1]
    made, area = stock.operation_of(found.mesh.tag), found.mesh.area_vectors
    assert set(made) == {-1, 0, 1, 2}
    up = np.abs(area[:, 2]) > 0.999 * np.linalg.norm(area, axis=1)
    floor = 3.0 * np.hypot(18.0, 1.0) / 18.0 * 12.0
    assert area[(made == 0) & up, 2].sum() == pytest.approx(floor, rel=0.02)
    middle = found.mesh.points[found.mesh.triangles[made == 2]].mean(axis=1)
    off = np.hypot(middle[:, 0] - 9.13, middle[:, 1] - 7.11) - 1.5
    assert np.quantile(np.abs(off), 0.95) < stock.box.pitch**2 / 1.5


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_turned_block_is_found_exactly(mirrored, rng):
    """Faces, edges and corners, in a box that is turned or mirrored against it."""
    frame = Rigid(random_rotation(rng) @ np.diag([1.0, 1.0, -1.0 if mirrored else 1.0]), np.array([1.0, -2.0, 0.5]))
    for pitch in (0.5, 0.25):
        block = Block(np.array([-2.0, -4.5, -1.5]), np.array([4.0, 0.5, 2.5]))
        found = surface(cube(5.0, pitch, frame), block)
        check(found, 2)
        off = np.sort(np.abs(np.concatenate([found.mesh.points - block.lower, block.upper - found.mesh.points], 1)), 1)
        assert off[:, 0].max() < 1e-12
        assert np.count_nonzero(off[:, 2] < 1e-9) == 8
        assert np.count_nonzero(off[:, 1] < 1e-9) > 60.0 / pitch
        assert found.mesh.volume == pytest.approx(block.volume, rel=1e-12)


def roof(degrees, rng):
    """A house with a ridge of an angle, turned at random."""
    half = np.radians(degrees) / 2.0
    planes = [[0, np.cos(half), np.sin(half)], [0, -np.cos(half), np.sin(half)]]
    planes += [[0, 0, -1], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]]
    return Faceted(np.array(planes) @ random_rotation(rng).T, [0.0, 0.0, 5.0, 3.0, 3.0, 2.0, 2.0])


@pytest.mark.parametrize("degrees", [60.0, 90.0, 120.0, 150.0])
def test_sharp_edges_are_kept(degrees, rng):
    """Every point lies on a plane to 1e-9 mm, and where it bends on two: one at least a cell along the edges."""
    for _ in range(3):
        solid = roof(degrees, rng)
        found = surface(cube(7.0, 0.5), solid)
        check(found, 2)
        off = np.sort(np.abs(solid.over(found.mesh.points)), axis=1)
        assert off[:, 0].max() < 1e-9
        on_edges = np.count_nonzero(off[:, 1] < 1e-9)
        assert on_edges >= np.count_nonzero(off[:, 1] < 0.02) - 1
        assert on_edges > 70.0 / 0.5  # the edges are some 80 mm long


def test_an_edge_too_thin_for_the_nodes_is_cut_off_within_a_cell(rng):
    solid = roof(15.0, rng)
    found = surface(cube(20.0, 0.5), solid)
    assert found.mesh.open_edges == 0
    assert abs(found.mesh.volume - found.volume) <= found.bound
    off = solid.over(found.mesh.points).max(axis=1)
    assert np.abs(off).max() < 0.5


def test_thin_walls_grow_no_spikes(rng):
    """A wedge of 20 deg whose ridge is cut off 0.3 wide: its sides would meet 0.85 above, the nodes are 0.5 apart."""
    for _ in range(5):
        sharp = roof(20.0, rng)
        down = -(sharp.planes[0] + sharp.planes[1])
        solid = Faceted(np.vstack([sharp.planes, -down]), [*sharp.heights, -0.85 * np.linalg.norm(down)])
        found = surface(cube(7.0, 0.5), solid)
        assert np.count_nonzero(solid.over(found.mesh.points).max(axis=1) > 0.05) <= 1


@settings(max_examples=15, deadline=None)
@given(st.data())
def test_a_slot_in_a_block_is_exact_wherever_nodes_and_faces_lie(data):
    """Faces of the blank and of the tool on nodes, between them, or anywhere: the volume is that of the closed form."""
    halves = data.draw(st.booleans())

    def between(low, high):
        return data.draw(st.integers(2 * low, 2 * high)) / 2.0 if halves else data.draw(st.floats(low, high))

    lower, upper = (np.array([between(a, a + 1) for a in corner]) for corner in ((0, 0, 0), (7, 9, 5)))
    y, floor = between(4, 5), between(2, 3)
    box = DexelBox(HERE, np.full(3, -1.0), np.array([9.0, 11.0, 7.0]), 1.0)
    block, slot = Block(lower, upper), move(apt(4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0), (-3, y, floor), (12, y, floor))
    found = contour(cut_stock(blank_stock(box, block), [slot], Workshop("cpu")), EndNormals(block, [slot], "cpu"))
    check(found, 2)
    assert found.mesh.volume == pytest.approx(block.volume - 4.0 * (upper - lower)[0] * (upper[2] - floor), abs=1e-8)


def test_walls_thinner_than_the_pitch_are_there_or_told_of():
    """Plates 0.2 thick, upright and level, that hold nodes or lie between them, at a pitch of 1."""
    for axis in range(3):
        for at, seen in ((0.45, True), (0.75, False)):
            lower, upper = np.full(3, -2.3), np.full(3, 2.3)
            lower[axis], upper[axis] = at - 0.05, at + 0.15
            wall = Block(lower, upper)
            found = surface(cube(4.0, 1.0), wall)
            check(found, 2 if seen else 0)
            assert found.mesh.volume == pytest.approx(wall.volume if seen else 0.0, abs=1e-9)
            assert found.unseen == pytest.approx(0.0 if seen or axis < 2 else found.volume)


def test_a_gap_thinner_than_the_pitch_is_filled_and_told_of():
    lo, hi = np.tile([0.0, 3.7], 36), np.tile([3.6, 6.0], 36)
    bundle = stretches(36, np.repeat(np.arange(36), 2), lo, hi, -1)
    whole = stretches(36, np.arange(36), np.zeros(36), np.full(36, 6.0), -1)
    box = DexelBox(HERE, np.zeros(3), np.full(3, 6.0), 1.0)
    found = contour(Stock(box, (whole, whole, bundle)), EndNormals(Block(np.zeros(3), np.full(3, 6.0)), [], "cpu"))
    check(found, 2)
    assert found.mesh.volume == pytest.approx(216.0)
    assert found.unseen == pytest.approx(3.6)


def test_a_box_within_the_blank_is_found_whole():
    """Its sides have normals of their own, whatever their coordinates are rounded to."""
    for lower, upper in ((-0.1, 0.6), (0.3, 1.1), (-7.7, -7.0)):
        box = DexelBox(HERE, np.full(3, lower), np.full(3, upper), 0.1)
        found = surface(box, Ball([0.0, 0.0, 0.0], 50.0))
        check(found, 2)
        assert found.mesh.volume == pytest.approx((upper - lower) ** 3, rel=1e-12)


def test_a_box_cuts_off_what_goes_on_beyond_it():
    solid = Ball([0.0, 0.0, 0.0], 4.0)
    box = DexelBox(HERE, np.array([0.0, -5.0, -5.0]), np.full(3, 5.0), 0.25)
    found = surface(box, solid)
    check(found, 2)
    assert found.mesh.points[:, 0].min() == pytest.approx(0.0, abs=1e-12)
    assert found.mesh.volume == pytest.approx(0.5 * solid.volume, rel=0.005)
    cut = found.mesh.area_vectors[np.all(np.abs(found.mesh.points[found.mesh.triangles, 0]) < 1e-12, axis=1)].sum(
        axis=0
    )
    assert np.allclose(cut, [-16.0 * np.pi, 0.0, 0.0], rtol=0.01, atol=1e-9)
