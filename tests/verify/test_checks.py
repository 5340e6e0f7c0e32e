"""Right formulas pass; each kind of wrong formula fails its own check and no other."""

from dataclasses import replace
from math import cos, radians, sin, tan

import numpy as np
import pytest

from gearsim.cutters.catalogue import apt
from gearsim.motion.sources import CLMotion
from gearsim.surfaces.patch import SIDES
from gearsim.toolpaths.flank import FlankPath
from gearsim.verify import Claimed, envelope_form, envelope_forms, pose_form, verify_form
from tests.verify.forms import BALL, changed, circular_form, corner_of_a_path, with_own_normals

TAPER = radians(15.0)
POINTS = 60


def failed(report):
    return {name for name, check in report.checks.items() if not check.passed}


def verify(form, points=POINTS):
    return verify_form(form, points, seed=3)


@pytest.fixture(params=SIDES)
def path(request, tooth, published_cutter):
    return FlankPath(tooth, request.param, published_cutter, 8.0)


def flank_form(path, branch, slip=False):
    """Zhou 4.30 to 4.32 on the conical cutter's flank (R1 = 1, R2 = 1.5); ``slip``: with 4.33 as printed."""
    first = tan(TAPER) + 1.5

    def circles(v):
        h = first + 20.0 * v
        return h, 1.0 / cos(TAPER) + 1.5 + (h - first) * sin(TAPER), np.full(len(v), -sin(TAPER))

    def slide(t):
        """|q_m o_c|' by t, Zhou 4.37: sec(taper) sec(pressure angle) h_m'."""
        motion, step = path.motion, 1e-5
        phi = motion.start + t * (motion.end - motion.start)
        h = [path.contact_height(path.tooth.spine(phi + s * step, 0).cone.value) for s in (1.0, -1.0)]
        return (h[0] - h[1]) / (2.0 * step) / cos(TAPER) / cos(path.tooth.pressure_angle) * (motion.end - motion.start)

    return circular_form(path.motion, path.cutter, circles, branch, slide if slip else None)


def own_branch(path):
    """The branch on the flank's side: that whose normal is the tooth's."""
    form = flank_form(path, 1.0)
    claimed = form.points(np.array([0.5]), np.array([0.2]))
    phi = 0.5 * (path.motion.start + path.motion.end)
    jet = path.tooth.flank(path.side).jet(np.array([phi]), np.array([path.contact_height(68.9)]))
    return 1.0 if float(np.sum(claimed.normal * jet.normal)) > 0.0 else -1.0


def test_zhous_flank_passes(path):
    for branch in (1.0, -1.0):
        report = verify(flank_form(path, branch))
        assert report.verdict == "pass"
        assert report.checks["distance"].worst < 1e-12


def test_zhous_4_33_as_printed_is_caught(path):
    """The reference point's sliding left in v_q: the surface leaves the flank by tenths of a micrometre."""
    printed = flank_form(path, own_branch(path), slip=True)
    report = verify(with_own_normals(printed))
    assert failed(report) == {"distance"}
    assert 1e-4 < report.checks["distance"].worst < 2e-3
    assert report.trimmed == 0
    assert failed(verify(printed)) == {"distance", "normal"}


def corner_form(wrong):
    """Zhou 4.2 for the corner of his APT cutter {45, 10, 3, 10 deg, 10 deg}: rho as printed, or right."""
    e, r = 10.0, 3.0
    lower = (e + r * sin(radians(10.0)), 0.0)
    f = lower[0] * tan(radians(10.0)) + r * cos(radians(10.0))
    upper = (e + r * cos(radians(10.0)), f - r * sin(radians(10.0)))
    slope = tan(radians(10.0))
    cutter = apt(2.0 * (upper[0] - upper[1] * slope) / (1.0 - slope**2), r, e, f, radians(10.0), radians(10.0), 45.0)
    tips = np.array([[0.0, 0.0, 0.0], [50.0, 50.0, 10.0]])
    axes = np.array([[0.0, 0.0, 1.0], [sin(0.3) * cos(0.3), sin(0.3) * sin(0.3), cos(0.3)]])

    def circles(v):
        nz = -0.2 - 0.7 * v
        nr = np.sqrt(1.0 - nz**2)
        rho = e + r / nr if wrong else e / nr + r
        return f - e * nz / nr, rho, nz

    return circular_form(CLMotion(tips, axes), cutter, circles, 1.0)


def test_zhous_4_2_as_printed_is_caught():
    assert verify(corner_form(wrong=False)).verdict == "pass"
    report = verify(with_own_normals(corner_form(wrong=True)))
    assert failed(report) == {"distance"}
    assert report.checks["distance"].worst > 0.1
    assert report.checks["sign"].checked == 0  # so far from the tool there is no side to be on


@pytest.fixture(scope="module")
def cone(tooth, fitting_cutter):
    path = FlankPath(tooth, "concave", fitting_cutter, 8.0)
    return envelope_form("cone", path.motion, fitting_cutter, fitting_cutter.flank, 1.0)


def turned(angle):
    """Normals turned by an angle [rad] about a tangent."""

    def normal(u, v, claimed):
        tangent = np.cross(claimed.normal, [0.3, -0.5, 0.8])
        tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
        return np.cos(angle) * claimed.normal + np.sin(angle) * tangent

    return normal


