from dataclasses import replace
from math import cos, degrees, pi, radians, sin, tan

import numpy as np
import pytest

from gearsim.cutters.profile import Element, Profile
from gearsim.errors import InputError
from gearsim.machines.generator import CradleGenerator
from gearsim.metrology.samples import sample_grid
from gearsim.surfaces.face_milled import FaceMilledTooth
from gearsim.surfaces.patch import SIDES
from tests.conftest import make_tooth

MEAN_RADIUS, POINT_WIDTH, ANGLE, EDGE = 63.5, 2.54, radians(22.0), 1.524


def make_head(height=12.0, edge=EDGE):
    """Zhou's head (table 3.4) element by element; point width and mean radius where flanks meet the tip plane."""
    s, c = sin(ANGLE), cos(ANGLE)
    inner, outer = MEAN_RADIUS - 0.5 * POINT_WIDTH, MEAN_RADIUS + 0.5 * POINT_WIDTH
    back = edge * (1.0 / c - tan(ANGLE))
    a, b = (inner + back, edge), (outer - back, edge)
    low, high = edge * (1.0 - s), height * tan(ANGLE)
    return Profile(
        "face-mill head",
        (
            Element((a[0], 0.0), (b[0], 0.0)),
            Element((b[0], 0.0), (b[0] + edge * c, low), b, edge),
            Element((b[0] + edge * c, low), (outer + high, height)),
            Element((outer + high, height), (inner - high, height)),
            Element((inner - high, height), (a[0] - edge * c, low)),
            Element((a[0] - edge * c, low), (a[0], 0.0), a, edge),
        ),
    )


SETTINGS = CradleGenerator(64.3718, radians(-56.78), radians(69.59), 1.0323, sliding_base=-0.2071)
ROLL = (0.012, -0.02, 0.02, 0.01)


def make_face_milled(generator=SETTINGS, generated=True, **changes):
    """Zhou's gear (tables 3.3 and 3.4), sliding base and blank offset exchanged (errata)."""
    return FaceMilledTooth(make_tooth().blank, make_head(), generator, generated, **changes)


@pytest.fixture(scope="module", params=["generated", "modified roll", "formate"])
def face_milled(request):
    generator = replace(SETTINGS, modified_roll=ROLL) if request.param == "modified roll" else SETTINGS
    return make_face_milled(generator, request.param != "formate")


def spread(rows=3, columns=5):
    return tuple(g.ravel() for g in np.meshgrid(np.linspace(0.0, 1.0, columns), np.linspace(0.0, 1.0, rows)))


def test_locate_meets_the_blank(face_milled):
    blank = face_milled.blank
    length, height = spread()
    for patch in face_milled.patches:
        u, v = patch.locate(length, height)
        jet = patch.jet(u, v)
        cone, above = blank.cone_height(jet.r)
        assert jet.exists.all()
        assert not jet.undercut.any()
        assert np.allclose(cone, blank.toe + length * blank.face_width, atol=1e-10)
        assert np.allclose(v[height == 0.0], patch.ends[0])
        if patch.part == "flank":
            assert np.allclose(above[height == 1.0], blank.addendum_at(cone[height == 1.0]), atol=1e-10)
        else:
            assert np.allclose(v[height == 1.0], patch.ends[1])


def test_patches_join_with_common_tangent_planes(face_milled):
    """At one angle about the head consecutive profile elements share point and normal: the slot is smooth all over."""
    for side in SIDES:
        flank, fillet, bottom = face_milled.flank(side), face_milled.fillet(side), face_milled.bottom
        wall = bottom.ends[0 if side == "concave" else 1]
        for a, va, b, vb in ((flank, flank.ends[0], fillet, fillet.ends[1]), (fillet, fillet.ends[0], bottom, wall)):
            u = b.locate(np.linspace(0.0, 1.0, 3), np.full(3, 0.5))[0]
            first, second = a.jet(u, va), b.jet(u, vb)
            assert np.allclose(first.r, second.r, atol=1e-10), (a.name, b.name)
            assert np.allclose(first.normal, second.normal, atol=1e-12)


