import json
import re
import subprocess
import sys

import pytest

from gearsim.cli import main
from gearsim.programs.cldata import CLPath, assemble, format_cl
from gearsim.scene import load_scene, scene_names
from gearsim.toolpaths.flank import FlankPath
from tests.output.conftest import SMALL

QUICK = [a for s in (*SMALL, "metrology.convergence=[]") for a in ("--set", s)]


def run(*arguments):
    return main([str(a) for a in arguments])


def test_scenes_are_listed_one_a_line(capsys):
    assert run("scenes") == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(scene_names())
    assert all(len(line.split(maxsplit=1)[1]) > 20 for line in lines)


def test_a_scene_within_tolerance_ends_with_0_and_the_figures(tmp_path, capsys):
    assert run("run", "spiral-bevel-flank", "--out", tmp_path, *QUICK) == 0
    out = capsys.readouterr().out
    for word in (
        "convex: own pass",
        "concave: program",
        "Two roads agree to",
        "pairs/s",
        "verdict: pass: every",
        "stock is left",
    ):
        assert word in out
    assert (tmp_path / "report.json").exists()


def test_the_published_scene_ends_with_1_and_the_finding(tmp_path, capsys):
    assert run("run", "spiral-bevel-flank-zhou", "--no-pictures", "--out", tmp_path, *QUICK) == 1
    out = capsys.readouterr().out
    assert "FAILS cross_cut" in out
    assert "-11" in out


