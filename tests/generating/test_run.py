"""Generating scenes end to end on small grids: closed form, both roads, motions beside, files, exit codes."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenEXR
import pyarrow.parquet as pq
import pytest

from gearsim import generating
from gearsim.cli import main
from gearsim.envelope import EnvelopePatch
from gearsim.geometry.rigid import Rigid
from gearsim.metrology.machine import MeasuringMachine
from gearsim.motion.sources import MovedMotion
from gearsim.programs.axis_table import parse_axis_table
from gearsim.runner import run
from gearsim.scene import check_scene, load_scene

SMALL = ("metrology.rows=3", "metrology.columns=5", "metrology.convergence=[]", "simulation.dexel_pitch_mm=1.5")
NAMES = (
    "apt-envelope",
    "flat-end-envelope",
    "spiral-bevel-face-milled",
    "spiral-bevel-formate",
    "hypoid-pinion-phoenix",
)


@pytest.fixture(scope="module", params=NAMES)
def result(request):
    return run(request.param, overrides=SMALL)


def test_every_scene_reproduces_its_own_closed_form_by_both_roads(result):
    assert (result.verdict, result.exit_code, result.findings) == ("pass", 0, ())
    for cut in result.cuts:
        own = next(iter(cut.sources))
        for surface in cut.surfaces.values():
            measured = surface.deviations[own].value[surface.measurable]
            assert surface.measurable.sum() > 0.6 * surface.measurable.size
            assert 1e3 * np.abs(measured).max() < 1e-4
            assert all(gap.max_um < 1e-4 and gap.disagree == 0 for gap in surface.gaps.values())
    if result.dexels is not None:
        assert result.dexels.checked > 50
        assert result.dexels.check_um < 1e-3


def test_a_sampled_roll_costs_what_its_steps_cost():
    """Steps of half the size cost a quarter, on both machines."""
    result = run("hypoid-pinion-phoenix", overrides=(*SMALL, "metrology.convergence=[9, 17, 33]"))
    for surface in result.surfaces.values():
        assert set(surface.convergence) == {"phoenix", "star"}
        for c in surface.convergence.values():
            assert np.mean(c.orders) == pytest.approx(2.0, abs=0.2)  # few samples: single orders scatter
    worst = max(c.worst_um[0] for s in result.surfaces.values() for c in s.convergence.values())
    assert 20.0 < worst < 80.0


def test_what_each_interpolation_adds_to_an_nc_step():
    """All motions meet in both ends of the step; CL data stay closest to the guided lines (test_nc_step)."""
    result = run("flat-end-envelope", overrides=SMALL)
    for surface in result.surfaces.values():
        size = {name: np.nanmax(np.abs(d.value)) for name, d in surface.deviations.items()}
        assert size["theory"] < 1e-7 < size["cl"] < 0.01 < size["tcp"] < size["linear"]
        tcp = np.abs(surface.deviations["tcp"].value)
        assert tcp[:, [0, -1]].max() < 0.1 * tcp[:, 2].max()


def test_a_wrong_closed_form_is_not_trusted():
    """The other branch under the name of this one: the motion removes nothing near it, or something else."""
    scene, folder = load_scene("flat-end-envelope", SMALL)
    job = generating.plan(scene, folder)
    (cut,) = job.cuts
    lie = replace(cut, patches=tuple(_shifted(p) for p in cut.patches))
    wrong = generating.measure(replace(job, cuts=(lie,)), lambda c: MeasuringMachine(c, "cpu", 1e-9, 16), "cpu")
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
    assert (report["verdict"], report["schema_version"]) == ("fail", 1)
    found = {(f["kind"], f["patch"]) for f in report["findings"] if f["fails"]}
    assert ("out_of_tolerance", "concave") in found
    assert report["flanks"]["concave"]["motions"]["roll"]["deviation_um"]["max"] < 1e-4
    assert report["flanks"]["concave"]["motions"]["phoenix"]["envelope_gap_um"]["max"] < 1e-3
    assert set(report["motions"]) == {"roll", "phoenix", "star"}
    assert "pinion frame" in report["conventions"]["frame"]


def test_files_hold_every_surface_and_the_tables_that_were_simulated(folder):
    names = {f.name for f in folder.iterdir()}
    assert {"report.html", "report.md", "deviation.png", "axes.png", "samples.parquet", "tooth.vtp"} <= names
    with OpenEXR.File(str(folder / "deviation.exr"), separate_channels=True) as exr:
        assert [p.name() for p in exr.parts] == ["concave", "concave fillet", "bottom", "convex fillet", "convex"]
        channels = exr.parts[0].channels
        assert {"deviation.um", "P.X", "N.Z", "valid", "roll.deviation_um", "star.deviation_um"} <= set(channels)
        assert channels["deviation.um"].pixels.shape == (3, 5)
    table = pq.read_table(folder / "samples.parquet")
    assert table.num_rows == 5 * 15
    assert not any(table["missing"].to_pylist())
    scene, _ = load_scene("hypoid-pinion-phoenix", SMALL)
    (cut,) = generating.plan(scene, Path()).cuts
    for name, machine in scene.machines().items():
        read = parse_axis_table((folder / f"axes-{name}.csv").read_text(), machine)
        assert np.array_equal(read.values, cut.sources[name].values)


@pytest.mark.parametrize("name", ["flat-end-envelope", "spiral-bevel-formate"])
def test_a_scene_that_judges_no_motion_is_unchecked_and_says_so(name, tmp_path, capsys):
    options = [a for s in (*SMALL, "metrology.judged=[]") for a in ("--set", s)]
    assert main(["run", name, "--out", str(tmp_path / "out"), *options]) == 3
    assert "verdict: unchecked: metrology.judged names no motion" in capsys.readouterr().out
    assert "**UNCHECKED**: metrology.judged names no motion" in (tmp_path / "out" / "report.md").read_text()


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
    job = generating.plan(scene, folder)
    (cut,) = job.cuts
    away = MovedMotion(cut.sources["cl"], Rigid(np.eye(3), np.array([0.0, 0.0, 500.0])))
    lifted = replace(cut, sources={**cut.sources, "cl": away})
    judged = scene.model_copy(update={"metrology": scene.metrology.model_copy(update={"judged": ("theory", "cl")})})
    job = replace(job, scene=judged, cuts=(lifted,))
    result = generating.measure(job, lambda c: MeasuringMachine(c, "cpu", 1e-9, 16), "cpu")
    assert (result.verdict, result.exit_code) == ("unchecked", 3)
    assert "no operation touches left under the motion cl" in result.status


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
