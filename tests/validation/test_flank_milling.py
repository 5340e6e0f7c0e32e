"""Flank milling of Zhou's ruled spiral bevel gear (2015, chapter 4): truths about the simulated tooth."""

from math import radians

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from gearsim.envelope import machined_along
from gearsim.geometry.rays import RayBundle
from gearsim.geometry.rigid import Rigid
from gearsim.metrology.convergence import Convergence, Series
from gearsim.metrology.deviation import measure
from gearsim.metrology.dexel_check import DexelInspection, slot_box
from gearsim.metrology.grid import GridInspection
from gearsim.metrology.inspection import perform
from gearsim.metrology.job import Job
from gearsim.metrology.roads import compare_roads
from gearsim.metrology.samples import sample_grid
from gearsim.motion.segments import compile_motion
from gearsim.motion.sources import CLMotion, MovedMotion
from gearsim.simulation.operation import Variant, operation
from gearsim.simulation.removal import cut
from gearsim.simulation.workshop import Workshop
from gearsim.surfaces.part import Intended, Part
from gearsim.surfaces.patch import SIDES
from gearsim.toolpaths.flank import FlankPath
from tests.conftest import make_tooth, random_rotation
from tests.helpers import conical_distance, slerp
from tests.surfaces.test_ruled_bevel import build_point

FIT = (1.04, 0.8, radians(15.0), 25.0)
PUBLISHED = (1.0, 1.5, radians(15.0), 25.0)


def own_deviation(tooth, side, cutter, device="cpu", points=None, shape=(7, 21), tolerance=1e-9):
    path = FlankPath(tooth, side, cutter, 8.0)
    source = path.motion if points is None else path.cl_motion(points)
    grid = sample_grid(tooth.flank(side), *shape, margin=0.01)
    removed = cut(
        grid.rays(),
        compile_motion(source, cutter.reach, min(tolerance, 1e-9)),
        cutter,
        device=device,
        tolerance=tolerance,
    )
    return grid, source, measure(grid.rays(), removed.require_trust().removed).reshaped(shape)


def job(tooth, cutter, motions):
    """A tooth under named motions of one cutter."""
    variants = tuple(Variant(name, "", (operation(name, cutter, m, 1e-9),)) for name, m in motions.items())
    part = Part("gear frame", tooth.blank.stock, {p.name: Intended(p) for p in tooth.patches})
    return Job("made here", part, variants, next(iter(motions)), ())


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("points", [None, 33])
def test_the_two_roads_agree_to_a_nanometre_everywhere(tooth, fitting_cutter, device, side, points):
    grid, source, deviation = own_deviation(tooth, side, fitting_cutter, device, points, (9, 65))
    gap = compare_roads(grid, fitting_cutter, [source], deviation)
    assert gap.trusted
    assert gap.max_um < 1e-5
    assert (gap.excluded, gap.disagree, gap.valid) == (0, 0, 9 * 65)


def test_joint_poses_cut_a_share_of_one_flank_whatever_the_number_of_points(tooth, fitting_cutter):
    for points in (9, 33):
        shares = {}
        for side in SIDES:
            grid, source, deviation = own_deviation(tooth, side, fitting_cutter, "cpu", points, (9, 129))
            shares[side] = compare_roads(grid, fitting_cutter, [source], deviation).road.share()["joint"]
        assert shares["convex"] == 0.0
        assert 0.03 < shares["concave"] < 0.07


def brute_force(cl, cutter, origin, direction):
    """Deviation along one ray by a minimum over finely sampled poses of a hand-written tool distance.

    Shares no code with either road: slerp by rotation, the tool from its construction, root by Brent.
    """
    tips, axes = cl.tips, cl.axes
    t = np.linspace(0.0, 1.0, 21)
    pieces = range(len(tips) - 1)
    tip = np.concatenate([tips[i] + t[:, None] * (tips[i + 1] - tips[i]) for i in pieces])
    axis = np.concatenate([slerp(axes[i], axes[i + 1], t) for i in pieces])

    def tool(point, tip, axis):
        z = np.sum((point - tip) * axis, axis=-1)
        r = np.linalg.norm(point - tip - z[..., None] * axis, axis=-1)
        return conical_distance(r, z, *cutter)

    def least(s):
        point = origin + s * direction
        f = tool(point, tip, axis)
        k = int(np.argmin(f))
        i, low = k // 21, f[k]
        for piece in {max(i - 1, 0), i, min(i + 1, len(tips) - 2)}:

            def at(x, piece=piece):
                a = slerp(axes[piece], axes[piece + 1], np.array([x]))
                return tool(point, (tips[piece] + x * (tips[piece + 1] - tips[piece]))[None], a)[0]

            low = min(low, minimize_scalar(at, bounds=(0.0, 1.0), method="bounded", options={"xatol": 1e-9}).fun)
        return low

    return brentq(least, -0.05, 0.05, xtol=1e-9)


