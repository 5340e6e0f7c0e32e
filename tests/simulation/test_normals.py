import numpy as np
import pytest

from gearsim.cutters.catalogue import apt
from gearsim.cutters.end_mills import ball
from gearsim.errors import NumericalError
from gearsim.geometry.rays import RayBundle
from gearsim.geometry.solid import Block
from gearsim.geometry.turned import Turned
from gearsim.motion.sources import CLMotion
from gearsim.simulation.normals import EndNormals
from gearsim.simulation.operation import operation
from gearsim.simulation.workshop import Workshop
from tests.cutters.shapes import every_shape, polygon
from tests.simulation.test_removal import UP, random_path

BLOCK = Block(np.zeros(3), np.array([30.0, 20.0, 10.0]))
SHAPES = every_shape()


def move(cutter, *tips):
    return operation("move", cutter, [CLMotion(np.array(tips, dtype=float), np.tile(UP, (len(tips), 1)))], 1e-9)


def ends_of(removed, rays):
    """Ray, place and row of all ends of what is removed."""
    ray = np.concatenate([removed.ray, removed.ray])
    point = rays.origin[ray] + np.concatenate([removed.lo, removed.hi])[:, None] * rays.direction[ray]
    return ray, point, np.concatenate([removed.lo_segment, removed.hi_segment])


