"""``gearsim gouge``: answers, files, exit codes and refused input."""

import json

import numpy as np
import pytest

from gearsim.cli import main
from gearsim.errors import InputError
from gearsim.gouging.asked import read_faces, read_mills
from gearsim.gouging.check import Asked, check_faces
from gearsim.scene.catalogue import read_cutter
from gearsim.surfaces.face import Face
from gearsim.surfaces.nurbs import NurbsSurface
from gearsim.surfaces.nurbs_file import write_surfaces
from tests.surfaces.nurbs_shapes import rebuilt, sphere, wavy


def check_surface(surface, cutter, mills, **options):
    return check_faces(Asked(surface.name, (Face(surface.name, surface),)), cutter, mills, **options)


BULL = ("--cutter", "bull", "diameter_mm=40", "corner_radius_mm=15")


def test_a_surface_that_is_gouged(tmp_path, capsys):
    out = tmp_path / "out"
    code = main(["gouge", "khan-9-1-free-form", *BULL, "--grid", "41", "--margin", "0.02", "--out", str(out)])
    assert code == 1
    shown = capsys.readouterr().out
    assert "gouges" in shown
    assert "R = 30, r = 14.1 mm" in shown
    report = json.loads((out / "report.json").read_text())
    assert report["gouging"] + report["tie"] + report["free"] + report["not_reached"] == report["points"]
    assert report["headline"].startswith("it gouges at ")
    assert f"**FAIL**: {report['headline']}." in (out / "report.md").read_text()
    assert report["spacing_mm"] <= 80.0 / 40.0 + 1e-9
    assert report["worst"]["least_difference_per_mm"] == pytest.approx(1.0 / 15.0 - 0.05 * np.sqrt(2.0), abs=1e-12)
    assert report["worst"]["place_mm"][0] == pytest.approx(5.0, abs=1e-5)
    assert report["worst"]["case"].startswith("case 4")
    assert {"gouging.png", "tool_size.png", "curvature.png", "gouging.exr", "report.html"} <= {
        f.name for f in out.iterdir()
    }


def test_a_surface_that_is_not(capsys):
    assert main(["gouge", "khan-9-1-cylinder", *BULL, "--grid", "21", "--margin", "0.02"]) == 0
    assert "gouges nowhere" in capsys.readouterr().out


def test_a_leaning_tool_sees_a_turned_surface_as_an_upright_one_the_plain_surface():
    surface, cutter = wavy(np.random.default_rng(2)), read_cutter(["bull", "diameter_mm=3", "corner_radius_mm=0.5"])
    lean = np.radians(25.0)
    turn = np.array([[np.cos(lean), 0, np.sin(lean)], [0, 1, 0], [-np.sin(lean), 0, np.cos(lean)]])
    turned = rebuilt(surface, surface.points @ turn.T)
    mills = read_mills("metric")
    plain = check_surface(surface, cutter, mills, grid=17)
    leaning = check_surface(turned, cutter, mills, grid=17, axis=2.0 * turn[:, 2])
    one, other = (c.looks[0].samples for c in (plain, leaning))
    assert one.touches.all()
    np.testing.assert_allclose(other.comparison.least, one.comparison.least, atol=1e-9)
    assert leaning.whole.best.row == plain.whole.best.row
    assert leaning.verdict == plain.verdict


def test_a_ball_in_a_bowl_ties_at_the_bowls_radius():
    bowl = sphere(8.0, flip=True)
    for diameter, gouging in ((15.9, False), (16.1, True)):
        cutter = read_cutter(["ball", f"diameter_mm={diameter}"])
        check = check_surface(bowl, cutter, read_mills("metric"), grid=21, margin=0.03)
        seen = check.looks[0].samples
        below = seen.touches & (seen.contacts.theta < 1.5)
        assert below.sum() > 100
        assert seen.gouges[below].all() == gouging


