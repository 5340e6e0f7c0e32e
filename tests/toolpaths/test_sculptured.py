"""Passes over NURBS surfaces: dropped tools against closed forms and brute force, contact points, straight steps."""

import numpy as np
import pytest

from gearsim.cutters.catalogue import ball, bull, flat, lollipop, tapered
from gearsim.errors import InputError
from gearsim.surfaces.nurbs_file import load_surfaces
from gearsim.toolpaths.drop_cutter import drop, drop_path, underside
from gearsim.toolpaths.sculptured import contact_path
from tests.surfaces.nurbs_shapes import rebuilt, sphere, wavy

TOOLS = [ball(4.0, 20.0), flat(4.0, 20.0), bull(4.0, 0.5, 20.0), tapered(2.0, 0.3, 10.0)]


def names(cutter):
    return cutter.name


def clearance(cutter, tip, points):
    away = points - tip
    return cutter.signed_distance(np.hypot(away[:, 0], away[:, 1]), away[:, 2])


@pytest.mark.parametrize("cutter", TOOLS, ids=names)
def test_the_underside_is_where_the_tool_ends(cutter):
    r = np.linspace(0.0, cutter.max_radius, 57)[:-1]
    z = underside(cutter, r)
    np.testing.assert_allclose(cutter.signed_distance(r, z), 0.0, atol=1e-12)
    assert (cutter.signed_distance(r, z - 1e-3) > 0.0).all()
    assert np.isinf(underside(cutter, cutter.max_radius + 1e-3))


@pytest.mark.parametrize("corner", [0.0, 1.0, 3.0])
def test_mills_dropped_on_a_ball_are_closed_forms(corner):
    """The corner's centre is a circle that touches the offset sphere."""
    big, shank = 10.0, 3.0
    cutter = flat(6.0, 40.0) if corner == 0.0 else ball(6.0, 40.0) if corner == 3.0 else bull(6.0, corner, 40.0)
    away = np.linspace(0.05, 11.0, 45)
    turn = np.linspace(0.0, 6.0, 45)
    found = drop(sphere(big), cutter, away * np.cos(turn), away * np.sin(turn))
    beside = np.maximum(away - (shank - corner), 0.0)
    wanted = np.where(beside > 0.0, np.sqrt((big + corner) ** 2 - beside**2) - corner, big)
    np.testing.assert_allclose(found.tip[:, 2], wanted, atol=1e-9)
    touched = [clearance(cutter, t, p[None])[0] for t, p in zip(found.tip, found.point, strict=True)]
    np.testing.assert_allclose(touched, 0.0, atol=1e-9)


@pytest.mark.parametrize("cutter", TOOLS, ids=names)
def test_dropped_tools_touch_and_never_gouge(cutter):
    surface = wavy(np.random.default_rng(4))
    share = np.linspace(0.0, 1.0, 501)
    u, v = (a.ravel() for a in surface.locate(*np.meshgrid(share, share)))
    points = surface.jet(u, v).r
    x, y = np.random.default_rng(1).uniform([[-1.0], [-1.0]], [[11.0], [9.0]], (2, 24))
    found = drop(surface, cutter, x, y)
    for tip in found.tip:
        least = clearance(cutter, tip, points).min()
        assert -1e-7 < least < 1e-2, tip  # the points are 0.02 mm apart


def test_a_tool_beside_the_surface_does_not_touch():
    found = drop(sphere(5.0), ball(2.0, 10.0), [7.0, 0.0], [0.0, 0.0])
    assert np.isnan(found.tip[0, 2])
    assert found.tip[1, 2] == pytest.approx(5.0, abs=1e-12)


def test_dropped_passes_stay_clear_between_their_locations():
    surface, cutter = wavy(np.random.default_rng(7)), bull(3.0, 0.5, 20.0)
    path = drop_path(surface, cutter, 3.0, 16, tolerance=1e-3)
    assert path.chord <= 1e-3
    share = np.linspace(0.0, 1.0, 301)
    points = surface.jet(*(a.ravel() for a in surface.locate(*np.meshgrid(share, share)))).r
    worst = 0.0
    for motion in path.motions():
        piece = np.repeat(np.arange(motion.pieces), 3)[:90]
        tips = motion.pose(piece, np.tile([0.0, 0.3, 0.5], 30)[: len(piece)], 0).tip.value
        worst = min(worst, min(clearance(cutter, t, points).min() for t in tips))
    assert worst > -1.2e-3


def test_contact_passes_touch_their_points_and_keep_the_stepover():
    surface, cutter = load_surfaces("khan-9-1-free-form")[0], bull(40.0, 15.0, 60.0)
    path = contact_path(surface, cutter, 2.0, 17, along="v", margin=0.05, tolerance=1e-3)
    touches = path.touches
    touched = [clearance(cutter, t, p[None])[0] for t, p in zip(touches.tip, touches.point, strict=True)]
    np.testing.assert_allclose(touched, 0.0, atol=1e-12)
    first = touches.point[path.place == path.place[0]]
    apart = np.linalg.norm(np.diff(first, axis=0), axis=1)
    assert apart.max() <= 2.0
    assert apart.max() > 1.8
    assert len(path.motions()) == len(first) == path.line.max() + 1


def test_steps_that_would_cut_too_deep_are_halved():
    dome, cutter = sphere(10.0), ball(4.0, 30.0)
    coarse = contact_path(dome, cutter, 8.0, 9, along="u", margin=0.26, tolerance=1.0)
    fine = contact_path(dome, cutter, 8.0, 9, along="u", margin=0.26, tolerance=1e-3)
    assert coarse.chord > 0.1 > 1e-3 >= fine.chord > 1e-4
    assert len(fine) > 2 * len(coarse)
    assert (np.diff(fine.place)[fine.line[1:] == fine.line[:-1]] > 0.0).all()


def test_passes_end_where_the_surface_turns_away():
    path = contact_path(sphere(10.0), ball(4.0, 30.0), 5.0, 33, along="v")
    assert all(np.isfinite(path.touches.tip[run]).all() for run in path.runs)
    assert (path.touches.normal[np.concatenate(path.runs), 2] > -1e-9).all()


def test_refused_input():
    surface = wavy(np.random.default_rng(0))
    with pytest.raises(InputError, match="not convex"):
        drop(surface, lollipop(4.0, 2.0, 20.0), [0.0], [0.0])
    with pytest.raises(InputError, match="stepover"):
        contact_path(surface, TOOLS[0], 0.0)
    with pytest.raises(InputError, match="normal up"):
        contact_path(rebuilt(surface, flip=True), TOOLS[0], 2.0, 9).motions()
