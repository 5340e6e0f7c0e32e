import numpy as np
import pytest
from matplotlib.image import imread

from gearsim.cli import main
from gearsim.verify import Limits, load_surface, verify_form
from gearsim.verify.error_map import ErrorMap
from gearsim.verify.plot import draw_map, worst_lines
from tests.verify.test_user_surface import EXAMPLE, written

BUMP = "point=centre + BALL * spoke + 1e-6 * np.exp(-200 * ((u - 0.8) ** 2 + (v - 0.3) ** 2))[:, None] * spoke"


def run(*arguments):
    return main(["verify", *map(str, arguments)])


def test_the_map_finds_the_place_where_a_formula_errs(tmp_path):
    file = written(tmp_path, "point=centre + BALL * spoke", BUMP)
    report = verify_form(load_surface(file), 800, seed=1)
    worst = report.errors.worst("distance")
    assert worst.error == report.checks["distance"].worst
    assert worst.error == pytest.approx(1e-6, rel=0.2)
    assert (worst.u, worst.v) == pytest.approx((0.8, 0.3), abs=0.05)
    error, far = report.errors.errors["distance"], np.hypot(report.errors.u - 0.8, report.errors.v - 0.3) > 0.35
    assert error[far].max() < 1e-12 < 1e-9 < error[~far].max()


def test_the_command_writes_the_picture_and_names_the_worst_point(tmp_path, capsys):
    file, picture = written(tmp_path, "point=centre + BALL * spoke", BUMP), tmp_path / "errors.png"
    assert run("--surface", file, "--points", 200, "--plot", picture) == 1
    out = capsys.readouterr().out
    worst = verify_form(load_surface(file), 200, seed=1).errors.worst("distance")
    assert f"wrote {picture}" in out
    assert f"distance: worst {worst.error:.3g} mm at u = {worst.u:.4f}, v = {worst.v:.4f}" in out
    pixels = imread(picture)[..., :3]
    assert pixels.shape[1] > 1000
    purple = (pixels[..., 1] < 0.6 * pixels[..., 0]) & (pixels[..., 1] < 0.6 * pixels[..., 2])
    green = (pixels[..., 0] < 0.6 * pixels[..., 1]) & (pixels[..., 2] < 0.8 * pixels[..., 1])
    assert 0.0005 < purple.mean() < green.mean()


def test_what_was_not_compared_has_no_error():
    errors = ErrorMap(*np.array([[0.1, 0.2, 0.3, 0.4, 0.5], [0.5] * 5]), np.array([True, False, False, False, False]))
    found = {"distance": (np.array([1.0, np.nan, 2.0]), np.array([True, True, False]))}
    known = errors.known(np.array([False, True, False, False]), found, np.array([False, True, False]))
    assert known.errors["distance"] == pytest.approx([np.nan, 1.0, np.nan, np.inf, np.nan], nan_ok=True)
    assert known.trimmed.tolist() == [False, False, True, False, False]
    assert known.wrong_side.tolist() == [False, False, False, True, False]
    assert known.worst("distance") == (np.inf, 0.4, 0.5)
    nothing = ErrorMap(errors.u, errors.v, errors.missing, errors={"normal": np.full(5, np.nan)})
    assert nothing.worst("normal") is None


@pytest.mark.parametrize(
    ("old", "new"), [("normal=-spoke", "normal=spoke"), ("t=u,", "t=u**1.01,"), ("point=centre", "point=np.nan*centre")]
)
def test_any_report_can_be_drawn(old, new, tmp_path):
    report = verify_form(load_surface(written(tmp_path, old, new)), 30, seed=1)
    if report.errors.errors:
        draw_map(report, Limits(), tmp_path / "a.svg")
        assert (tmp_path / "a.svg").stat().st_size > 10_000
        assert len(list(worst_lines(report))) == len(report.errors.errors)
    else:
        assert report.missing == 30


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--plot", "a.gif"], "--plot a.gif: expected a name that ends in .png, .svg, .pdf"),
        (["--plot", "/dev/null/a.png"], "cannot write /dev/null/a.png"),
        (["--plot", "a.png", "--points-file", "p.csv"], "a point list has none"),
        (["--plot", "a.png", "--torture", "small"], "--torture checks none"),
    ],
)
def test_what_cannot_be_drawn_is_refused(arguments, message, capsys):
    assert run("--surface", EXAMPLE, "--points", 20, *arguments) == 2
    assert message in capsys.readouterr().err


def test_several_forms_have_a_picture_each(tmp_path, capsys):
    assert run("spiral-bevel-flank", "--points", 20, "--plot", tmp_path / "e.png") == 0
    names = {f.name for f in tmp_path.iterdir()}
    assert {"e-convex-cone-branch-plus1.png", "e-concave-cone-branch-minus1.png"} <= names
    assert all(f"wrote {tmp_path / name}" in capsys.readouterr().out for name in list(names)[:1])
