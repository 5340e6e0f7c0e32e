import json
import re
from pathlib import Path

import numpy as np
import pytest

from gearsim.cli import main
from gearsim.programs.point_list import read_points
from gearsim.scene import load_scene, scene_names
from gearsim.verify import closed_forms, scenes
from tests.verify.test_user_surface import EXAMPLE, written

SCENE = "spiral-bevel-flank"


def run(*arguments):
    return main(["verify", *map(str, arguments)])


def said(capsys):
    """What was printed, on one line: where lines were broken hangs on the names of temporary folders."""
    return " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize("name", scene_names())
def test_every_built_in_scene_that_declares_a_closed_form_passes(name, capsys):
    assert run(name, "--points", 25, "--seed", 7) == 0
    out = capsys.readouterr().out
    assert ("1 of 1 passed" in out) == bool(closed_forms(*load_scene(name)))


def test_flank_milling_scenes_declare_both_flanks_elements_and_branches():
    names = [form.name for form in closed_forms(*load_scene(SCENE))]
    assert len(names) == len(set(names)) == 12
    for side in ("convex", "concave"):
        for element in ("disc", "torus", "cone"):
            assert {f"{side}: {element}, branch {b}" for b in ("+1", "-1")} <= set(names)


def test_json_holds_everything_with_units(tmp_path, capsys):
    assert run(SCENE, "--points", 20, "--out", tmp_path / "verify.json") == 0
    report = json.loads((tmp_path / "verify.json").read_text())
    assert report["schema_version"] == 1
    assert {"gearsim", "python", "numpy"} <= set(report["versions"])
    assert report["verdict"] == "pass"
    assert report["limits"]["distance_mm"] == 1e-9
    (subject,) = report["subjects"]
    form = next(f for f in subject["forms"] if f["name"] == "convex: cone, branch +1")
    assert form["points"] == 20
    assert form["checks"]["distance"]["worst_mm"] < 1e-12
    assert form["checks"]["normal"]["worst_rad"] < 1e-8
    assert form["checks"]["curvature"]["worst_relative"] < 1e-6
    assert 0.9e-3 < form["checks"]["sign"]["worst_mm"] <= 1e-3 + 1e-12
    missing = next(f for f in subject["forms"] if f["name"] == "convex: disc, branch +1")
    assert (missing["verdict"], missing["missing"], missing["checks"]) == ("nothing", 20, {})


def test_a_scene_without_closed_form_is_listed_as_having_none(monkeypatch, capsys):
    monkeypatch.setattr(scenes, "claims", lambda scene, folder: [])
    assert run(SCENE) == 0
    assert f"{SCENE}: declares no closed form" in said(capsys)


def test_a_wrong_surface_ends_with_1_and_says_where(tmp_path, capsys):
    file = written(tmp_path, "normal=-spoke", "normal=spoke")
    assert run("--surface", file, "--points", 20, "--out", tmp_path / "v.json") == 1
    out = capsys.readouterr().out
    assert "FAILS helical groove: sign: 20 of 20 points, worst at (" in out
    assert "helical groove: all normals point into the material; turned round they are right" in out
    report = json.loads((tmp_path / "v.json").read_text())
    assert report["verdict"] == "fail"
    assert report["subjects"][0]["forms"][0]["checks"]["sign"]["inward"] == 20


def test_a_surface_with_no_point_at_all_fails_and_is_not_written(tmp_path, capsys):
    file = written(tmp_path, "point=centre", "point=np.nan * centre")
    assert run("--surface", file, "--points", 20) == 1
    assert "no point to check" in said(capsys)
    assert run("--surface", file, "--write-points", tmp_path / "p.csv") == 2
    assert "has a point that its motion leaves" in capsys.readouterr().err


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_points_written_are_read_and_verified(tmp_path, capsys, suffix):
    assert run(SCENE, "--write-points", tmp_path / f"p{suffix}") == 0
    files = sorted(tmp_path.iterdir())
    assert [re.sub(r"\..*", "", f.name) for f in files] == sorted(
        f"p-{side}-{element}-branch-{b}"
        for side in ("convex", "concave")
        for element in ("torus", "cone")
        for b in ("plus1", "minus1")
    )
    assert read_points(files[0]).shape == (9, 33)
    for file in (files[0], files[-1]):
        assert run(SCENE, "--points-file", file) == 0


def test_points_written_where_the_flank_bends_almost_as_the_tool_are_verified_too(tmp_path):
    assert run("spur-internal", "--write-points", tmp_path / "p.csv") == 0
    for file in tmp_path.iterdir():
        assert run("spur-internal", "--points-file", file) == 0


def test_a_list_is_told_which_of_its_normals_point_into_the_material(listed, capsys):
    file = listed(lambda rows: rows * np.where(np.arange(len(rows))[:, None] < 3, [1, 1, 1, -1, -1, -1], 1))
    assert run("--surface", EXAMPLE, "--points-file", file) == 1
    assert "3 of 297 normals point into the material" in said(capsys)
    file.write_text(file.read_text().replace(",out of", ",into"))
    assert run("--surface", EXAMPLE, "--points-file", file) == 1
    assert "294 of 297 normals point into the material" in said(capsys)


