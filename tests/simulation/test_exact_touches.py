"""Rays that touch the tool in its end poses, lie in its faces, pass its tip: where rounding used to decide."""

from math import radians

import numpy as np
import pytest

from gearsim.cutters.catalogue import ball, bull, conical, flat, grinding_cone, t_slot
from gearsim.geometry.rays import RayBundle
from gearsim.motion.segments import compile_motion
from gearsim.motion.sources import CLMotion
from gearsim.simulation.removal import cut

UP = np.array([0.0, 0.0, 1.0])
TOOLS = {
    "flat": flat(4.0, 20.0),
    "ball": ball(4.0, 20.0),
    "bull": bull(6.0, 1.0, 20.0),
    "t_slot": t_slot(8.0, 2.0, 4.0, 20.0),
}


def straight(start, end, axes=(UP, UP)):
    axes = np.array(axes, dtype=float)
    return CLMotion(np.array([start, end], dtype=float), axes / np.linalg.norm(axes, axis=1, keepdims=True))


def removed(origin, direction, source, tool, length=60.0, device="cpu"):
    origin = np.atleast_2d(np.asarray(origin, dtype=float))
    n = len(origin)
    rays = RayBundle(origin, np.tile(np.asarray(direction, dtype=float), (n, 1)), np.zeros(n), np.full(n, length))
    return cut(rays, compile_motion(source, tool.reach), tool, device=device).require_trust().removed


@pytest.mark.parametrize("x", [-17.0, -17.0 + 1e-9, -17.0 - 1e-9, -18.0])
def test_a_ray_at_the_moves_end_minus_the_radius_loses_the_whole_diameter(x, device):
    found = removed([x, -30.0, 10.0], [0.0, 1.0, 0.0], straight([-20, 0, 0], [-15, 0, 0]), TOOLS["flat"], 60.0, device)
    assert np.allclose(found.lo, [28.0], atol=1e-9)
    assert np.allclose(found.hi, [32.0], atol=1e-9)


def radius_at(tool, z):
    """Largest radius of the tool at a height; steps give the larger one."""
    best = np.zeros_like(z)
    for e in tool.elements:
        s = np.linspace(0.0, e.length, 4001)
        p = e.at(s)
        for i, height in enumerate(z):
            inside = (p.z.min() <= height) & (height <= p.z.max())
            if inside and not e.is_flat:
                t = s[np.argmin(np.abs(p.z - height))]
                lo, hi = max(t - e.length / 4000, 0.0), min(t + e.length / 4000, e.length)
                for _ in range(60):
                    middle = 0.5 * (lo + hi)
                    rises = float(e.at(np.array(e.length)).z) > float(e.at(np.array(0.0)).z)
                    above = (float(e.at(np.array(middle)).z) > height) == rises
                    lo, hi = (lo, middle) if above else (middle, hi)
                best[i] = max(best[i], float(e.at(np.array(0.5 * (lo + hi))).r))
    return best


@pytest.mark.parametrize("name", TOOLS)
@pytest.mark.parametrize("turn", range(4))
def test_dexels_at_round_numbers_lose_no_material(name, turn, device):
    """Half-millimetre dexels across a whole-millimetre move, in four directions, against the slot's closed form."""
    tool = TOOLS[name]
    c, s = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][turn]
    rotate = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    heights = np.array([0.5, 1.5, 3.0, 10.0])
    x = np.arange(-26.0, -8.0, 0.5)
    grid = np.array([[a, -30.0, z] for z in heights for a in x])
    source = straight(rotate @ [-20.0, 0.0, 0.0], rotate @ [-15.0, 0.0, 0.0])
    found = removed(grid @ rotate.T, rotate @ [0.0, 1.0, 0.0], source, tool, 60.0, device)
    radius = np.repeat(radius_at(tool, heights), len(x))
    beside = np.maximum(np.maximum(-20.0 - grid[:, 0], grid[:, 0] + 15.0), 0.0)
    inside = beside < radius
    count = np.diff(found.first)
    assert np.array_equal(count[beside != radius] > 0, inside[beside != radius])
    half = np.sqrt(np.maximum(radius**2 - beside**2, 0.0))
    assert np.allclose(found.lo[found.ray.searchsorted(np.flatnonzero(inside))], (30.0 - half)[inside], atol=1e-9)
    assert np.allclose(found.hi[found.ray.searchsorted(np.flatnonzero(inside))], (30.0 + half)[inside], atol=1e-9)


def test_a_diagonal_move_touched_from_behind(device):
    """Moves by 3-4-5 triangles, so that touches of the end pose are exact off the axes, too."""
    tool, start, end = flat(10.0, 20.0), np.array([0.0, 0.0, 0.0]), np.array([6.0, 8.0, 0.0])
    way = np.array([0.6, 0.8, 0.0])
    across = np.array([-0.8, 0.6, 0.0])
    origins = [start + (10.0 - 5.0) * way - 30.0 * across + 5.0 * UP, start + 5.0 * way - 30.0 * across + 20.0 * UP / 2]
    found = removed(np.array(origins), across, straight(start, end), tool, 60.0, device)
    assert np.allclose(found.lo, 25.0, atol=1e-9)
    assert np.allclose(found.hi, 35.0, atol=1e-9)


