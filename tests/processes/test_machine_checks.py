"""Machines with bodies, limits and speeds in scenes: injected faults fail the run, touches do not; none is silent."""

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.metrology.axis_check import AxisInspection
from gearsim.metrology.body_check import BodyInspection
from gearsim.metrology.inspection import perform
from gearsim.output.report import report_text
from gearsim.output.summary import summary
from gearsim.processes.run import plan, run
from gearsim.scene import check_scene, load_scene, scene_table
from gearsim.simulation.workshop import Workshop

FLANK = ("metrology.rows=3", "metrology.columns=5", "metrology.convergence=[]", "simulation.dexel_pitch_mm=1.5")
HELD = {"sections_mm": [[30.0, 30.0, 40.0]]}


def drilled(**machine):
    """The plate with its holes on a machine: the mill's slot runs in at x = -4, 1 mm under the plate's table's top."""
    tables = scene_table(load_scene("drill-grid")[0])
    tables["stock"]["pitch_mm"] = 2.0
    tables["machine"] = {"kind": "table-table-bc", **machine}
    return tables


def box(lower, upper):
    return {"shape": {"kind": "block", "lower_mm": lower, "upper_mm": upper}}


def kinds(result):
    return sorted((f.kind, f.patch) for f in result.findings if f.fails)


def report(result):
    return report_text(result, summary(result) | {"not_drawn": []}, {}, [])


def test_what_is_touched_exactly_and_kept_exactly_passes():
    """Drills stop on the table; the mill starts where the clamp ends; Z and X are at their limits, X at its speed."""
    tables = drilled(
        table=[box([-50.0, -50.0, -40.0], [110.0, 90.0, -14.0])],
        fixture=[box([-30.0, -10.0, -12.0], [-6.0, 50.0, 4.0])],
        limits={"X": [-4.0, 64.0], "Z": [-14.0, 100.0]},
        max_feed={"X": 400.0, "Z": 400.0},
    )
    result = run(check_scene(tables, "x"))
    assert (result.verdict, kinds(result)) == ("pass", [])
    text = report(result)
    assert (
        "Unchecked: travel of Y, B, C: machine.limits names none; speed of Y, B, C: machine.max_feed names none" in text
    )
    assert "no table" not in text


def test_injected_faults_fail_the_run_each_by_its_name():
    """A table a tenth too high, a clamp a tenth in the way, an axis and a speed beyond what they may."""
    tables = drilled(
        table=[box([-50.0, -50.0, -40.0], [110.0, 90.0, -13.9])],
        fixture=[box([-30.0, -10.0, -12.0], [-5.9, 50.0, 4.0])],
        limits={"Z": [-13.999, 100.0]},
        max_feed={"X": 399.0},
        spindle_nose_mm=[[80.0, 80.0, 50.0]],
    )
    tables["tools"][2]["holder"] = {"sections_mm": [[10.0, 10.0, 1.0]]}
    result = run(check_scene(tables, "x"))
    assert (result.verdict, result.exit_code) == ("fail", 1)
    assert kinds(result) == [
        ("axis_limit", "machine"), ("axis_speed", "machine"), ("machine_hit", "fixture"), ("machine_hit", "table"),
    ]  # fmt: skip
    told = {f.patch: f for f in result.findings if f.kind == "machine_hit"}
    assert "the cutter of through holes hits the table in move" in told["table"].text
    assert "it goes 0.1 mm deep into it" in told["table"].text
    assert told["table"].place_mm == pytest.approx((10.0, 8.0, -14.0), abs=1e-6)
    assert "the cutter of slot hits the fixture in move" in told["fixture"].text
    for finding in told.values():
        assert finding.text in result.headline
        assert finding.text in report(result)


def test_where_nothing_is_named_it_is_said_that_nothing_was_looked_at():
    result = run("drill-grid", overrides=("stock.pitch_mm=2.0",))
    text, told = report(result), summary(result)["measurements"]["part"]["program"]
    assert "Unchecked: no table, no fixture, no spindle nose is named" in text
    assert "Unchecked: travel and speed of axes: no machine is named" in text
    assert told["machine_bodies"]["unchecked"] == [
        "table", "fixture", "spindle nose",
        *(f"above the flutes: {o}" for o in ("through holes", "blind holes", "slot")),
    ]  # fmt: skip
    assert told["machine_axes"]["unchecked"] == ["travel and speed of axes: no machine is named"]


def looked(job, kind):
    (asked,) = (i for i in job.inspections if isinstance(i, kind))
    return perform(asked.steps(job), Workshop("cpu"))