@pytest.mark.parametrize("side", SIDES)
def test_deviations_agree_with_brute_force_to_a_hundredth_of_a_micrometre(tooth, fitting_cutter, side):
    grid, source, deviation = own_deviation(tooth, side, fitting_cutter, "cpu", 17, (4, 6))
    for i in range(4):
        for j in range(6):
            brute = brute_force(source, FIT, grid.point[i, j], grid.normal[i, j])
            assert 1e3 * deviation.value[i, j] == pytest.approx(1e3 * brute, abs=0.01)


def test_the_contact_path_deviates_by_nothing_and_the_rest_is_overcut(tooth, fitting_cutter):
    """L0 is on the envelope by construction; a tangent tool in a twisted surface only removes more."""
    for side in SIDES:
        path = FlankPath(tooth, side, fitting_cutter, 8.0)
        phi = np.linspace(-0.25, 0.22, 15)
        h = path.contact_height(tooth.spine(phi, 0).cone.value)
        jet = tooth.flank(side).jet(phi, h)
        rays = RayBundle(jet.r, jet.normal, np.full(15, -1.0), np.full(15, 1.0))
        removed = cut(rays, compile_motion(path.motion, fitting_cutter.reach), fitting_cutter).removed
        assert np.abs(measure(rays, removed).value).max() < 2e-9
        _, _, deviation = own_deviation(tooth, side, fitting_cutter)
        assert deviation.value.max() < 2e-9
        assert deviation.value.min() < -5e-6


@pytest.mark.parametrize("side", SIDES)
def test_cl_data_converge_to_the_continuous_path_with_second_order(tooth, fitting_cutter, side):
    path = FlankPath(tooth, side, fitting_cutter, 8.0)
    points = (9, 17, 33, 65)
    motions = {"theory": [path.motion], **{str(n): [path.cl_motion(n)] for n in points}}
    series = Series("theory", "theory", points, tuple(map(str, points)))
    inspection = GridInspection(side, ("theory",), (), 5, 41, series=(series,))
    reading = perform(inspection.steps(job(tooth, fitting_cutter, motions)), Workshop("cpu"))
    (found,) = (m.convergence for m in reading.measurements if m.inspection == "convergence")
    assert isinstance(found, Convergence)
    assert np.allclose(found.orders, 2.0, atol=0.1)


@pytest.mark.parametrize("side", SIDES)
def test_a_rigid_motion_of_the_scene_changes_no_deviation(tooth, published_cutter, device, side, rng):
    """To 1e-6 um at a kernel tolerance of 1e-10 mm, by both roads."""
    grid, source, deviation = own_deviation(tooth, side, published_cutter, device, tolerance=1e-10)
    rigid = Rigid(random_rotation(rng), rng.uniform(-100, 100, 3))
    rays = grid.rays().moved(rigid)
    for table in (
        compile_motion(source, published_cutter.reach, 1e-10).moved(rigid),
        compile_motion(MovedMotion(source, rigid), published_cutter.reach, 1e-10),
    ):
        removed = cut(rays, table, published_cutter, device=device, tolerance=1e-10).require_trust().removed
        assert 1e3 * np.abs(measure(rays, removed).value - deviation.value.ravel()).max() < 1e-6
    still = machined_along(grid.rays(), [source], published_cutter).deviation
    moved = machined_along(rays, [MovedMotion(source, rigid)], published_cutter).deviation
    assert 1e3 * np.abs(moved - still).max() < 1e-6


def test_mirroring_swaps_hands_and_nothing_else(published_cutter):
    """A right-hand gear has the left-hand one's deviations, own pass and cross-cut alike."""
    left, right = make_tooth("left"), make_tooth("right")
    for side, other in (("convex", "concave"), ("concave", "convex")):
        for milled in (side, other):
            values = []
            for tooth in (left, right):
                grid = sample_grid(tooth.flank(side), 5, 17)
                table = compile_motion(FlankPath(tooth, milled, published_cutter, 8.0).motion, published_cutter.reach)
                values.append(measure(grid.rays(), cut(grid.rays(), table, published_cutter).removed))
            assert np.array_equal(values[0].crossing, values[1].crossing)
            assert np.allclose(values[0].value, values[1].value, atol=2e-9, equal_nan=True)
    a, b = build_point(0.1, 1.0, 2.0, 1.0), build_point(-0.1, -1.0, 2.0, -1.0)
    assert np.allclose(a * [1, -1, 1], b)


def test_moving_the_tool_off_by_five_micrometres_leaves_five(tooth, fitting_cutter):
    """The whole pass shifted 5 um along the normal at the mean contact: +5 um there, to the nanometre."""
    side = "convex"
    path = FlankPath(tooth, side, fitting_cutter, 8.0)
    jet = tooth.flank(side).jet(np.zeros(1), path.contact_height(np.array([tooth.blank.mean])))
    shifted = MovedMotion(path.motion, Rigid(np.eye(3), 5e-3 * jet.normal[0]))
    rays = RayBundle(jet.r, jet.normal, np.array([-1.0]), np.array([1.0]))
    removed = cut(rays, compile_motion(shifted, fitting_cutter.reach), fitting_cutter).removed
    assert 1e3 * measure(rays, removed).value[0] == pytest.approx(5.0, abs=1e-3)