def test_a_normal_across_the_surface_is_not_said_to_be_the_wrong_way_round(tmp_path, capsys):
    assert run("--surface", written(tmp_path, "normal=-spoke", "normal=np.roll(spoke, 1, axis=1)"), "--points", 20) == 1
    out = capsys.readouterr().out
    assert "FAILS helical groove: normal" in out
    assert "all normals point into" not in out


@pytest.fixture
def listed(tmp_path):
    """A point list of the example, its rows changed by a function of their numbers."""

    def make(change=lambda rows: rows, edit=lambda text: text):
        assert run("--surface", EXAMPLE, "--write-points", tmp_path / "p.csv") == 0
        (file,) = tmp_path.glob("p-*.csv")
        head, *lines = file.read_text().splitlines()
        cells = [line.split(",", 6) for line in lines]
        rows = change(np.array([line[:6] for line in cells], dtype=float)).tolist()
        text = "\n".join([head, *(",".join([*map(repr, row), line[6]]) for row, line in zip(rows, cells, strict=True))])
        file.write_text(edit(text))
        return file

    return make


def off(rows):
    return rows + 2e-6 * np.hstack([rows[:, 3:], 0.0 * rows[:, :3]])


def turned(rows):
    tangent = np.cross(rows[:, 3:], [0.3, -0.5, 0.8])
    normal = rows[:, 3:] + 1e-5 * tangent / np.linalg.norm(tangent, axis=1, keepdims=True)
    return np.hstack([rows[:, :3], normal / np.linalg.norm(normal, axis=1, keepdims=True)])


@pytest.mark.parametrize(
    ("change", "check"),
    [(lambda r: r, None), (off, "distance"), (lambda r: r * [1, 1, 1, -1, -1, -1], "sign"), (turned, "normal")],
)
def test_a_wrong_list_fails_its_own_check_and_no_other(listed, tmp_path, capsys, change, check):
    file = listed(change)
    assert run("--surface", EXAMPLE, "--points-file", file, "--out", tmp_path / "v.json") == int(check is not None)
    (form,) = json.loads((tmp_path / "v.json").read_text())["subjects"][0]["forms"]
    assert [name for name, c in form["checks"].items() if c["failed"]] == ([check] if check else [])


def test_rounded_points_pass_within_a_wider_limit(listed):
    file = listed(lambda rows: np.hstack([rows[:, :3].round(6), rows[:, 3:]]))
    assert run("--surface", EXAMPLE, "--points-file", file) == 1
    assert run("--surface", EXAMPLE, "--points-file", file, "--limit-mm", 1e-6) == 0


def test_bad_input_is_one_message_and_exit_code_2(listed, tmp_path, capsys):
    broken = written(tmp_path, "spoke = c[:", "spoke = d[:")
    bad_list = listed(edit=lambda text: "# units: inch\n" + text)
    cases = {
        ("nosuch",): "no scene named 'nosuch'",
        ("--surface", broken): "NameError: name 'd' is not defined",
        ("--surface", EXAMPLE, "--points-file", bad_list): "units 'inch'; point lists are read in mm",
        ("--surface", EXAMPLE, "--points-file", tmp_path / "none.csv"): "cannot read point list",
        ("--surface", EXAMPLE, SCENE, "--points-file", bad_list): "needs exactly one scene",
        ("--surface", EXAMPLE, "--points", "5", "--out", "/dev/null/v.json"): "cannot write /dev/null/v.json",
        ("--surface", EXAMPLE, "--write-points", "/dev/null/p.csv"): "cannot write point list",
    }
    capsys.readouterr()
    for arguments, message in cases.items():
        assert run(*arguments) == 2
        err = capsys.readouterr().err
        assert message in err
        assert err.startswith("gearsim: ")
        assert "Traceback" not in err


def test_the_list_says_which_flank_it_is(tmp_path, capsys):
    assert run(SCENE, "--write-points", tmp_path / "p.csv") == 0
    file = next(tmp_path.glob("*concave-cone-branch-plus1*"))
    text = file.read_text()
    assert text.count(",concave,") == len(text.splitlines()) - 1
    file.write_text(text.replace(",concave,", ",left,"))
    assert run(SCENE, "--points-file", file) == 2
    assert "flank 'left' has no motion here; it may be concave, convex" in capsys.readouterr().err
    file.write_text(text.replace(",concave,", ",convex,"))
    assert run(SCENE, "--points-file", file) == 1


def test_where_there_is_one_motion_any_flank_is_its(listed):
    assert run("--surface", EXAMPLE, "--points-file", listed(edit=lambda t: "# flank: left\n" + t)) == 0


@pytest.mark.parametrize("arguments", [["--points", "0"], ["--points", "x"], ["--limit-mm", "-1"], ["--limit-mm", "a"]])
def test_impossible_options_are_refused(arguments, capsys):
    with pytest.raises(SystemExit) as stop:
        run(*arguments)
    assert stop.value.code == 2
    assert "expected" in capsys.readouterr().err


def test_the_documentation_names_the_example():
    text = (Path(__file__).parents[2] / "docs" / "verify.md").read_text()
    assert "docs/examples/helical_groove.py" in text
