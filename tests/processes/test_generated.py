"""Generating scenes end to end on small grids: closed form, both roads, motions beside, files, exit codes."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenEXR
import pyarrow.parquet as pq
import pytest

from gearsim.cli import main
from gearsim.envelope import EnvelopePatch
from gearsim.geometry.rigid import Rigid
from gearsim.metrology.grid import grids
from gearsim.motion.sources import MovedMotion
from gearsim.processes.run import plan, run, run_job
from gearsim.programs.axis_table import parse_axis_table
from gearsim.scene import check_scene, load_scene
from gearsim.simulation.operation import operation

SMALL = ("metrology.rows=3", "metrology.columns=5", "metrology.convergence=[]", "simulation.dexel_pitch_mm=1.5")
NAMES = (
    "apt-envelope",
    "flat-end-envelope",
    "spiral-bevel-face-milled",
    "spiral-bevel-formate",
    "hypoid-pinion-phoenix",
)


def dense(result):
    return grids(list(result.measurements.values()))


@pytest.fixture(scope="module", params=NAMES)
def result(request):
    return run(request.param, overrides=SMALL)


def test_every_scene_reproduces_its_own_closed_form_by_both_roads(result):
    assert (result.verdict, result.exit_code, result.findings) == ("pass", 0, ())
    own = {i.surface: i.generating for i in result.job.inspections if hasattr(i, "generating")}
    found = dense(result)
    assert {surface for surface, _ in found} == set(own)
    for (surface, variant), m in found.items():
        assert m.gap.max_um < 1e-4
        assert m.gap.disagree == 0
        assert m.measurable.sum() > 0.6 * m.measurable.size
        if variant == own[surface]:
            assert 1e3 * np.abs(m.deviation.value[m.measurable]).max() < 1e-4
    witnesses = [m for key, m in result.measurements.items() if key[2] == "tri-dexel"]
    assert len(witnesses) == (result.job.part.stock is not None)
    for dexels in witnesses:
        assert dexels.checked > 50
        assert dexels.check_um < 1e-3


def test_rows_of_a_machine_s_motion_know_their_line_of_its_table():
    job = plan(load_scene("hypoid-pinion-phoenix", (*SMALL, "toolpath.rows=9"))[0])
    (phoenix,), (roll,) = (job.variant(name).operations for name in ("phoenix", "roll"))
    np.testing.assert_array_equal(phoenix.line, phoenix.table.piece + 3)  # behind the names and the first block
    assert len(job.files["axes-phoenix.csv"].splitlines()) == phoenix.line.max()
    assert not roll.line.any()


def test_a_sampled_roll_costs_what_its_steps_cost():
    """Steps of half the size cost a quarter, on both machines."""
    result = run("hypoid-pinion-phoenix", overrides=(*SMALL, "metrology.convergence=[9, 17, 33]"))
    found = {key[:2]: m.convergence for key, m in result.measurements.items() if key[2] == "convergence"}
    assert set(found) == {(s, name) for s in result.job.part.surfaces for name in ("phoenix", "star")}
    for c in found.values():
        assert np.mean(c.orders) == pytest.approx(2.0, abs=0.2)  # few samples: single orders scatter
    worst = max(c.worst_um[0] for c in found.values())
    assert 20.0 < worst < 80.0


def test_what_each_interpolation_adds_to_an_nc_step():
    """All motions meet in both ends of the step; CL data stay closest to the guided lines (test_nc_step)."""
    result = run("flat-end-envelope", overrides=SMALL)
    for side in result.job.part.surfaces:
        found = {name: m.deviation for (surface, name), m in dense(result).items() if surface == side}
        size = {name: np.nanmax(np.abs(d.value)) for name, d in found.items()}
        assert size["theory"] < 1e-7 < size["cl"] < 0.01 < size["tcp"] < size["linear"]
        tcp = np.abs(found["tcp"].value)
        assert tcp[:, [0, -1]].max() < 0.1 * tcp[:, 2].max()


def test_a_wrong_closed_form_is_not_trusted():
    """The other branch under the name of this one: the motion removes nothing near it, or something else."""
    scene, folder = load_scene("flat-end-envelope", SMALL)
    job = plan(scene, folder)
    lies = {name: replace(s, patch=_shifted(s.patch)) for name, s in job.part.surfaces.items()}
    wrong = run_job(replace(job, part=replace(job.part, surfaces=lies)))
    assert (wrong.verdict, wrong.exit_code) == ("unchecked", 3)
    assert "differs from what its own motion removes by 10" in wrong.status


def _shifted(patch):
    """The patch of a tool whose profile stands 10 um proud, under the same motion."""

    def proud(point):
        return (point[0] + 0.01 * (point[0] > 0.0), point[1])

    elements = tuple(replace(e, start=proud(e.start), end=proud(e.end)) for e in patch.cutter.elements)
    cutter = replace(patch.cutter, elements=elements)
    return EnvelopePatch(patch.name, patch.source, cutter, patch.elements, patch.branch, patch.window)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    out = tmp_path_factory.mktemp("hypoid")
    options = [a for s in (*SMALL, "metrology.tolerance_um=0.1") for a in ("--set", s)]
    assert main(["run", "hypoid-pinion-phoenix", "--out", str(out), *options]) == 1
    return Path(out)


def test_a_judged_motion_out_of_tolerance_fails_and_says_where(folder):
    report = json.loads((folder / "report.json").read_text())
    assert (report["verdict"], report["schema_version"]) == ("fail", 2)
    found = {(f["kind"], f["patch"]) for f in report["findings"] if f["fails"]}
    assert ("out_of_tolerance", "concave") in found
    concave = report["measurements"]["concave"]
    assert concave["roll"]["dense_grid"]["deviation_um"]["max"] < 1e-4
    assert concave["phoenix"]["dense_grid"]["envelope_gap_um"]["max"] < 1e-3
    assert set(report["variants"]) == {"roll", "phoenix", "star"}
    assert report["program"] == "star"
    assert "pinion frame" in report["conventions"]["frame"]


def test_files_hold_every_surface_and_the_tables_that_were_simulated(folder):
    names = {f.name for f in folder.iterdir()}
    assert {"report.html", "report.md", "deviation.png", "axes.png", "samples.parquet", "tooth.vtp"} <= names
    with OpenEXR.File(str(folder / "deviation.exr"), separate_channels=True) as exr:
        assert [p.name() for p in exr.parts] == [
            "preview",
            "concave",
            "concave fillet",
            "bottom",
            "convex fillet",
            "convex",
        ]
        channels = exr.parts[1].channels
        assert {"deviation.um", "P.X", "N.Z", "valid", "roll.deviation.um", "star.gap.um"} <= set(channels)
        assert channels["deviation.um"].pixels.shape == (3, 5)
    table = pq.read_table(folder / "samples.parquet")
    assert table.num_rows == 5 * 15
    assert not any(table["missing"].to_pylist())
    scene, _ = load_scene("hypoid-pinion-phoenix", SMALL)
    job = plan(scene)
    for name, machine in scene.machines().items():
        read = parse_axis_table((folder / f"axes-{name}.csv").read_text(), machine)
        assert np.array_equal(read.values, job.variant(name).motions()[0].values)


@pytest.mark.parametrize("name", ["flat-end-envelope", "spiral-bevel-formate"])
def test_a_scene_that_judges_no_motion_is_unchecked_and_says_so(name, tmp_path, capsys):
    options = [a for s in (*SMALL, "metrology.judged=[]") for a in ("--set", s)]
    assert main(["run", name, "--out", str(tmp_path / "out"), *options]) == 3
    assert "verdict: unchecked: nothing was judged" in capsys.readouterr().out
    assert "**UNCHECKED**: nothing was judged" in (tmp_path / "out" / "report.md").read_text()


@pytest.mark.parametrize(("judged", "rest"), [("theory", "cl, tcp, linear"), ("theory,cl,tcp,linear", "")])
def test_motions_that_are_not_judged_are_named_in_the_verdict(judged, rest):
    scene, folder = load_scene("apt-envelope", SMALL)
    names = tuple(judged.split(","))
    chosen = scene.metrology.model_copy(update={"judged": names})
    result = run(scene.model_copy(update={"metrology": chosen}), folder=folder)
    assert ("not judged: " in result.headline) == bool(rest)
    assert f"not judged: {rest}" in result.headline or not rest


def test_judged_may_be_left_out_and_is_unchecked_too():
    scene, folder = load_scene("flat-end-envelope", SMALL)
    tables = scene.model_dump(exclude_none=True)
    del tables["metrology"]["judged"]
    result = run(check_scene(tables, "s"), folder=folder)
    assert (result.verdict, result.exit_code) == ("unchecked", 3)


def test_a_judged_motion_that_the_scene_lacks_is_refused_with_the_nearest(capsys):
    assert main(["run", "flat-end-envelope", "--set", 'metrology.judged=["teory"]']) == 2
    assert "metrology.judged: got 'teory'" in (err := capsys.readouterr().err)
    assert "did you mean 'theory'?" in err


def test_a_judged_motion_that_touches_nothing_is_unchecked():
    scene, folder = load_scene("flat-end-envelope", SMALL)
    judged = scene.model_copy(update={"metrology": scene.metrology.model_copy(update={"judged": ("theory", "cl")})})
    job = plan(judged, folder)
    cl = job.variant("cl")
    away = MovedMotion(cl.motions()[0], Rigid(np.eye(3), np.array([0.0, 0.0, 500.0])))
    lifted = replace(cl, operations=(operation("cl", cl.cutter, [away], 1e-9),))
    result = run_job(job.under({"cl": lifted}))
    assert (result.verdict, result.exit_code) == ("unchecked", 3)
    assert "no operation touches left under cl" in result.status


def test_a_dry_run_and_bad_tables_of_generating_scenes(capsys):
    assert main(["run", "spiral-bevel-face-milled", "--dry-run"]) == 0
    assert "rays" in capsys.readouterr().out
    for override, message in (
        ("cutter.point_width_mm=0.5", "face-mill head"),
        ("generator.cradle_angle_deg=0.0", "never cuts"),
        ("surface.generatd=false", "did you mean 'generated'"),
        ('cutter.kind="ball"', "cutter.radius_mm: unknown key"),
    ):
        assert main(["run", "spiral-bevel-face-milled", "--set", override]) == 2, override
        assert message in capsys.readouterr().err
    assert main(["run", "flat-end-envelope", "--set", 'toolpath.axes=["X", "Y", "Z", "A", "C"]']) == 2
    assert "a program for head-head-cb has X, Y, Z, B, C" in capsys.readouterr().err


def test_travel_limits_are_the_owners_and_told_with_the_axis(capsys):
    limits = "machine.limits={ B = [-10.0, 10.0] }"
    assert main(["run", "flat-end-envelope", "--set", limits]) == 2
    assert "axis B overruns its limit of 10 deg from point 2 on, by 8 deg at point 2" in capsys.readouterr().err
    assert main(["run", "hypoid-pinion-phoenix", "--set", "machine.phoenix.limits={ X = [0.0, 150.0] }"]) == 2
    assert "axis X overruns its limit of 150 mm" in capsys.readouterr().err
    assert main(["run", "hypoid-pinion-phoenix", "--set", "machine.phoenix.limits={ Q = [0.0, 1.0] }"]) == 2
    assert "machine phoenix has no axis Q" in capsys.readouterr().err


@pytest.mark.parametrize(("cradle", "verdict"), [(-86.62, "pass"), (-86.51 + 1e-9, "pass"), (-86.4, "fail")])
def test_of_two_cuts_neither_may_cut_the_other_s_surfaces(cradle, verdict):
    """The convex flank's own cut, turned into the slot, next to where one cut makes both, and into the other tooth.

    A turn of 0.11 deg moves it by 0.11 deg x ratio of roll 3.77 about the axis: 0.2 mm, of which the share
    along the leaning normals is cut.
    """
    table = load_scene("hypoid-pinion-phoenix", SMALL)[0].model_dump(exclude_none=True)
    table["convex"] = {"cutter": table["cutter"], "generator": table["generator"] | {"cradle_angle_deg": cradle}}
    result = run(check_scene(table, "s"))
    assert result.verdict == verdict
    cut = {f.patch: f.depth_um for f in result.findings if f.kind == "cross_cut"}
    if verdict == "pass":
        assert cut == {}
        return
    assert set(cut) == set(result.job.part.surfaces)
    turn, radius = np.radians((cradle + 86.51) * table["generator"]["ratio_of_roll"]), 28.24
    assert all(0.5 < -um / (1e3 * turn * radius) < 1.0 for um in cut.values())