def test_a_tolerance_out_of_reach_fails(tmp_path):
    tight = ("--set", "metrology.tolerance_um=0.01")
    assert run("run", "spiral-bevel-flank", "--no-pictures", "--out", tmp_path, *QUICK, *tight) == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "nosuch"], "no scene named 'nosuch'"),
        (["run", "spiral-bevel-flank", "--set", "metrology.rows=1"], "metrology.rows: got 1"),
        (["run", "spiral-bevel-flank", "--set", "cutter.bottom_radius_mm=2.5"], "cannot pass between the tip edges"),
        (["run", "spiral-bevel-flank", "--out", "/dev/null/out"], "cannot write into output folder /dev/null/out"),
        (["run", "spiral-bevel-flank", "--device", "tpu"], "no device 'tpu'; this machine has cpu"),
        (["run", "spiral-bevel-flank", "--set", "surface.lengthwise_radius_mm=8"], "lengthwise circle of radius"),
        (["new", "x", "--like", "nosuch"], "no such built-in scene"),
        (["bench", "nosuch"], "no benchmark suite 'nosuch'; there are removal"),
    ],
)
def test_bad_input_is_one_clear_message_and_exit_code_2(arguments, message, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(*arguments) == 2
    captured = capsys.readouterr()
    assert message in captured.err
    assert "Traceback" not in captured.err
    assert captured.err.startswith("gearsim: ")
    assert not list(tmp_path.rglob("report.*"))


def test_a_full_memory_is_one_clear_message(tmp_path, monkeypatch, capsys):
    def full(*args, **kwargs):
        raise RuntimeError("Failed to allocate 9 bytes on device 'cpu'")

    monkeypatch.setattr("warp.zeros", full)
    assert run("run", "spiral-bevel-flank", "--out", tmp_path, *QUICK) == 2
    assert "out of memory; lower metrology.rows" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_four_mistakes_are_told_at_once(tmp_path, capsys):
    mistakes = ["surface.teeth=-3", "surface.colour=1", 'cutter.kind="saw"', "metrology.rows=0.5"]
    assert run("run", "spiral-bevel-flank", *[a for m in mistakes for a in ("--set", m)]) == 2
    err = capsys.readouterr().err
    assert "4 mistakes" in err
    assert all(word in err for word in ("surface.teeth", "surface.colour", "cutter.kind", "metrology.rows"))


def test_a_dry_run_cuts_nothing(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run("run", "spiral-bevel-flank", "--dry-run") == 0
    out = capsys.readouterr().out
    assert all(word in out for word in ("rays", "segments", "MB", "nothing was cut"))
    assert not list(tmp_path.iterdir())


def test_new_writes_a_scene_that_runs_and_never_overwrites(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run("new", "mine") == 0
    scene, _ = load_scene(tmp_path / "mine.toml")
    assert scene.name == "mine"
    assert run("run", "mine.toml", "--dry-run") == 0
    assert run("new", "mine") == 2
    assert "exists already" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["mine.toml", "mine"])
def test_new_takes_a_suffix_once(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run("new", name) == 0
    assert [f.name for f in tmp_path.iterdir()] == ["mine.toml"]
    assert load_scene("mine.toml")[0].name == "mine"


@pytest.mark.parametrize("name", ["", "..", 'a"b', "a\\b", "a\0b", "spur-external", "spur-external.toml"])
def test_new_refuses_what_is_no_name_or_another_scene_s(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run("new", name) == 2
    assert capsys.readouterr().err.startswith("gearsim: new ")
    assert not list(tmp_path.iterdir())


def test_a_built_in_scene_beside_a_file_of_its_name_says_so(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run("run", "gouge-sizes", "--dry-run") == 0
    assert capsys.readouterr().err == ""
    for file in ("gouge-sizes", "gouge-sizes.toml"):
        (tmp_path / file).write_text("")
        assert run("run", "gouge-sizes", "--dry-run") == 0
        assert f"this is the built-in scene; the file is run by ./{file}\n" in capsys.readouterr().err


def test_a_device_that_is_not_there_is_told_before_anything_is_planned(monkeypatch, capsys):
    monkeypatch.setattr("gearsim.processes.run.plan", None)
    for device in ("tpu", "cuda:99", "cpu:1", ""):
        assert run("run", "spur-external", "--device", device, "--out", "nowhere") == 2
        assert f"no device {device!r}; this machine has cpu" in capsys.readouterr().err


@pytest.fixture
def own_scene(tmp_path):
    """A user's scene with a CL file instead of our planner."""
    scene, _ = load_scene("spiral-bevel-flank")
    tooth, cutter = scene.tooth(), scene.tool()

    def make(change=lambda text: text, share=1.0, retract=15.0):
        motions = [(side, FlankPath(tooth, side, cutter, 6.0).cl_motion(33)) for side in ("convex", "concave")]
        n = round(share * len(motions[0][1].tips))
        program = assemble([CLPath(side, m.tips[:n], m.axes[:n]) for side, m in motions], retract, cutter)
        (tmp_path / "my.cl").write_text(change(format_cl(program, "mine", 600.0, 9)))
        assert main(["new", str(tmp_path / "mine")]) == 0
        text = (tmp_path / "mine.toml").read_text()
        head, tail = text.split("[toolpath]")
        (tmp_path / "mine.toml").write_text(
            head + '[toolpath]\nfile = "my.cl"\n\n[simulation]' + tail.split("[simulation]")[1]
        )
        return tmp_path / "mine.toml"

    return make


QUICK_FILE = [a for s in SMALL[:4] for a in ("--set", s)]


def test_a_users_cl_file_is_cut_and_measured(own_scene, tmp_path, capsys):
    assert run("run", own_scene(), "--out", tmp_path / "out", *QUICK_FILE, "--set", "metrology.tolerance_um=20") == 0
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    flank = report["measurements"]["concave"]
    assert set(flank) == {"own_pass", "program"}
    assert flank["own_pass"]["dense_grid"]["envelope_gap_um"]["max"] < 1e-3
    assert set(flank["own_pass"]) == {"dense_grid", "inspection_grid", "mean_profile"}
    assert "concave: own pass" in capsys.readouterr().out


def test_a_cl_file_without_pass_names_is_one_pass_for_both_flanks(own_scene, tmp_path):
    scene = own_scene(lambda text: text.replace("PPRINT PASS convex", "").replace("PPRINT PASS concave", ""))
    options = (*QUICK_FILE, "--no-pictures", "--set", "metrology.tolerance_um=20")
    assert run("run", scene, "--out", tmp_path / "out", *options) == 0


def findings(folder):
    report = json.loads((folder / "report.json").read_text())
    return report["verdict"], {f["kind"]: f for f in report["findings"]}


def test_passes_that_end_half_way_leave_uncut_samples_and_fail(own_scene, tmp_path):
    assert run("run", own_scene(share=0.5), "--out", tmp_path / "out", *QUICK_FILE) == 1
    verdict, found = findings(tmp_path / "out")
    assert verdict == "fail"
    assert found["uncut"]["fails"]
    assert found["uncut"]["depth_um"] > 100.0


def test_rapid_moves_through_material_are_found(own_scene, tmp_path):
    assert run("run", own_scene(retract=2.0), "--no-pictures", "--out", tmp_path / "out", *QUICK_FILE) == 1
    _, found = findings(tmp_path / "out")
    assert found["rapid_cut"]["fails"]


@pytest.mark.filterwarnings("error")
def test_a_program_that_misses_the_blank_is_unchecked_and_says_so(own_scene, tmp_path, capsys):
    def away(text):
        return re.sub(r"(GOTO|FROM)/([-\d.]+)", lambda m: f"{m[1]}/{float(m[2]) + 500.0:.9f}", text)

    assert run("run", own_scene(away), "--out", tmp_path / "out", *QUICK_FILE) == 3
    said = capsys.readouterr().out
    for surface in ("convex under program", "concave under program", "the convex fillet", "the bottom"):
        assert f"no operation touches {surface}" in said
    verdict, found = findings(tmp_path / "out")
    assert verdict == "unchecked"
    assert found["uncut"]["depth_um"] > 2000.0
    assert (tmp_path / "out" / "deviation.png").exists()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t.replace("GOTO/", "GOTO/nan,", 1), "my.cl, line"),
        (lambda t: t.replace("UNITS/MM", "UNITS/CUBITS"), "expected UNITS/MM or UNITS/INCHES"),
        (lambda t: t.replace("CUTTER/", "CUTTER/9,1,3.5,1,0,0,20 $$", 1), "my.cl is for CUTTER/9, 1, 3.5, 1, 0, 0, 20"),
        (lambda t: "", "no cutting moves"),
    ],
)
def test_a_broken_cl_file_is_refused(own_scene, change, message, capsys):
    assert run("run", own_scene(change), *QUICK_FILE) == 2
    err = capsys.readouterr().err
    assert message in err
    assert "Traceback" not in err


def test_help_teaches(capsys):
    for arguments in (["--help"], ["run", "--help"]):
        with pytest.raises(SystemExit) as stop:
            main(arguments)
        assert stop.value.code == 0
    out = capsys.readouterr().out
    assert "exit codes:" in out
    assert "gearsim run my.toml --out results" in out


def test_the_module_runs_as_a_command():
    done = subprocess.run(
        [sys.executable, "-m", "gearsim.cli", "--version"], capture_output=True, text=True, check=True
    )
    assert done.stdout.startswith("gearsim ")


def test_public_names_are_there():
    import gearsim

    assert callable(gearsim.run)
    assert "spiral-bevel-flank" in gearsim.scene_names()
    with pytest.raises(AttributeError, match="no attribute 'nosuch'"):
        _ = gearsim.nosuch


@pytest.mark.parametrize("formats", ["jpg", "svg,png", "SVG"])
def test_charts_are_drawn_in_formats_of_papers_alone(formats, capsys):
    with pytest.raises(SystemExit) as stop:
        run("run", "spiral-bevel-flank", "--figures", formats)
    assert stop.value.code == 2
    assert "argument --figures: expected svg or pdf, with commas between, got" in capsys.readouterr().err


def test_the_command_that_new_tells_can_be_pasted(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run("new", "my gear") == 0
    assert capsys.readouterr().out == "wrote my gear.toml; edit it, then: gearsim run 'my gear.toml'\n"