def test_normals_point_out_of_the_material_into_the_slot(face_milled):
    for patch in face_milled.patches:
        u, v = patch.locate(np.full(3, 0.5), np.array([0.1, 0.5, 0.9]))
        normal, r = patch.jet(u, v).normal, patch.jet(u, v).r
        up = normal @ np.array([cos(face_milled.blank.pitch), 0.0, -sin(face_milled.blank.pitch)])
        assert np.all(up > 0.2)
        if patch.part != "bottom":
            across = np.sum(normal * np.cross([0.0, 0.0, 1.0], r), axis=1)
            assert np.all(across * (1.0 if patch.side == "concave" else -1.0) < 0.0)


def test_convex_flank_is_convex_and_concave_concave_along_the_face(face_milled):
    """The outside blade leaves the concave flank, whose trace on the pitch cone bends with the head's radius."""
    for side, sign in (("convex", -1.0), ("concave", 1.0)):
        patch = face_milled.flank(side)
        jet = patch.jet(*patch.meet(np.array([face_milled.blank.mean]), np.zeros(1)))
        up = np.array([*jet.r[0, :2] / np.hypot(*jet.r[0, :2]) * cos(patch.blank.pitch), -sin(patch.blank.pitch)])
        trace = np.cross(jet.normal, up)
        assert sign * jet.curvature().normal_curvature(trace)[0] == pytest.approx(1.0 / 63.5, rel=0.3)


def trace_angle(patch, cone):
    """Spiral angle [deg] on the pitch cone, from positions: difference of points 1e-4 mm of cone apart."""
    at = [patch.jet(*patch.meet(np.array([c]), np.zeros(1))).r[0] for c in (cone - 5e-5, cone + 5e-5)]
    middle, step = 0.5 * (at[0] + at[1]), at[1] - at[0]
    around = np.cross([0.0, 0.0, 1.0], middle) / np.hypot(middle[0], middle[1])
    return degrees(np.arctan2(step @ around, 1e-4))


def test_hand_and_mean_spiral_angle_are_those_of_table_3_3():
    """Left hand like the ruled tooth; 31.92 deg on the convex and 31.63 deg on the concave flank for printed 32."""
    tooth, mirrored = make_face_milled(), make_face_milled(SETTINGS.other_hand())
    for t, hand, sign in ((tooth, "left", -1.0), (mirrored, "right", 1.0)):
        angles = [trace_angle(t.flank(side), t.blank.mean) for side in SIDES]
        assert t.hand == hand
        assert sign * np.array(angles) == pytest.approx([31.92, 31.63], abs=0.01)
    assert make_tooth().hand == "left"


def test_the_other_hand_is_the_mirror_image(face_milled):
    image = replace(face_milled, generator=face_milled.generator.other_hand())
    for a, b in zip(face_milled.patches, image.patches, strict=True):
        one, other = (p.jet(*p.locate(*spread())) for p in (a, b))
        assert np.allclose(one.r * [1, -1, 1], other.r, atol=1e-9)
        assert np.allclose(one.curvature().k1, other.curvature().k1, atol=1e-9)


def test_the_tip_plane_envelops_the_root_cone():
    """Bottom land: a cone of the machine root angle, its apex 6 um beyond that of the blank's root cone (errata)."""
    tooth = make_face_milled()
    jet = tooth.bottom.jet(*tooth.bottom.locate(*spread()))
    apex = jet.r[:, 2] - np.hypot(jet.r[:, 0], jet.r[:, 1]) / tan(SETTINGS.machine_root_angle)
    assert np.allclose(apex, 0.2071 / sin(SETTINGS.machine_root_angle), atol=1e-10)
    assert -tooth.blank.root_apex == pytest.approx(0.2150, abs=1e-4)
    assert apex[0] + tooth.blank.root_apex == pytest.approx(0.0060, abs=1e-4)
    assert np.allclose(jet.curvature().gaussian, 0.0, atol=1e-12)


def test_settings_as_printed_leave_the_root_too_high():
    """Table 3.4 exchanges sliding base and blank offset: as printed the slot is 0.210 mm too shallow, else 0.0025."""
    printed = make_face_milled(replace(SETTINGS, sliding_base=0.0, blank_offset=-0.2071))
    for tooth, off in ((printed, 0.2104), (make_face_milled(), 0.0025)):
        cone, above = tooth.blank.cone_height(tooth.bottom.jet(*tooth.bottom.locate([0.5], [0.5])).r)
        assert (above + tooth.blank.dedendum_at(cone))[0] == pytest.approx(off, abs=1e-4)


