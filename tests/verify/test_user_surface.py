from pathlib import Path

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.motion.sources import CurveMotion
from gearsim.verify import PoseFunction, load_surface, verify_form

EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "helical_groove.py"


def written(folder, old="", new="", name="mine.py"):
    text = EXAMPLE.read_text()
    assert old in text
    file = folder / name
    file.write_text(text.replace(old, new, 1))
    return file


def line_of(file, text):
    return next(i for i, line in enumerate(file.read_text().splitlines(), 1) if text in line)


def test_the_documented_example_passes():
    report = verify_form(load_surface(EXAMPLE), 200, seed=1)
    assert report.verdict == "pass"
    assert report.name == "helical groove"
    assert set(report.checks) == {"distance", "sign", "normal", "curvature"}


@pytest.mark.parametrize(
    ("old", "new", "check"),
    [
        ("point=centre + BALL * spoke", "point=centre + BALL * spoke + [0.0, 0.0, 2e-6]", "distance"),
        ("normal=-spoke", "normal=spoke", "sign"),
        ("along = -bend", "along = bend", "curvature"),
        ("t=u,", "t=u**1.01,", "distance"),
    ],
)
def test_a_slip_in_the_file_is_caught_by_its_check(tmp_path, old, new, check):
    report = verify_form(load_surface(written(tmp_path, old, new)), 100, seed=1)
    assert {name for name, c in report.checks.items() if not c.passed} == {check}


def test_cl_data_and_a_plain_pair_will_do(tmp_path):
    file = tmp_path / "line.py"
    file.write_text(
        "import numpy as np\n"
        "from gearsim.cutters.catalogue import apt\n"
        "from gearsim.motion.sources import CLMotion\n"
        "cutter = apt(d=4.0, r=2.0, e=0.0, f=2.0, alpha=0.0, beta=0.0, h=20.0)\n"
        "motion = CLMotion(np.array([[0., 0, 0], [10, 0, 0]]), np.array([[0., 0, 1], [0, 0, 1]]))\n"
        "def points(u, v):\n"
        "    a = np.pi * (1.0 + v)\n"
        "    spoke = np.stack([0.0 * a, np.cos(a), np.sin(a)], axis=1)\n"
        "    return np.stack([10.0 * u, 0.0 * u, 0.0 * u + 2.0], axis=1) + 2.0 * spoke, -spoke\n"
    )
    report = verify_form(load_surface(file), 100, seed=1)
    assert report.verdict == "pass"
    assert set(report.checks) == {"distance", "sign", "normal"}


@pytest.mark.parametrize(
    ("old", "new", "culprit", "message"),
    [
        ("spoke = c[:", "spoke = d[:", "spoke = d", "NameError: name 'd' is not defined"),
        ("BALL = 3.0", "BALL = 1 / 0", "BALL = 1", "ZeroDivisionError"),
        ("def pose(t):", "def pose(t:", "def pose(t:", "not valid Python"),
        ("BALL = 3.0", "BALL = -3.0", "cutter = apt", "diameter d = -6 mm must be positive"),
        ("centre, *_ = helix(TURN * t)", "raise SystemExit('no')", "raise SystemExit", "SystemExit: no"),
    ],
)
def test_an_error_in_the_file_is_told_with_its_line(tmp_path, old, new, culprit, message):
    file = written(tmp_path, old, new)
    with pytest.raises(InputError) as caught:
        verify_form(load_surface(file), 20, seed=1)
    assert str(caught.value).startswith(f"{file}, line {line_of(file, culprit)}: ")
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("cutter =", "tool =", "it does not define 'cutter', a Profile"),
        ("cutter = apt(d=2 * BALL", "cutter = dict(d=2 * BALL", "'cutter' is dict; expected a Profile"),
        ("def points", "def formula", "it does not define 'points'"),
        ("def pose(t)", "def poses(t)", "it does not define 'motion'"),
        ("def pose(t)", "motion = 3.0\ndef poses(t)", "'motion' is float; expected CLMotion or CurveMotion"),
        ("normal=-spoke", "normal=-2.0 * spoke", "a normal of length 2; expected 1"),
        ("point=centre + BALL * spoke", "point=centre.T", r"a point of shape \(3, 20\); expected \(20, 3\)"),
        ("t=u,", "t=u[:-1],", r"t of shape \(19,\); expected \(20,\)"),
        ("return Claimed(", "return dict(", "must return a Claimed, or two arrays"),
        ("- BALL * axis, axis", "- BALL * axis, 2.0 * axis", "an axis of length 2; expected 1"),
        ("- BALL * axis, axis", "- BALL * axis", "must return two arrays: tips and axes"),
        ("- BALL * axis, axis", "- BALL * axis, axis[:, :2]", "axes of shape"),
    ],
)
def test_what_the_file_must_define_is_told(tmp_path, old, new, message):
    with pytest.raises(InputError, match=message):
        verify_form(load_surface(written(tmp_path, old, new)), 20, seed=1)


def test_no_file_is_told(tmp_path):
    with pytest.raises(InputError, match="cannot read surface"):
        load_surface(tmp_path / "none.py")


def test_plain_poses_have_the_derivatives_of_the_motion(tooth, fitting_cutter):
    from gearsim.toolpaths.flank import FlankPath

    exact = FlankPath(tooth, "convex", fitting_cutter, 8.0).motion
    assert isinstance(exact, CurveMotion)

    def poses(t):
        pose = exact.pose(np.zeros(len(t), dtype=int), t, 0)
        return pose.tip.value, pose.axis.value

    t, piece = np.linspace(0.0, 1.0, 11), np.zeros(11, dtype=int)
    for ours, theirs in zip(PoseFunction(poses).pose(piece, t, 2), exact.pose(piece, t, 2), strict=True):
        assert np.array_equal(ours.c[0], theirs.c[0])
        assert np.allclose(ours.c[1:], theirs.c[1:], rtol=1e-2, atol=1e-2)