def crossing_rays(op, rng, n, device):
    """Rays that meet the tool somewhere along its path."""
    cutter, table = op.cutter, op.table
    low_r, high_r, low_z, high_z = cutter.box
    row = rng.integers(len(table), size=n)
    direction = rng.normal(size=(n, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    away = np.cross(table.axis[row, 0], rng.normal(size=(n, 3)))
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    r, z = rng.uniform(low_r, high_r, (n, 1)), rng.uniform(low_z, high_z, (n, 1))
    origin = table.tip[row, 0] + z * table.axis[row, 0] + r * away - 200.0 * direction
    return RayBundle(origin, direction, np.zeros(n), np.full(n, 400.0))


def angle(a, b):
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.einsum("ij,ij->i", a, b))


def twin(op, point, row):
    """The cutter's signed distance at its least over the row, by many poses and golden sections, and its gradient."""

    def seen(x):
        powers = x[:, None] ** np.arange(6)
        tip, axis = (np.einsum("nk,nkc->nc", powers, c[row]) for c in (op.table.tip, op.table.axis))
        q = point - tip
        z = np.einsum("ij,ij->i", q, axis)
        w = q - z[:, None] * axis
        r = np.linalg.norm(w, axis=1)
        f, nr, nz = op.cutter.distance_gradient(r, z)
        return f, nr[:, None] * w / np.maximum(r, 1e-300)[:, None] + nz[:, None] * axis

    poses = np.linspace(-1.0, 1.0, 129)
    first = poses[np.argmin([seen(np.full(len(row), x))[0] for x in poses], axis=0)]
    a, b = np.maximum(first - 1 / 64, -1.0), np.minimum(first + 1 / 64, 1.0)
    share = 0.5 * (np.sqrt(5.0) - 1.0)
    for _ in range(45):
        left, right = b - share * (b - a), a + share * (b - a)
        lower = seen(left)[0] < seen(right)[0]
        a, b = np.where(lower, a, left), np.where(lower, right, b)
    return seen(0.5 * (a + b))


@pytest.mark.parametrize("name", SHAPES)
def test_normals_are_those_of_neighbouring_rays(name, rng, device):
    """Three rays a micrometre apart span the surface, whatever part, edge or pose of the tool made it."""
    cutter, step, n = SHAPES[name], 1e-3, 150
    op = operation("path", cutter, [random_path(rng)], 1e-9)
    rays = crossing_rays(op, rng, n, device)
    x = np.cross(rays.direction, rng.normal(size=(n, 3)))
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    y = np.cross(rays.direction, x)
    beside = [rays, *(RayBundle(rays.origin + d, *(getattr(rays, k) for k in ("direction", "start", "end")))
                      for d in (step * x, -step * x, step * y, -step * y))]  # fmt: skip
    removed = Workshop(device).cut([(r, [op]) for r in beside])
    counts = np.array([np.diff(k.first) for k in removed])
    same = np.flatnonzero((counts == counts[0]).all(axis=0) & (counts[0] > 0))
    normals, gathered = EndNormals(BLOCK, [op], device), []
    for end, made in (("lo", "lo_segment"), ("hi", "hi_segment")):
        first = [k.first[same] for k in removed]
        tau = np.array([getattr(k, end)[f] for k, f in zip(removed, first, strict=True)])
        rows = np.array([getattr(k, made)[f] for k, f in zip(removed, first, strict=True)])
        gathered.append((tau, rows, np.full(len(same), 1.0 if end == "lo" else -1.0)))
    tau, rows, sign = (np.concatenate(part, axis=-1) for part in zip(*gathered, strict=True))
    ray = np.concatenate([same, same])
    slope = np.array([tau[1] - tau[2], tau[3] - tau[4]]) / (2 * step)
    bend = np.array([tau[1] + tau[2], tau[3] + tau[4]]) - 2 * tau[0]
    good = (np.abs(slope).max(axis=0) < 3.0) & (np.abs(bend).max(axis=0) < step**2) & (rows == rows[0]).all(axis=0)
    found = normals(rays.origin[ray] + tau[0, :, None] * rays.direction[ray], rows[0])
    expected = sign[:, None] * (rays.direction[ray] - slope[0][:, None] * x[ray] - slope[1][:, None] * y[ray])
    assert good.sum() > 100
    assert angle(found, expected)[good].max() < 1e-4


@pytest.mark.parametrize("name", SHAPES)
def test_normals_agree_with_their_twin(name, rng, device):
    op = operation("path", SHAPES[name], [random_path(rng)], 1e-9)
    rays = crossing_rays(op, rng, 100, device)
    _, point, row = ends_of(Workshop(device).cut([(rays, [op])])[0], rays)
    gap, gradient = twin(op, point, row)
    found = EndNormals(BLOCK, [op], device)(point, row)
    assert np.abs(gap).max() < 2e-9
    off = angle(found, -gradient)
    assert np.quantile(off, 0.98) < 1e-6  # on sharp edges the twin's gradient is noise


GROOVE = move(ball(6.0, 30.0), (-5.0, 10.0, 6.0), (35.0, 10.0, 6.0))
SLOT = move(apt(4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 30.0), (15.0, -5.0, 5.0), (15.0, 25.0, 5.0))


def test_a_groove_of_a_ball_is_known_to_1e_8_rad(rng, device):
    """Points of the groove and of the ball's first and last place, cut by rays to 1e-9 mm."""
    short = move(ball(6.0, 30.0), (4.0, 10.0, 6.0), (9.0, 12.0, 5.0))
    rays = crossing_rays(short, rng, 2000, device)
    _, point, row = ends_of(Workshop(device).cut([(rays, [short])])[0], rays)
    start, way = np.array([4.0, 10.0, 9.0]), np.array([5.0, 2.0, -1.0])
    share = np.clip((point - start) @ way / (way @ way), 0.0, 1.0)
    inward = start + share[:, None] * way - point
    on_ball = np.abs(np.linalg.norm(inward, axis=1) - 3.0) < 1e-8
    off = angle(EndNormals(BLOCK, [short], device)(point, row), inward)[on_ball]
    assert len(off) > 400

    assert off.max() < 1e-8


def test_exact_places_have_the_normal_of_the_tool_that_is_named(device):
    """The floor, two walls, the groove's lowest line, the rim where the slot ends."""
    normals = EndNormals(BLOCK, [GROOVE, SLOT], device)
    points = np.array([[15.0, 3.0, 5.0], [17.0, 3.0, 7.0], [13.0, 3.0, 7.0], [9.0, 10.0, 6.0], [15.0, 27.0, 5.0]])
    first = len(GROOVE)
    found = normals(points, np.array([first, first, first, 0, first]))
    assert np.allclose(found[:4], [[0, 0, 1], [-1, 0, 0], [1, 0, 0], [0, 0, 1]], atol=1e-14)
    assert np.linalg.norm(found[4]) == pytest.approx(1.0)


def test_a_swept_rim_has_the_normal_that_its_way_gives(device):
    """A flat end mill going down along (1, 0, -1): the rim in front of it sweeps a slope of 45 deg."""
    op = move(apt(4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 30.0), (0.0, 0.0, 5.0), (4.0, 0.0, 1.0))
    found = EndNormals(BLOCK, [op], device)(np.array([[0.0, 0.0, 3.0]]), np.array([0]))
    assert np.allclose(found, np.array([[1.0, 0.0, 1.0]]) / np.sqrt(2.0), atol=1e-11)


def test_tags_of_turning_name_the_solid(device):
    disc = Turned(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]))
    normals = EndNormals(BLOCK, [SLOT, disc, GROOVE], device)
    points = np.array([[0.0, -4.0, 1.0], [1.0, 1.0, 2.0], [9.0, 10.0, 6.0], [30.0, 4.0, 5.0]])
    tags = np.array([len(SLOT), len(SLOT), len(SLOT) + 1, -1])
    assert np.allclose(normals(points, tags), [[0, -1, 0], [0, 0, 1], [0, 0, 1], [1, 0, 0]], atol=1e-14)


def test_the_point_of_a_drill_leaves_a_normal_along_its_axis(device):
    drill = move(polygon("drill", (0.0, 0.0), (2.0, 1.2), (2.0, 10.0), (0.0, 10.0)), (5.0, 5.0, 12.0), (5.0, 5.0, 4.0))
    found = EndNormals(BLOCK, [drill], device)(np.array([[5.0, 5.0, 4.0], [6.0, 5.0, 4.6]]), np.array([0, 0]))
    assert np.allclose(found, [[0.0, 0.0, 1.0], np.array([-1.2, 0.0, 2.0]) / np.hypot(1.2, 2.0)], atol=1e-12)


def test_a_point_that_its_tool_never_touched_is_refused(device):
    with pytest.raises(NumericalError, match=r"1 of 2 points .* by up to 1e\+06 nm: the stock is not of these"):
        EndNormals(BLOCK, [GROOVE], device)(np.array([[9.0, 10.0, 6.0], [9.0, 10.0, 5.0]]), np.array([0, 0]))
    with pytest.raises(NumericalError, match="tag 7 is of no row of these operations"):
        EndNormals(BLOCK, [GROOVE], device)(np.zeros((1, 3)), np.array([7]))