def test_a_bevel_gear_lies_on_its_back_on_the_table_of_its_program():
    """The gear frame's -z is up; a nose of 300 mm over a slim tool comes down to a clamp beside the gear."""
    shape = '{kind="block", lower_mm=[60.0, -120.0, -60.0], upper_mm=[200.0, 120.0, 90.0]}'
    clamp = f"program.machine.fixture=[{{shape={shape}}}]"
    faults = ("program.machine.limits={B=[-1.0, 1.0]}", "program.machine.max_feed={C=1.0}", clamp)
    job = plan(*load_scene("spiral-bevel-flank", (*FLANK, *faults[1:])))
    found = looked(job, BodyInspection).findings
    assert [f.patch for f in found] == ["fixture"]
    assert found[0].place_mm[0] >= 60.0
    assert "in the move of line" in found[0].text
    assert {f.kind for f in looked(job, AxisInspection).findings} == {"axis_speed"}
    with pytest.raises(InputError, match="axis B overruns its limit"):
        plan(*load_scene("spiral-bevel-flank", (*FLANK, faults[0])))


def test_programs_from_files_are_held_against_travel_and_bodies_where_they_are_mounted(tmp_path):
    """A G-code line 0.001 deg beyond a limit; a fixture under it, seen in the part's frame by the mounting."""
    (tmp_path / "own.nc").write_text(
        "%\nO1\nG21 G17 G90 G94 G54\nT1 M6\nG43 H1\nG0 X0. Y0. Z300. B0. C0.\nG1 Z120. B30.001 F500.\nG1 X5.\nM30\n%\n"
    )
    tables = scene_table(load_scene("spur-external")[0])
    own = {name: tables[name] for name in ("scene", "surface", "tools")}
    own["machine"] = {
        "kind": "table-table-bc",
        "limits": {"B": [-30.0, 30.0]},
        "fixture": [box([-9.0, -9.0, 80.0], [9.0, 9.0, 121.0])],
    }
    mounting = {"origin_mm": [0.0, 0.0, 50.0]}
    own |= {"metrology": {"tolerance_um": 1.0}, "toolpath": {"kind": "program", "file": "own.nc", "mounting": mounting}}
    own["control"] = {"unstated_is_zero": True}
    job = plan(check_scene(own, "own"), tmp_path)
    (axis,) = looked(job, AxisInspection).findings
    assert axis.text.startswith("axis B goes to 30.001 deg, 0.001 deg beyond its limit of 30 deg, in line 7")
    assert looked(job, BodyInspection).measurements[0].looks[0].rows > 0
    (asked,) = (i for i in job.inspections if isinstance(i, BodyInspection))
    assert np.array_equal(asked.frame.translation, [0.0, 0.0, 50.0])


@pytest.mark.parametrize(
    ("machine", "message"),
    [
        ({"max_feed": {"Q": 1.0}}, "machine.max_feed: no axis Q; table-table-bc has X, Y, Z, B, C"),
        ({"limits": {"Q": [0.0, 1.0]}}, "has no axis Q"),
        ({"fixture": [box([0.0, 0.0, 0.0], [0.0, 1.0, 1.0])]}, "every upper coordinate must be the larger"),
        ({"fixtures": []}, "machine.fixtures: unknown key; did you mean 'fixture'"),
        ({"spindle_nose_mm": [[1.0, 2.0]]}, "machine.spindle_nose_mm.0"),
    ],
)
def test_what_is_no_machine_is_refused(machine, message):
    with pytest.raises(InputError, match=message):
        plan(check_scene(drilled(**machine), "x"))


def test_flutes_and_noses_are_refused_where_nothing_looks_at_them():
    with pytest.raises(InputError, match=r"cutter\.flute_length_mm: unknown key"):
        load_scene("spiral-bevel-face-milled", ("cutter.flute_length_mm=6",))
    with pytest.raises(InputError, match=r"machine\.spindle_nose_mm: unknown key"):
        load_scene("apt-envelope", ("machine.spindle_nose_mm=[[6.0, 6.0, 6.0]]",))


def test_a_mill_whose_flutes_are_too_short_is_found_without_a_holder():
    """A slot 3 mm deep by a mill whose flutes end 2 mm over its tip."""
    tables = drilled()
    tables["tools"][2]["cutter"]["flute_length_mm"] = 2.0
    result = run(check_scene(tables, "x"))
    told = [f for f in result.findings if f.kind == "holder_cut"]
    assert [f.text.split(" in move")[0] for f in told] == ["the upper part of slot touches material"]
    assert "it cuts 1 mm deep" in told[0].text