def test_windows_fill_the_pitch():
    """Twice both windows is the pitch around the axis times the cosine of the spiral angle."""
    tooth = make_face_milled()
    for side in SIDES:
        patch = tooth.flank(side)
        u, v = patch.meet(np.array([tooth.blank.mean]), np.zeros(1))
        inward, outward = patch.windows(u, v)
        radius = np.hypot(*patch.jet(u, v).r[0, :2])
        pitch = 2.0 * pi * radius / 33.0 * cos(radians(trace_angle(patch, tooth.blank.mean)))
        assert 2.0 * (inward + outward)[0] == pytest.approx(pitch, rel=1e-6)
    fillet, bottom = tooth.fillet("convex"), tooth.bottom
    for patch in (fillet, bottom):
        inward, outward = patch.windows(*patch.locate(*spread()))
        assert np.all(inward > 2.0)
        assert np.all((outward > 1.8) & (outward < 2.0))


def test_grids_of_samples_can_be_laid_on_every_patch(face_milled):
    for patch in face_milled.patches:
        grid = sample_grid(patch, 3, 5, 0.05)
        assert np.isfinite(grid.point).all()
        assert (grid.inward > 0.3).all()
        assert (grid.outward > 0.0).all()


def test_the_motion_covers_the_face_with_run_out():
    tooth = make_face_milled()
    start, end = tooth.motion_range
    phi = np.concatenate([p.pose_parameter(*p.locate(*spread(9, 9))) for p in tooth.patches])
    assert start == pytest.approx(phi.min() - 0.05 * np.ptp(phi))
    assert end == pytest.approx(phi.max() + 0.05 * np.ptp(phi))
    formate = make_face_milled(generated=False)
    back, full = formate.motion_range
    pose = formate.poses(np.array([back, full]), 0)
    assert np.allclose(pose.tip.value[1], SETTINGS.poses(np.zeros(1), 0).tip.value[0])
    assert full == 0.0
    assert (pose.tip.value[0] - pose.tip.value[1]) @ pose.axis.value[0] > 2.0 * 9.0


def test_the_formate_flank_is_the_heads_own_cone():
    tooth = make_face_milled(generated=False)
    frame = SETTINGS.frames(np.zeros(1), 0)
    for side in SIDES:
        jet = tooth.flank(side).jet(*tooth.flank(side).locate(*spread()))
        q = jet.r - frame.tip.value[0]
        z = q @ frame.axis.value[0]
        r = np.linalg.norm(q - z[:, None] * frame.axis.value[0], axis=1)
        sign = 1.0 if side == "concave" else -1.0
        assert np.allclose(r, MEAN_RADIUS + sign * (0.5 * POINT_WIDTH + z * tan(ANGLE)), atol=1e-11)
        assert np.array_equal(tooth.flank(side).sheet.pose_parameter(r, z), np.zeros(len(q)))


def test_impossible_teeth_are_refused():
    from gearsim.cutters.catalogue import conical

    blank = make_tooth().blank
    with pytest.raises(InputError, match="is no face-mill head: its profile is flat, arc, line, flat; wanted"):
        FaceMilledTooth(blank, conical(1.0, 0.5, 0.2, 20.0), SETTINGS)
    short = FaceMilledTooth(blank, make_head(height=6.0), SETTINGS)
    with pytest.raises(InputError, match=r"blade ends below the tooth's tip: its concave edge is 5\.4"):
        short.flank("concave").locate([0.5], [0.5])
    wild = make_face_milled(replace(SETTINGS, modified_roll=(0.04, -0.06, 0.05, 0.02)))
    with pytest.raises(InputError, match=r"concave does not reach cone distance 5.\.\d+ mm at"):
        wild.flank("concave").locate(*spread())
    with pytest.raises(InputError, match=r"never cuts the concave flank at the mean cone distance 68\.92 mm"):
        make_face_milled(replace(SETTINGS, radial_distance=200.0)).flank("concave").locate([0.5], [0.5])
