import json

import pytest

from gearsim.cli import main
from gearsim.errors import InputError
from gearsim.output.painting import KINDS, Painters, kinds
from gearsim.output.wanted import EVERYTHING, Wanted
from gearsim.output.write import write_result
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
    assert html.count("data:image/png;base64,") == 1
    assert "report.json" not in html


def test_a_format_can_be_wanted_alone(result, tmp_path):
    assert written(result, tmp_path, Wanted(formats=("svg",), only=("inspection.svg",))) == {"inspection.svg"}


@pytest.mark.parametrize(
    ("wanted", "unknown"),
    [
        (Wanted(only=("report.json", "deviaton.png")), "deviaton.png"),
        (Wanted(only=("no*", "tooth.png")), r"no\*"),
        (Wanted(pictures=False, only=("tooth.png",)), "tooth.png"),
        (Wanted(only=("deviation.svg",)), "deviation.svg"),
    ],
)
def test_a_name_that_no_file_bears_is_refused_with_those_there_are(result, tmp_path, wanted, unknown):
    with (
        Painters(wanted) as painters,
        pytest.raises(InputError, match=rf"--only {unknown}: no file .*; there are .*deviation.exr.*toolpath.cl"),
    ):
        write_result(result, tmp_path, painters)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("wanted", "needed"),
    [
        (EVERYTHING, KINDS),
        (Wanted(pictures=False), ()),
        (Wanted(only=("report.json", "samples.parquet", "*.exr")), ()),
        (Wanted(only=("tooth.vtp",)), ("solid",)),
        (Wanted(only=("tooth.png",)), ("solid",)),
        (Wanted(only=("deviation.png",)), ("flat",)),
        (Wanted(only=("*.svg",)), ()),
        (Wanted(formats=("svg",), only=("*.svg",)), ("flat",)),
        (Wanted(only=("*",)), KINDS),
    ],
)
def test_drawing_processes_start_where_a_picture_is_wanted(wanted, needed):
    assert kinds(wanted) == needed


def test_the_command_takes_names_with_commas(tmp_path, capsys):
    settings = [a for s in (*SMALL, "metrology.convergence=[]") for a in ("--set", s)]
    command = ["run", "spiral-bevel-flank", "--out", str(tmp_path), *settings]
    assert main([*command, "--only", "report.json, program.nc"]) == 0
    assert {f.name for f in tmp_path.iterdir()} == {"report.json", "program.nc"}
    assert f"files: {tmp_path}" in capsys.readouterr().out
    assert main([*command, "--only", "sample.parquet"]) == 2
    assert "--only sample.parquet: no file of this run has that name; there are" in capsys.readouterr().err
    assert {f.name for f in tmp_path.iterdir()} == {"report.json", "program.nc"}
    with pytest.raises(SystemExit):
        main([*command, "--only", "report.json,"])