def test_the_published_cutter_cuts_the_opposite_flank_by_more_than_a_millimetre(tooth, published_cutter):
    """Zhou's tables 3.7 and 4.1 together (errata): the cutter is wider than the slot at the fillet's end."""
    table = compile_motion(FlankPath(tooth, "concave", published_cutter, 8.0).motion, published_cutter.reach)
    grid = sample_grid(tooth.flank("convex"), 17, 65)
    deviation = measure(grid.rays(), cut(grid.rays(), table, published_cutter).removed)
    assert 1e3 * np.nanmin(deviation.value) == pytest.approx(-1170.0, abs=15.0)
    tips = FlankPath(tooth, "concave", published_cutter, 8.0).cl_motion(129)
    i = int(np.nanargmin(deviation.value))
    point, normal = grid.point.reshape(-1, 3)[i], grid.normal.reshape(-1, 3)[i]
    s = np.linspace(-1.5, 0.2, 3401)
    q = point + s[:, None] * normal
    z = np.einsum("ijk,jk->ij", q[:, None] - tips.tips, tips.axes)
    r = np.linalg.norm(q[:, None] - tips.tips - z[..., None] * tips.axes, axis=2)
    inside = (conical_distance(r, z, *PUBLISHED) < 0.0).any(axis=1)
    assert s[inside].min() == pytest.approx(deviation.value[i], abs=2e-3)


def test_the_fitting_cutter_touches_neither_the_opposite_flank_nor_the_root(tooth, fitting_cutter):
    for side, other in (("convex", "concave"), ("concave", "convex")):
        table = compile_motion(FlankPath(tooth, side, fitting_cutter, 8.0).motion, fitting_cutter.reach)
        for patch in tooth.patches:
            grid = sample_grid(patch, 9, 33)
            deviation = measure(grid.rays(), cut(grid.rays(), table, fitting_cutter).removed)
            least = np.nan_to_num(deviation.value, nan=1.0).min()
            assert 1e3 * least > (10.0 if patch.name == other else -5.0)


def test_published_profile_figures_do_not_follow_from_the_published_data(tooth, published_cutter):
    """Zhou's table 4.2, proposed model: sign and growth agree, the size does not (errata)."""
    printed = {"convex": [1.2, 2.7, 1.5, 5.5, 5.8, 5.3, 9.6], "concave": [1.0, 1.8, 2.1, 7.4, 7.6, 6.8, 10.8]}
    for side in SIDES:
        path = FlankPath(tooth, side, published_cutter, 8.0)
        h = path.contact_height(np.array([tooth.blank.mean])) + np.array([0.0, 0.5, -0.5, 1.5, -1.5, 3.0, -3.0])
        jet = tooth.flank(side).jet(np.zeros(7), h)
        rays = RayBundle(jet.r, jet.normal, np.full(7, -1.0), np.full(7, 1.0))
        ours = (
            1e3
            * measure(
                rays, cut(rays, compile_motion(path.motion, published_cutter.reach), published_cutter).removed
            ).value
        )
        assert abs(ours[0]) < 1e-5
        assert np.all(ours[1:] < 0.0)
        assert np.all(np.abs(ours[[3, 4, 5, 6]]) > np.abs(ours[[1, 2, 3, 4]]))
        assert np.all(np.abs(ours) < 0.1 * np.array(printed[side]))


def test_tri_dexel_ends_lie_where_the_normals_say(tooth, fitting_cutter, device):
    motions = {"both": [FlankPath(tooth, side, fitting_cutter, 8.0).motion for side in SIDES]}
    grids = tuple(GridInspection(side, ("both",), (), 9, 33) for side in SIDES)
    inspection = DexelInspection("both", slot_box(tooth.patches, tooth.blank, 0.6), grids)
    reading = perform(inspection.steps(job(tooth, fitting_cutter, motions)), Workshop(device))
    (result,) = reading.measurements
    assert reading.doubts == ()
    assert result.checked > 300
    assert result.check_um < 1e-3
    volumes = np.array(result.removed_volumes)
    assert np.ptp(volumes) < 0.01 * volumes.mean()


def test_cl_motion_through_a_file_is_the_same_motion(tooth, fitting_cutter):
    from gearsim.programs.cldata import CLPath, assemble, format_cl, parse_cl

    planned = FlankPath(tooth, "convex", fitting_cutter, 8.0).cl_motion(33)
    text = format_cl(assemble([CLPath("convex", planned.tips, planned.axes)], 15.0, fitting_cutter), "x", 600.0, 9)
    path = parse_cl(text).path("convex")
    read = CLMotion(path.tips, path.axes)
    grid = sample_grid(tooth.flank("convex"), 5, 17)
    both = [
        measure(grid.rays(), cut(grid.rays(), compile_motion(m, fitting_cutter.reach), fitting_cutter).removed).value
        for m in (planned, read)
    ]
    assert 1e3 * np.abs(both[0] - both[1]).max() < 3e-5
