"""Holders in scenes: where they are given they are looked at, where nothing can be done with them they are refused."""

import pytest

from gearsim.errors import InputError
from gearsim.metrology.holder_check import HolderInspection
from gearsim.processes.run import estimate, plan, run
from gearsim.scene import check_scene, load_scene, scene_table

SMALL = ("metrology.rows=3", "metrology.columns=5", "metrology.convergence=[]", "simulation.dexel_pitch_mm=1.5")
GEAR = ("metrology.spaces=1", "metrology.points=15", "toolpath.finishing.axial_step_mm=2.5")
WIDE = {"sections_mm": [[60.0, 80.0, 30.0]]}


def test_a_holder_that_hits_the_next_teeth_fails_the_run():
    """A short cutter: its holder begins 12 mm over the tip, in a slot 9 mm deep on a cone."""
    short = (*SMALL, "cutter.height_mm=12")
    clear = run("spiral-bevel-flank", overrides=(*short, "holder.sections_mm=[[20.0, 30.0, 30.0]]"))
    assert (clear.verdict, clear.status) == ("pass", "OK")
    hit = run("spiral-bevel-flank", overrides=(*short, "holder.sections_mm=[[60.0, 80.0, 30.0]]"))
    assert (hit.verdict, hit.exit_code) == ("fail", 1)
    (found,) = (f for f in hit.findings if f.kind == "holder_cut")
    assert found.cone_distance_mm > 0.0
    assert hit.measurements.keys() == clear.measurements.keys()
    told = estimate(*load_scene("spiral-bevel-flank", (*short, "holder.sections_mm=[[60.0, 80.0, 30.0]]")))
    assert told["rays"] == hit.counts["rays"] - hit.counts["following_rays"]


def held(job):
    """The holders of a job's program, if it is asked what they touch."""
    asked = any(isinstance(i, HolderInspection) for i in job.inspections)
    return [o.holder for o in job.variant(job.main).operations] if asked else []


def test_every_kind_of_tool_table_takes_a_holder(tmp_path):
    assert held(plan(*load_scene("spiral-bevel-flank", SMALL))) == []
    scene, folder = load_scene(
        "gouge-vertical-cylinder", ("toolpath.stepover_mm=5", "holder.shank_diameter_mm=6", "holder.shank_length_mm=20")
    )
    (body,) = held(plan(scene, folder))
    assert body.box[1:] == (3.0, scene.tools()["chosen"].height, scene.tools()["chosen"].height + 20.0)

    gear = scene_table(load_scene("spur-external", GEAR)[0])
    gear["tools"][0]["holder"] = WIDE
    gear.pop("budget", None)
    gear["toolpath"] = {"finishing": gear["toolpath"]["finishing"]}
    job = plan(check_scene(gear, "gear"))
    assert [h.box[1] for h in held(job)] == [40.0]
    (tmp_path / "own.nc").write_text(job.files["program.nc"])

    own = {name: gear[name] for name in ("scene", "surface", "machine", "tools")}
    own |= {"metrology": {"tolerance_um": 1.0}, "toolpath": {"kind": "program", "file": "own.nc"}}
    assert [h.box for h in held(plan(check_scene(own, "own"), tmp_path))] == [h.box for h in held(job)]


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({}, "holder: empty; give shank_diameter_mm with shank_length_mm, sections_mm, or both"),
        ({"shank_diameter_mm": 6.0}, "holder: shank_diameter_mm and shank_length_mm belong together"),
        ({"sections_mm": [[20.0, 30.0]]}, "holder.sections_mm.0: got .20.0, 30.0.; expected 3 or more"),
        ({"length_mm": 6.0}, "holder.length_mm: unknown key; did you mean 'shank_length_mm'"),
    ],
)
def test_what_is_no_holder_is_refused_by_its_key(table, message):
    tables = scene_table(load_scene("spiral-bevel-flank")[0]) | {"holder": table}
    with pytest.raises(InputError, match=message):
        check_scene(tables, "x")


def test_a_holder_is_never_silently_ignored():
    with pytest.raises(InputError, match="holder: unknown key"):
        load_scene("spiral-bevel-face-milled", ("holder.shank_diameter_mm=6", "holder.shank_length_mm=20"))
    gear = scene_table(load_scene("spur-external")[0])
    own = {name: gear[name] for name in ("scene", "surface", "machine", "tools")}
    own |= {"metrology": {"tolerance_um": 1.0}, "toolpath": {"kind": "program", "file": "own.nc"}, "holder": WIDE}
    with pytest.raises(InputError, match=r"holder: it belongs to \[cutter\]; give every entry of"):
        check_scene(own, "own")