def test_two_entries_in_one_row_by_cone_and_by_rim(device):
    """A conical tool that tilts by 0.46 deg: near its top rim the ray enters earliest at either of two poses."""
    tool = conical(1.0, 1.5, 0.2, 25.0)
    source = straight([-20.0, 0.0, 0.0], [-15.0, 0.0, 0.0], (UP, [0.008, 0.0, 1.0]))
    table = compile_motion(source, tool.reach)
    rng = np.random.default_rng(1)
    n = 1500
    origin = np.column_stack([rng.uniform(-24, -10, n), rng.uniform(-6, 6, n), rng.uniform(18, 26, n)])
    direction = rng.normal(size=(n, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    found = cut(RayBundle(origin, direction, np.full(n, -50.0), np.full(n, 50.0)), table, tool, device=device)
    found = found.require_trust().removed
    x = np.linspace(-1.0, 1.0, 201)
    powers = np.vander(x, 6, increasing=True)
    tip, axis = powers @ table.tip[0], powers @ table.axis[0]
    for side, ends in ((-1.0, found.lo), (1.0, found.hi)):
        beyond = origin[found.ray] + (ends + side * 1e-6)[:, None] * direction[found.ray]
        q = beyond[:, None] - tip
        z = np.einsum("ijk,jk->ij", q, axis)
        f = tool.signed_distance(np.linalg.norm(q - z[..., None] * axis, axis=-1), z)
        assert f.min() > -1e-9


def test_a_needle_turning_about_its_tip_cuts_what_it_swings_through(device):
    """The ray crosses the wedge that a needle sweeps; at half a turn of 0.05 deg the gap has two minima."""
    tool = flat(0.02, 100.0)
    source = straight([0, 0, 0], [0, 0, 0], (UP, [np.tan(radians(0.05)), 0.0, 1.0]))
    height = np.array([1.0, 10.0, 50.0, 99.0])
    origin = np.column_stack([np.full(4, -1.0), np.zeros(4), height])
    found = removed(origin, [1.0, 0.0, 0.0], source, tool, 60.0, device)
    angle = radians(0.05)
    last = (height + 0.01 * np.sin(angle)) / np.cos(angle) * np.sin(angle) + 0.01 * np.cos(angle)
    assert np.allclose(found.lo, 1.0 - 0.01, atol=1e-9)
    assert np.allclose(found.hi, 1.0 + last, atol=1e-8)


def test_a_ray_along_a_long_needle_enters_it_where_it_comes_in_from_the_side(device):
    """Its ends lie on the discs of the poses that bring the ray into the needle's side and that end the move."""
    tool = flat(10.0, 17250.0)
    source = straight([0.0, 0.0, 0.0], [8.0, 0.0, -6.0])
    found = removed([6.5, 0.0, -100.0], UP, source, tool, 20000.0, device)
    assert np.allclose(found.lo, [100.0 - 6.0], rtol=0.0, atol=1e-9)
    assert np.allclose(found.hi, [100.0 + 17250.0 - 0.75 * 1.5], rtol=0.0, atol=1e-9)


def test_rays_through_an_apex_along_the_axis_and_in_the_bottom_plane(device):
    """A pointed cone standing on the grid: touched at its tip, cut from there on, missed in its bottom plane."""
    tool = grinding_cone(40.0, radians(45.0), 20.0)
    source = straight([0, 0, 0], [0, 0, 1e-9])
    assert np.diff(removed([-30.0, 0.0, 0.0], [1.0, 0.0, 0.0], source, tool, 60.0, device).first)[0] == 0
    along = removed([0.0, 0.0, -5.0], [0.0, 0.0, 1.0], source, tool, 60.0, device)
    assert np.allclose([along.lo[0], along.hi[0]], [5.0, 25.0], atol=2e-9)
    beside = removed([-30.0, 0.0, 1e-3], [1.0, 0.0, 0.0], source, tool, 60.0, device)
    assert np.allclose([beside.lo[0], beside.hi[0]], [30.0 - 1e-3, 30.0 + 1e-3], atol=2e-9)


@pytest.mark.parametrize("half_deg", [5.0, 45.0])
def test_a_cone_turning_about_its_apex_leaves_rays_through_it_alone(half_deg, device):
    """They touch it all through the row, in a point where any plane between the two keeps them apart."""
    tool = grinding_cone(40.0, radians(half_deg), 20.0 / np.tan(radians(half_deg)))
    source = straight([0.0, 0.0, 0.0], [0.0, 0.0, 0.0], (UP, [np.tan(radians(0.4)), 0.0, 1.0]))
    for direction in ([1.0, 0.0, 0.0], [0.6, 0.8, 0.0], [0.8, 0.0, -0.6], [0.48, 0.64, 0.6]):
        origin = -32.0 * np.array(direction)
        assert np.diff(removed(origin, direction, source, tool, 64.0, device).first)[0] == 0
        beside = removed(origin + 1e-3 * UP, direction, source, tool, 64.0, device)
        assert np.diff(beside.first)[0] == 1


def test_rays_along_the_axis_through_a_round_tip(device):
    """Just before the tip of the first pose rounding decides whether a point faces the ball or its pole."""
    tool, rng = ball(8.0, 60.0), np.random.default_rng(3)
    for _ in range(8):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        across = np.cross(axis, rng.normal(size=3))
        end = 70.0 * across / np.linalg.norm(across) + 3.0 * axis
        found = removed(-512.0 * axis, axis, straight([0.0, 0.0, 0.0], end, (axis, axis)), tool, 1024.0, device)
        assert np.allclose(found.lo, [512.0], rtol=0.0, atol=1e-9)
        assert np.allclose(found.hi, [572.0 + 3.0 * 4.0 / 70.0], rtol=0.0, atol=1e-9)


def test_the_parts_of_an_undercut_tool_stay_inside_it():
    """The neck is led into the disc below it, not through: no ray just under the disc meets anything."""
    for size in (1e-3, 1.0, 1e3):
        tool = t_slot(8.0 * size, 2.0 * size, 4.0 * size, 20.0 * size)
        for part in tool.parts:
            for e in part.elements:
                p = e.at(np.linspace(0.0, e.length, 50))
                assert tool.signed_distance(p.r, p.z).max() < 1e-15 * tool.reach
