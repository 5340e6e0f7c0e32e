"""Surfaces that a head generates, cut from files by the head and by end mills: axis values, G-code, CL data."""

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.machines.catalogue import phoenix
from gearsim.metrology.grid import COARSE, DENSE
from gearsim.metrology.program_times import ProgramMeasurement
from gearsim.processes.run import estimate, plan, run
from gearsim.programs.axis_table import parse_axis_table
from gearsim.scene import check_scene, load_scene, scene_table

FEW = ("metrology.rows=3", "metrology.columns=5", "metrology.convergence=[]", "simulation.dexel_pitch_mm=1.5")
GRID = {"rows": 3, "columns": 5, "margin": 0.01}


def dense(result, variant):
    return {s: m.deviation.value for (s, v, i), m in result.measurements.items() if (v, i) == (variant, DENSE)}


@pytest.fixture(scope="module")
def pinion(tmp_path_factory):
    """The hypoid pinion on the Phoenix: its planned run, and a scene that cuts its table of axis values."""
    folder = tmp_path_factory.mktemp("pinion")
    scene, _ = load_scene("hypoid-pinion-phoenix", FEW)
    result, tables = run(scene), scene_table(scene)
    text = result.job.files["axes-phoenix.csv"]
    (folder / "roll.csv").write_text(text)
    own = {name: tables[name] for name in ("scene", "surface", "cutter", "generator", "simulation")}
    own |= {"machine": tables["machine"]["phoenix"], "metrology": GRID | {"tolerance_um": 1.0}}
    (folder / "roll.nc").write_text(as_gcode(parse_axis_table(text, scene_machine(own))))
    return result, own, folder


def scene_machine(tables):
    return phoenix(tables["machine"]["mounting_mm"])


AROUND = ("G00 X2000.", "Z-400.")  # the head's axis leads into the gear: home, at Z 500, lies behind it


def as_gcode(table):
    """A table of axis values as G-code: around the gear, to the table's start, along it, and back."""
    machine = table.machine
    shown = table.values * np.where([j.is_rotary for j in machine.joints], 180.0 / np.pi, 1.0)

    def words(row, axes=machine.axes):
        return " ".join(f"{a}{v:.6f}" for a, v in zip(machine.axes, row, strict=True) if a in axes)

    begin = [f"G00 {words(shown[0], axes)}" for axes in ("ABC", "XY")]
    feeds = [f"G01 {words(shown[0], 'Z')} F500.", *(f"G01 {words(row)}" for row in shown[1:])]
    head = ["%", "O1", "T1 M06", "G90 G54 G94 G21", "G43 H1 Z500."]
    return "\n".join([*head, *AROUND, *begin, *feeds, "G00 Z-400.", "M30", "%", ""])


def test_a_table_of_axis_values_cuts_what_its_planned_run_cuts(pinion):
    planned, scene, folder = pinion
    own = check_scene(scene | {"toolpath": {"file": "roll.csv"}}, "own")
    result, told = run(own, folder=folder), estimate(own, folder)
    assert (result.verdict, result.exit_code, result.findings) == ("pass", 0, ())
    assert told["rays"] == result.counts["rays"] - result.counts["following_rays"]
    assert told["segments"] == result.counts["segments"]
    theirs, ours = dense(planned, "phoenix"), dense(result, "program")
    assert set(ours) == set(theirs)
    assert all(np.array_equal(ours[name], theirs[name]) for name in ours)
    for name in ours:
        for motion in ("roll", "last operation"):
            gap = result.measurements[name, motion, DENSE].gap
            assert gap.max_um < 1e-4
            assert gap.valid == 15
    assert result.measurements["", "program", "tri-dexel"].check_um < 1e-3
    assert "pinion frame" in result.frame
    assert result.measurements["convex", "program", COARSE].topography is not None


def test_gcode_for_the_head_says_the_same_and_its_times(pinion):
    planned, scene, folder = pinion
    result = run(check_scene(scene | {"toolpath": {"file": "roll.nc"}}, "own"), folder=folder)
    assert (result.verdict, result.findings) == ("pass", ())
    theirs, ours = dense(planned, "phoenix"), dense(result, "program")
    assert max(np.abs(ours[name] - theirs[name]).max() for name in ours) < 1e-8
    (program,) = (m for m in result.measurements.values() if isinstance(m, ProgramMeasurement))
    assert program.blocks >= 64 + len(AROUND) + 4
    assert sum(program.cutting_s.values()) > 0.0


def test_a_wrong_head_is_told_by_the_closed_forms_own_motion(pinion):
    """The program's head is 20 um wider than the one that the tooth is meant to be cut by."""
    _, scene, folder = pinion
    wide = scene["cutter"] | {"point_width_mm": scene["cutter"]["point_width_mm"] + 0.04}
    tables = scene | {"head": scene["cutter"], "cutter": wide, "toolpath": {"file": "roll.csv"}}
    result = run(check_scene(tables, "own"), folder=folder)
    assert (result.verdict, result.exit_code) == ("fail", 1)
    off = 1e3 * np.concatenate([dense(result, "program")[side].ravel() for side in ("convex", "concave")])
    assert off.min() > -22.0
    assert off.max() < -15.0
    assert all(1e3 * np.abs(d).max() < 1e-4 for d in dense(result, "roll").values())