def test_the_normals_turned_away(tmp_path, capsys):
    file = tmp_path / "plane.json"
    write_surfaces([wavy(np.random.default_rng(0)), wavy(np.random.default_rng(1))], file)
    assert main(["gouge", str(file), "--cutter", "flat", "diameter_mm=1", "--flip", "--grid", "5"]) == 3
    shown = capsys.readouterr().out
    assert "--flip turns the normals" in shown
    assert "unchecked" in shown
    assert "surface 2" in shown


def test_catalogues_from_a_file(tmp_path):
    file = tmp_path / "mills.csv"
    file.write_text("shank_mm,corner_mm\n10, 2  # bull\n16; 0\n16 8\n")
    np.testing.assert_array_equal(read_mills(str(file)), [[16.0, 8.0], [16.0, 0.0], [10.0, 2.0]])
    file.write_text("10, 12\n")
    with pytest.raises(InputError, match="line 1"):
        read_mills(str(file))
    file.write_text("\n")
    with pytest.raises(InputError, match="no mills"):
        read_mills(str(file))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["bal"], "no such kind"),
        (["ball"], "diameter_mm: missing"),
        (["ball", "diameter_mm"], "key=value"),
        (["ball", "diameter_mm=4", "x=1"], "x: unknown key; its keys are diameter_mm"),
        (["ball", "diameter_mm=-4"], "must"),
    ],
)
def test_refused_cutters(words, message):
    with pytest.raises(InputError, match=message):
        read_cutter(words)


@pytest.mark.parametrize(
    "options", [("--grid", "1"), ("--margin", "0.6"), ("--axis", "0", "0", "0"), ("--number", "2")]
)
def test_refused_options(options, capsys):
    assert main(["gouge", "khan-9-1-cylinder", *BULL, *options]) == 2
    assert capsys.readouterr().err.startswith("gearsim: ")


def test_the_worst_point_is_the_least_of_all():
    asked = read_faces("khan-9-1-free-form")
    check = check_faces(asked, read_cutter(["ball", "diameter_mm=30"]), read_mills("khan"), grid=11)
    seen = check.looks[0].samples
    assert check.worst.least <= np.min(seen.comparison.least[seen.touches])
    assert check.worst.least == pytest.approx(1.0 / 15.0 - 0.05 * np.sqrt(2.0), abs=1e-12)


@pytest.mark.parametrize("catalogue", ["khan", "metric", "own"])
def test_only_mills_of_the_catalogue_asked_for_are_proposed(catalogue, tmp_path, capsys):
    """Khan's algorithm chooses from his own mills alone: R = 30 is no metric one. A plane stops no mill."""
    (tmp_path / "own.txt").write_text("7 7\n5 1\n")
    write_surfaces([flat()], tmp_path / "plane.json")
    name = str(tmp_path / "own.txt") if catalogue == "own" else catalogue
    out = tmp_path / "out"
    tool = ("--cutter", "ball", "diameter_mm=12", "--catalogue", name, "--grid", "9")
    assert main(["gouge", str(tmp_path / "plane.json"), *tool, "--out", str(out)]) == 0
    shown, sizes = capsys.readouterr().out, json.loads((out / "report.json").read_text())["tool_size"]
    mills = read_mills(name)
    assert (sizes["optimum"]["shank_mm"], sizes["optimum"]["corner_mm"]) == tuple(mills[0])
    assert sizes["optimum"]["limited_at_mm"] is None
    assert "The optimum is the catalogue's largest. " in (out / "report.md").read_text()
    assert ("Khan's algorithm: R = 30, r = 30 mm; " in shown) == (catalogue == "khan")
    assert ("thesis" in sizes) == (catalogue == "khan")


def flat():
    """A plane of 20 by 20 mm at z = 0, its material below."""
    points = [[[x, y, 0.0] for y in (0.0, 20.0)] for x in (0.0, 20.0)]
    return NurbsSurface(1, 1, [0.0, 0.0, 1.0, 1.0], [0.0, 0.0, 1.0, 1.0], points, name="plane")
