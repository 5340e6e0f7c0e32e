"""Heads of any size that rays touch, graze at depths near rounding, or lie in: closed forms."""

from math import radians, tan

import numpy as np
import pytest

from gearsim.cutters.catalogue import face_mill_head
from gearsim.geometry.rays import RayBundle
from gearsim.motion.segments import compile_motion
from gearsim.motion.sources import CLMotion
from gearsim.simulation.removal import cut

SIZES = [1e-3, 1.0, 1e3]
ANGLE = radians(20.0)
UP = np.array([0.0, 0.0, 1.0])
EPS = np.finfo(float).eps


def head(size):
    """Sharp: between the cones r = 5.5 size + z tan 20 deg and r = 4.5 size - z tan 20 deg, 2 sizes high."""
    return face_mill_head(5.0 * size, size, ANGLE, ANGLE, 0.0, 2.0 * size)


def removed(size, origin, direction, start=(0.0, 0.0, 0.0), end=(0.0, 0.0, 0.0)):
    """What a head of a size takes on a straight way, all in units of the size; lengths [mm]."""
    cutter = head(size)
    table = compile_motion(CLMotion(size * np.array([start, end], dtype=float), np.array([UP, UP])), cutter.reach)
    origin = size * np.atleast_2d(np.asarray(origin, dtype=float))
    n = len(origin)
    rays = RayBundle(origin, np.tile(np.asarray(direction, float), (n, 1)), np.zeros(n), np.full(n, 32.0 * size))
    return cut(rays, table, cutter).require_trust().removed


@pytest.mark.parametrize("size", SIZES)
def test_a_chord_is_found_down_to_what_coordinates_are_rounded_to(size):
    """Across the outer cone at half a size's height, 1e-6 to 1e-13 of the radius deep: 2 sqrt(2 r d - d²)."""
    radius = 5.5 + 0.5 * tan(ANGLE)
    y = radius * (1.0 - 10.0 ** np.arange(-13.0, -5.0))
    found = removed(size, np.column_stack([np.full(8, -16.0), y, np.full(8, 0.5)]), [1.0, 0.0, 0.0])
    assert np.array_equal(found.ray, np.arange(8))
    noise = 64.0 * EPS * 40.0
    depth = radius - y
    short, long = (np.sqrt(d * (2.0 * radius - d)) for d in (np.maximum(depth - noise, 0.0), depth + noise))
    for half in (16.0 * size - found.lo, found.hi - 16.0 * size):
        assert np.all(half >= short * size - 1e-9)
        assert np.all(half <= long * size + 1e-9)
        assert np.all(half[-4:] > 0.99 * long[-4:] * size)


@pytest.mark.parametrize("size", SIZES)
def test_a_ray_grazed_all_along_a_move_is_cut_all_along(size):
    """Along the velocity at the outer cone's radius, and less by 1e-12 to 1e-3 of it: the chord, and the way."""
    radius = 5.5 + 0.5 * tan(ANGLE)
    y = radius * (1.0 - np.array([0.0, 1e-12, 1e-9, 1e-6, 1e-3]))
    origin = np.column_stack([np.full(5, -14.0), y, np.full(5, 0.5)])
    found = removed(size, origin, [1.0, 0.0, 0.0], (0.0, 0.0, 0.0), (4.0, 0.0, 0.0))
    assert np.array_equal(found.ray[found.ray > 0], np.arange(1, 5))
    half = np.sqrt(radius**2 - y[1:] ** 2)
    noise = size * np.sqrt(2.0 * radius * 64.0 * EPS * 40.0)
    close = 1e-9 + noise**2 / (2.0 * half * size)
    assert np.all(np.abs(found.lo[found.ray > 0] - size * (14.0 - half)) < close)
    assert np.all(np.abs(found.hi[found.ray > 0] - size * (18.0 + half)) < close)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("z", [0.0, 1e-9, 0.25, 2.0 - 1e-9, 2.0])
def test_the_blades_sweep_two_stretches_of_a_ray_through_the_axis(size, z):
    """From the tip plane to the back: in these planes a ray may be cut or not, above and below them it is."""
    way = (0.0, 0.0, 0.0), (4.0, 0.0, 0.0)
    found = removed(size, [-16.0, 0.0, z], [1.0, 0.0, 0.0], *way)
    if z not in (0.0, 2.0):
        inner, outer = 4.5 - z * tan(ANGLE), 5.5 + z * tan(ANGLE)
        assert np.allclose(found.lo, size * (16.0 + np.array([-outer, inner])), rtol=1e-13, atol=1e-9)
        assert np.allclose(found.hi, size * (16.0 + np.array([4.0 - inner, 4.0 + outer])), rtol=1e-13, atol=1e-9)


@pytest.mark.parametrize("size", SIZES)
def test_rays_in_the_plane_the_tip_moves_in_are_decided(size):
    """Beside the tip land as well as over it no pose is deeper than rounding: nothing is cut, and nothing flagged."""
    rng = np.random.default_rng(4)
    angle = rng.uniform(0.0, 2.0 * np.pi, 20)
    direction = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(20)])
    through = np.column_stack([rng.uniform(-5.0, 9.0, 20), rng.uniform(-5.0, 5.0, 20), np.zeros(20)])
    for d, point in zip(direction, through, strict=True):
        assert not len(removed(size, point - 16.0 * d, d, (0.0, 0.0, 0.0), (4.0, 0.0, 0.0)).lo)