@pytest.fixture(scope="module")
def milled(tmp_path_factory):
    """The conventional tooth flank-milled: its planned run, and the same tooth as a face-milled surface with a head."""
    folder = tmp_path_factory.mktemp("milled")
    decimals = ("program.linear_decimals=6", "program.rotary_decimals=6", "toolpath.points=17")
    scene, _ = load_scene("spiral-bevel-flank-conventional", (*FEW, *decimals))
    result, tables = run(scene), scene_table(scene)
    for name, text in result.job.files.items():
        (folder / name).write_text(text)
    surface = dict(tables["surface"]) | {"kind": "face-milled"}
    own = {"head": surface.pop("head"), "generator": surface.pop("generator"), "surface": surface}
    own |= {name: tables[name] for name in ("scene", "cutter", "simulation")}
    return result, own | {"metrology": GRID | {"tolerance_um": 2000.0}}, tables["program"]["machine"], folder


def test_a_face_milled_surface_is_cut_from_cl_data_by_an_end_mill(milled):
    planned, scene, _, folder = milled
    result = run(check_scene(scene | {"toolpath": {"file": "toolpath.cl"}}, "own"), folder=folder)
    assert (result.verdict, result.exit_code) == ("pass", 0)
    for side in ("convex", "concave"):
        assert np.array_equal(dense(result, "program")[side], dense(planned, "program")[side])
        assert result.measurements[side, "last operation", DENSE].gap.max_um < 1e-3
    tight = scene | {"toolpath": {"file": "toolpath.cl"}, "metrology": GRID | {"tolerance_um": 5.0}}
    assert run(check_scene(tight, "own"), folder=folder).exit_code == 1


def test_a_face_milled_surface_is_cut_from_gcode_by_an_end_mill(milled):
    """The machine's rotary axes turn linearly between 17 points: a few um beside the CL data."""
    planned, scene, machine, folder = milled
    lying = {"file": "program.nc", "mounting": {"z_axis": [0.0, 0.0, -1.0]}}
    result = run(check_scene(scene | {"toolpath": lying, "machine": machine}, "own"), folder=folder)
    assert result.verdict == "pass"
    for side in ("convex", "concave"):
        assert 1e3 * np.abs(dense(result, "program")[side] - dense(planned, "program")[side]).max() < 5.0
        assert result.measurements[side, "last operation", DENSE].gap.max_um < 1e-3


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"generator": None}, "generator: missing; its settings say which hypoid-pinion tooth"),
        ({"cutter": {"kind": "ball", "diameter_mm": 2.0, "height_mm": 9.0}}, "head: missing; the tools"),
        ({"machine": None}, "machine: missing; axis values are run by a"),
        ({"tools": [{"number": n, "diameter_mm": 2.0, "flute_length_mm": 9.0} for n in (1, 2)], "cutter": None},
         "axis values are cut with one tool"),
        ({"toolpath": {"file": "gone.csv"}}, r"cannot read axis table .*gone\.csv"),
        ({"toolpath": {"kind": "drop", "file": "roll.csv"}},
         "toolpath.kind: got 'drop'; .* 'hypoid-pinion' is cut by its own planner .no kind. or 'program'"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_refused_by_its_key(pinion, change, message):
    _, scene, folder = pinion
    tables = {k: v for k, v in (scene | {"toolpath": {"file": "roll.csv"}} | change).items() if v is not None}
    with pytest.raises(InputError, match=message):
        plan(check_scene(tables, "own"), folder)


def test_settings_of_a_head_belong_to_generated_surfaces(pinion):
    tables = scene_table(load_scene("spiral-bevel-flank")[0])
    scene = {name: tables[name] for name in ("scene", "surface", "cutter")}
    scene |= {"generator": pinion[1]["generator"], "toolpath": {"kind": "program", "file": "a.nc"}}
    scene |= {"metrology": {"tolerance_um": 1.0}, "machine": {"kind": "table-table-bc"}}
    with pytest.raises(InputError, match="generator: only face-milled and hypoid-pinion surfaces are generated"):
        check_scene(scene, "own")


@pytest.mark.parametrize("name", ["flat-end-envelope", "gouge-cases"])
def test_surfaces_of_one_motion_take_no_file_and_say_which_do(name):
    with pytest.raises(
        InputError, match="made by its scene's own motion alone; programs from a file cut ruled-bevel, "
    ):
        load_scene(name, ("toolpath.file=own.nc",))
    with pytest.raises(InputError, match=r"toolpath\.kind: got 'drop'.* 'ruled-bevel' is cut by its own planner"):
        load_scene("spiral-bevel-flank", ("toolpath.kind=drop",))
