import json

import pytest

from gearsim.cli import main
from gearsim.errors import InputError
from gearsim.output.painting import KINDS, Painters, kinds
from gearsim.output.presenters import promised
from gearsim.output.wanted import EVERYTHING, Wanted
from gearsim.output.write import REPORTS, refuse_unknown, write_result
from gearsim.processes.run import plan, run
from gearsim.scene import load_scene
from tests.output.conftest import SMALL


def written(result, folder, wanted):
    with Painters(wanted) as painters:
        assert write_result(result, folder, painters) == []
    return {f.name for f in folder.iterdir()}


def test_names_and_patterns_choose_among_all_kinds_of_files(result, tmp_path):
    only = ("report.json", "*.parquet", "dev*", "tooth.*", "toolpath.cl")
    names = written(result, tmp_path, Wanted(only=only))
    assert names == {
        "report.json", "samples.parquet", "deviation.png", "deviation.exr", "tooth.png", "tooth.vtp", "toolpath.cl",
    }  # fmt: skip
    assert json.loads((tmp_path / "report.json").read_text())["not_drawn"] == []


def test_a_report_holds_the_pictures_that_are_wanted_beside_it(result, tmp_path):
    assert written(result, tmp_path, Wanted(only=("report.html", "mean*.png"))) == {"report.html", "mean-profile.png"}
    html = (tmp_path / "report.html").read_text()
    assert html.count('<p><img src="data:image/png;base64,') == 1
    assert "gearsim-view" not in html
    assert "report.json" not in html


def test_a_report_holds_the_view_that_is_wanted_alone(result, tmp_path):
    assert written(result, tmp_path, Wanted(only=("report.html", "report.md", "view"))) == {"report.html", "report.md"}
    html, text = (tmp_path / "report.html").read_text(), (tmp_path / "report.md").read_text()
    assert html.count('<section class="gearsim-view">') == html.count("plotly.js v") == 1
    assert '<p><img src="data' not in html
    assert text.count("<!-- in report.html: a 3D view -->") == 1
    with pytest.raises(InputError, match=r"--only view: the view stands in report.html, .*; add report.html"):
        refuse_unknown(result.job, Wanted(only=("view", "report.json")))
    refuse_unknown(result.job, Wanted(only=("view", "report.html")))
    assert written(result, tmp_path, Wanted(only=("v*",))) == {"report.html", "report.md"}  # as they were


def test_a_format_can_be_wanted_alone(result, tmp_path):
    assert written(result, tmp_path, Wanted(formats=("svg",), only=("inspection.svg",))) == {"inspection.svg"}


@pytest.mark.parametrize(
    ("wanted", "unknown"),
    [
        (Wanted(only=("report.json", "deviaton.png")), "deviaton.png"),
        (Wanted(only=("no*", "tooth.png")), r"no\*"),
        (Wanted(pictures=False, only=("tooth.png",)), "tooth.png"),
        (Wanted(pictures=False, only=("report.html", "view")), "view"),
        (Wanted(only=("deviation.svg",)), "deviation.svg"),
        (Wanted(formats=("svg",), only=("tooth.svg",)), "tooth.svg"),
        (Wanted(only=("gear.png",)), "gear.png"),
    ],
)
def test_a_name_that_no_file_bears_is_refused_with_those_there_are(result, wanted, unknown):
    with pytest.raises(InputError, match=rf"--only {unknown}: no file .*; there are .*deviation.exr.*toolpath.cl"):
        refuse_unknown(result.job, wanted)


def test_a_run_keeps_what_its_job_promises(result, folder):
    left = {f.name for f in folder.iterdir()}
    assert {*REPORTS, *result.job.files, *promised(result.job)} == left


SCENES = {name: frozenset(pictures.split()) for name, pictures in {
    "spiral-bevel-face-milled": "deviation envelope tooth",
    "hypoid-pinion-phoenix": "axes deviation envelope tooth",
    "flat-end-envelope": "axes deviation envelope",
    "gouge-verification": "curvature-6-2",
    "gouge-flat-end-mill": "flat-end-mill",
    "gouge-cases": "curvature-6-1-1 curvature-6-1-2 curvature-6-1-3 curvature-6-1-4 curvature-6-1-5 curvature-6-1-6",
    "spur-internal": "deviation gear helix inspection pitch profile roughness section topography",
}.items()}  # fmt: skip


@pytest.mark.parametrize("name", SCENES)
def test_the_pictures_of_a_scene_are_told_from_its_job(name):
    scene, folder = load_scene(name)
    assert {f"{picture}.png" for picture in SCENES[name]} == {
        file for file in promised(plan(scene, folder)) if file.endswith(".png")
    }


def test_what_nothing_came_of_is_named(tmp_path):
    perfect = run("spiral-bevel-face-milled", overrides=("metrology.rows=4", "metrology.columns=6"))
    wanted = Wanted(only=("report.json", "deviation.png"))
    refuse_unknown(perfect.job, wanted)
    with Painters(wanted) as painters:
        assert write_result(perfect, tmp_path, painters) == ["deviation.png: nothing to show in it"]
    assert {f.name for f in tmp_path.iterdir()} == {"report.json"}


@pytest.mark.parametrize(
    ("wanted", "needed"),
    [
        (EVERYTHING, KINDS),
        (Wanted(pictures=False), ()),
        (Wanted(only=("report.json", "samples.parquet", "*.exr")), ()),
        (Wanted(only=("tooth.vtp",)), ("solid",)),
        (Wanted(only=("tooth.png",)), ("solid",)),
        (Wanted(only=("report.html", "view")), ("solid",)),
        (Wanted(only=("deviation.png",)), ("flat",)),
        (Wanted(only=("*.svg",)), ()),
        (Wanted(formats=("svg",), only=("*.svg",)), ("flat",)),
        (Wanted(only=("*",)), KINDS),
    ],
)
def test_drawing_processes_start_where_a_picture_is_wanted(wanted, needed):
    assert kinds(wanted) == needed


def test_the_3d_process_starts_where_it_may_have_something_to_draw():
    with Painters() as painters:
        painters.expect(["curvature.png", "report.html"])
        assert list(painters._processes) == ["flat"]
        painters.expect(["deviation.png", "tooth.png"])
        assert list(painters._processes) == ["flat", "solid"]


def test_the_command_takes_names_with_commas(tmp_path, capsys, monkeypatch):
    settings = [a for s in (*SMALL, "metrology.convergence=[]") for a in ("--set", s)]
    command = ["run", "spiral-bevel-flank", "--out", str(tmp_path), *settings]
    assert main([*command, "--only", "report.json, program.nc"]) == 0
    assert {f.name for f in tmp_path.iterdir()} == {"report.json", "program.nc"}
    assert f"files: {tmp_path}" in capsys.readouterr().out
    with monkeypatch.context() as patched:
        patched.setattr("gearsim.processes.run.run_job", lambda *_, **__: pytest.fail("it cuts before it looks"))
        assert main([*command, "--only", "sample.parquet"]) == 2
    assert "--only sample.parquet: no file of this run has that name; there are" in capsys.readouterr().err
    assert {f.name for f in tmp_path.iterdir()} == {"report.json", "program.nc"}
    with pytest.raises(SystemExit):
        main([*command, "--only", "report.json,"])
