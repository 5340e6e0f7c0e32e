"""The scene of Zhou's conventional rows (2015, section 4.4.2, table 4.2) against the same cut put together here."""

from math import sin

import numpy as np
import pytest
from scipy.optimize import fsolve

from gearsim.geometry.rays import RayBundle
from gearsim.metrology.deviation import measure
from gearsim.metrology.grid import COARSE, DENSE
from gearsim.motion.segments import compile_motion
from gearsim.processes.run import run
from gearsim.simulation.removal import cut
from gearsim.surfaces.patch import SIDES
from gearsim.toolpaths.face_milled import GeneratedFlankPath
from tests.surfaces.test_face_milled import ANGLE, EDGE, make_face_milled

SCENE = "spiral-bevel-flank-conventional"
SMALL = (
    "metrology.rows=3", "metrology.columns=9", "metrology.inspection_rows=3", "metrology.inspection_columns=5",
    "metrology.convergence=[]", "simulation.dexel_pitch_mm=0.6", "toolpath.points=17",
)  # fmt: skip


@pytest.fixture(scope="module")
def result():
    return run(SCENE, overrides=SMALL)


def mean_point(tooth):
    """M: the middle between both walls on the pitch cone at the mean cone distance, by MINPACK."""
    blank, found = tooth.blank, []
    for wall in (tooth.flank(side) for side in SIDES):
        start = np.concatenate(wall.meet(np.array([blank.mean]), np.array([-1.0])))

        def misses(at, wall=wall):
            cone, above = blank.cone_height(wall.jet(*at[:, None]).r[0])
            return [cone - blank.mean, above]

        found.append(wall.jet(*fsolve(misses, start, xtol=1e-12)[:, None]).r[0])
    turns = [np.arctan2(r[1], r[0]) for r in found]
    radius, z = blank.axial(np.array([blank.mean]), np.array([0.0]))
    middle = 0.5 * (turns[0] + turns[1])
    return np.array([radius[0] * np.cos(middle), radius[0] * np.sin(middle), z[0]])


def section_points(patch, offsets):
    """L0 to L6 and the normal of their plane, through M and normal to O_gM (figure 4.15), by MINPACK, step by step."""
    blank, mean = patch.blank, mean_point(patch.tooth)
    above = 0.5 * (blank.addendum_at(blank.mean) - blank.dedendum_at(blank.mean) + blank.clearance)
    across, up = blank.cone_directions(mean)

    def misses(at, height):
        r = patch.jet(*at[:, None]).r[0] - mean
        return [r @ across, r @ up - height]

    found = {}
    for sign in (1.0, -1.0):
        at = np.concatenate(patch.meet(np.array([blank.mean]), np.array([above])))
        for offset in sign * np.arange(0.0, 3.25, 0.25):
            at = found[offset] = fsolve(misses, at, (above + offset,), xtol=1e-11)
    return patch.jet(*np.array([found[o] for o in offsets]).T), across


@pytest.mark.parametrize("side", SIDES)
def test_the_mean_profile_is_that_of_the_same_cut_put_together_here(result, side, published_cutter):
    """Section, directions, path, table and rays put together here; what the scene reports must be the same."""
    profile, offsets = (
        result.measurements[side, "theory", "mean profile"],
        np.array([0.0, 0.5, -0.5, 1.5, -1.5, 3.0, -3.0]),
    )
    path = GeneratedFlankPath(make_face_milled().flank(side), published_cutter, EDGE * (1.0 - sin(ANGLE)), 8.0)
    jet, across = section_points(path.patch, offsets)
    in_plane = jet.normal - np.outer(jet.normal @ across, across)
    in_plane /= np.linalg.norm(in_plane, axis=1)[:, None]
    table = compile_motion(path.motion, published_cutter.reach)
    for direction, reported in ((jet.normal, profile.normal_um), (in_plane, profile.in_plane_um)):
        rays = RayBundle(jet.r, direction, np.full(7, -1.0), np.full(7, 1.0))
        ours = 1e3 * measure(rays, cut(rays, table, published_cutter).require_trust().removed).value
        assert list(reported) == [f"L{i}" for i in range(7)]
        assert np.allclose(list(reported.values()), ours, atol=1e-5)
        assert abs(ours[0]) < 1e-5
        assert np.all(ours[1:] > 1.0)


def test_both_roads_and_the_dexels_agree_and_the_published_cutter_gouges(result):
    """What is left by the own pass is the profile's bulge; the other pass cuts it away and a millimetre more."""
    for side in SIDES:
        for variant in ("theory", "own pass"):
            for grid in (DENSE, COARSE):
                gap = result.measurements[side, variant, grid].gap
                assert gap.trusted
                assert gap.valid > 0
                assert gap.max_um < 1e-3
        own, everything = (
            result.measurements[side, name, DENSE].deviation.summary_um() for name in ("theory", "program")
        )
        assert own["min"] > -1e-3
        assert 50.0 < own["max"] < 120.0
        assert everything["min"] < -1000.0
    dexels = result.measurements["", "program", "tri-dexel"]
    assert dexels.checked > 0
    assert dexels.check_um < 1e-3
    assert result.exit_code == 1
    assert {(f.kind, f.patch) for f in result.findings if f.fails} >= {("cross_cut", side) for side in SIDES}


def test_the_non_generated_tooth_is_flank_milled_too(result):
    """Formate: the head leaves straight profiles, so the bulge is gone and with it most of the deviation."""
    plunged = run(SCENE, overrides=(*SMALL, "surface.generated=false"))
    for side in SIDES:
        assert plunged.measurements[side, "theory", DENSE].gap.max_um < 1e-3
        straight, bulged = (r.measurements[side, "theory", "mean profile"].normal_um for r in (plunged, result))
        assert abs(straight["L0"]) < 1e-5
        for name in ("L3", "L4", "L5", "L6"):
            assert abs(straight[name]) < 0.2 * bulged[name]