WRONG = {
    "points off by 2 nm": ({"point": lambda u, v, c: c.point + 2e-6 * c.normal}, {"distance"}),
    "points in the air by 2 nm": ({"point": lambda u, v, c: c.point - 2e-6 * c.normal}, {"distance"}),
    "another pose": ({"t": lambda u, v, c: np.clip(c.t + 1e-3, 0.0, 1.0)}, {"distance"}),
    "normals into the material": ({"normal": lambda u, v, c: -c.normal}, {"sign"}),
    "normals off by 1e-5": ({"normal": turned(1e-5)}, {"normal"}),
    "K and H exchanged (Zhou 2.51)": (
        {"curvature": lambda u, v, c: replace(c.curvature, gaussian=c.curvature.mean, mean=c.curvature.gaussian)},
        {"curvature"},
    ),
    "principal curvatures of the other side": (
        {"curvature": lambda u, v, c: replace(c.curvature, k1=-c.curvature.k2, k2=-c.curvature.k1)},
        {"curvature"},
    ),
    "curvature off by 1e-5": (
        {"curvature": lambda u, v, c: replace(c.curvature, k1=1.00001 * c.curvature.k1, k2=1.00001 * c.curvature.k2)},
        {"curvature"},
    ),
    "a number that is none": ({"curvature": lambda u, v, c: replace(c.curvature, k1=0.0 / u * np.nan)}, {"curvature"}),
}


def test_the_unchanged_form_passes(cone):
    assert verify(cone).verdict == "pass"


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_claim_fails_its_own_check_and_no_other(cone, name):
    changes, expected = WRONG[name]
    report = verify(changed(cone, **changes))
    assert failed(report) == expected
    assert report.verdict == "fail"


def test_normals_of_the_other_branch_are_caught(cone):
    other = replace(cone, points=envelope_form("", cone.motion, cone.cutter, cone.cutter.flank, -1.0).points)
    mixed = changed(cone, normal=lambda u, v, c: other.points(u, v).normal)
    assert failed(verify(mixed)) == {"normal", "sign"}


def test_rough_points_cannot_hide_as_unsettled(cone, rng):
    rough = changed(cone, point=lambda u, v, c: c.point + 1e-9 * rng.normal(size=c.point.shape))
    assert {"curvature"} <= failed(verify(rough))


def within(points, ends):
    """Which points lie in the capsule that a ball leaves along a straight step."""
    a, b = ends + np.array([0.0, 0.0, BALL])
    share = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
    return np.linalg.norm(points - a - share[:, None] * (b - a), axis=1) < BALL - 1e-9


def test_points_cut_away_by_another_pose_are_counted_apart():
    form = corner_of_a_path()
    report = verify_form(form, 400, seed=5)
    u, v = np.random.default_rng(5).uniform(size=(2, 400))
    claimed, tips = form.points(u, v), form.motion.tips
    first, second = (within(claimed.point, tips[i : i + 2]) for i in (0, 1))
    expected = np.where(claimed.piece == 0, second, first).sum()
    assert report.trimmed == expected > 10
    assert report.verdict == "pass"
    assert report.checks["distance"].checked == 400 - expected


def test_a_wrong_point_does_not_pass_for_a_trimmed_one():
    """Points on the tool, but ahead of where it touches, are cut away by later poses: that is no excuse."""
    report = verify_form(with_own_normals(corner_of_a_path(lean=1e-3), 1e-6), 100, seed=5)
    assert "distance" in failed(report)
    assert report.checks["distance"].failed > 80


def test_a_form_without_a_pose_is_checked_but_cannot_be_trimmed():
    form = corner_of_a_path()
    bare = replace(form, points=lambda u, v: Claimed(*(getattr(form.points(u, v), k) for k in ("point", "normal"))))
    report = verify_form(bare, 200, seed=5)
    assert report.trimmed == 0
    assert failed(report) == {"distance"}


def test_both_branches_of_every_element_of_cl_data_pass(tooth, fitting_cutter):
    """Many pieces: nothing is differenced across a joint, and what joints cut away is counted apart."""
    motion = FlankPath(tooth, "concave", fitting_cutter, 8.0).cl_motion(9)
    forms = envelope_forms(motion, fitting_cutter, "concave")
    assert [f.name for f in forms][2:4] == ["concave: torus, branch +1", "concave: torus, branch -1"]
    reports = [verify(form, 80) for form in forms]
    assert {r.verdict for r in reports} == {"pass", "nothing"}
    assert sum(r.trimmed for r in reports) > 5


def test_where_there_is_no_point_nothing_is_checked(cone):
    nowhere = changed(cone, exists=lambda u, v, c: np.zeros(len(u), dtype=bool))
    report = verify(nowhere)
    assert (report.verdict, report.missing, report.checks) == ("nothing", POINTS, {})


def test_a_plunge_leaves_the_tool_as_it_stands_at_its_end(fitting_cutter):
    tips = np.array([[1.0, 2.0, 30.0], [1.0, 2.0, 5.0]])
    motion = CLMotion(tips, np.tile([0.0, 0.0, 1.0], (2, 1)))
    forms = [pose_form(str(i), motion, fitting_cutter, i, 1.0) for i in range(len(fitting_cutter.elements))]
    reports = [verify(form) for form in forms]
    assert [r.verdict for r in reports] == ["pass", "pass", "pass", "nothing"]
    assert [r.trimmed for r in reports] == [0, 0, 0, POINTS]  # poses before the end cut what stands above it
    assert all(r.checks["curvature"].checked > 0.5 * POINTS for r in reports[1:3])
    wrong = changed(forms[2], point=lambda u, v, c: c.point + 2e-6 * c.normal)
    assert failed(verify(wrong)) == {"distance"}
