"""A chunk's jobs give what each gives alone, and what a run of its scene gives."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.metrology.gear_probing import all_rays, probing
from gearsim.metrology.grid import GridInspection, GridMeasurement
from gearsim.motion.segments import compile_cl, compile_motion
from gearsim.motion.sources import CLMotion
from gearsim.processes.brief import Brief, Planned, mapped, one_road, shortened
from gearsim.processes.cylindrical import programmed
from gearsim.processes.cylindrical_many import nearby
from gearsim.processes.gear_budget import disturbed_operations
from gearsim.processes.run import plan, run_job
from gearsim.programs.cldata import CLPath, CLProgram, CLTool, as_read, format_cl, parse_cl
from gearsim.scene import load_scene
from gearsim.scene.keys import put
from gearsim.scene.loading import scene_of, scene_table
from gearsim.simulation.disturbance import Disturbance
from gearsim.studies.chunk import run_chunk, tables_of
from gearsim.studies.performing import performed
from gearsim.studies.records import Asked, Parameter, Study

SMALL = (
    "metrology.rows=4", "metrology.columns=6", "metrology.convergence=[]", "simulation.dexel_pitch_mm=3.0",
)  # fmt: skip
RUN, ONE_ROAD = Asked(cross_checked=1.0), Asked(cross_checked=0.0)


@pytest.fixture(scope="module")
def study() -> Study:
    scene, folder = load_scene("spiral-bevel-flank", SMALL)
    tables = scene_table(scene)
    del tables["reference"]
    parameters = (
        Parameter("cutter.taper_deg", (15.0, 14.9, 60.0, 15.1)),
        Parameter("toolpath.points", (17, 33, 33, 25)),
    )
    return Study("four", "", tables, folder, parameters, "list", 7, ONE_ROAD, 4)


@pytest.fixture(scope="module")
def outcomes(study):
    return run_chunk(study, range(4))[0]


def test_a_run_of_the_same_scene_measures_the_same_bits(study, outcomes):
    scene, folder = load_scene("spiral-bevel-flank", (*SMALL, "cutter.taper_deg=14.9", "toolpath.points=33"))
    result = run_job(plan(scene, folder))
    for side in ("convex", "concave"):
        of_run = result.measurements[side, "program", "dense grid"]
        mine = outcomes[1].maps[side]
        assert np.array_equal(mine.deviation_um, 1e3 * of_run.deviation.value)
        assert np.array_equal(mine.crossing, of_run.deviation.crossing)
        assert outcomes[1].figures[f"{side}.max_um"] == of_run.deviation.summary_um()["max"]
    whole = run_chunk(replace(study, asked=RUN), [1])[0][0]
    assert (whole.verdict, whole.status) == (result.verdict, result.status)
    assert whole.cross_checked
    assert whole.figures == outcomes[1].figures


def test_one_road_alone_never_passes(outcomes):
    done = [o for o in outcomes if o.verdict != "error"]
    assert {o.verdict for o in done} == {"unchecked"}
    assert all("envelope road was left out" in o.status for o in done)


def test_a_job_that_cannot_be_done_says_why_and_leaves_the_others_alone(study, outcomes):
    assert [o.verdict for o in outcomes].count("error") == 1
    assert outcomes[2].verdict == "error"
    assert "taper" in outcomes[2].error
    assert not outcomes[2].maps
    alone = run_chunk(study, [3])[0][0]
    assert np.array_equal(alone.maps["convex"].deviation_um, outcomes[3].maps["convex"].deviation_um)
    assert alone.figures == outcomes[3].figures


def test_only_chosen_jobs_are_cross_checked_by_the_seed(study):
    third = replace(study, asked=Asked(cross_checked=0.25))
    assert third.cross_checked.sum() == 1
    assert np.array_equal(third.cross_checked, replace(third, name="other").cross_checked)
    assert not study.cross_checked.any()


def test_programs_are_what_reading_their_text_gives():
    rng = np.random.default_rng(3)
    axes = np.array([0.0, 0.0, 1.0]) + 0.1 * rng.normal(size=(14, 3))
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    tips = 30.0 * rng.normal(size=(14, 3))
    tips[5], axes[5] = tips[4] + 1e-13, axes[4]  # no move, once rounded

    def path(name: str, first: int, last: int, tool: int = 0) -> CLPath:
        return CLPath(name, tips[first:last], axes[first:last], tool)

    paths = (path("rapid", 0, 2), path("convex", 1, 4), path("rapid", 3, 5), path("rapid", 4, 7), path("convex", 6, 8),
             path("convex", 7, 9), path("rapid", 10, 12, 1), path("concave", 11, 14, 1))  # fmt: skip
    planned = CLProgram(paths, (CLTool("1"), CLTool("2")))
    for decimals in (6, 9, 12):
        read = parse_cl(format_cl(planned, "x", 100.0, decimals), "x")
        mine = as_read(planned, decimals)
        assert [(p.name, p.tool) for p in mine.paths] == [(p.name, p.tool) for p in read.paths]
        for a, b in zip(mine.paths, read.paths, strict=True):
            assert np.array_equal(a.tips, b.tips)
            assert np.array_equal(a.axes, b.axes)
    for reading in (partial(as_read, planned, 3), lambda: parse_cl(format_cl(planned, "x", 100.0, 3), "x")):
        with pytest.raises(InputError, match="has length"):
            reading()


def test_motions_compiled_together_are_those_compiled_alone():
    rng = np.random.default_rng(5)
    motions, reaches = [], [3.0, 40.0, 11.0]
    for n in (2, 9, 5):
        axes = np.array([0.0, 0.0, 1.0]) + 0.1 * rng.normal(size=(n, 3))
        motions.append(CLMotion(rng.normal(size=(n, 3)), axes / np.linalg.norm(axes, axis=1)[:, None]))
    for motion, reach, found in zip(motions, reaches, compile_cl(motions, reaches), strict=True):
        alone = compile_motion(motion, reach)
        for name in alone.__dataclass_fields__:
            assert np.array_equal(getattr(found, name), getattr(alone, name)), name


def test_values_stand_at_their_keys():
    tables = {"cutter": {"taper_deg": 15.0}, "errors": {"pivot_um": [0.0, 0.0, 0.0]}, "tools": [{"diameter_mm": 3.0}]}
    put(tables, "cutter.taper_deg", 14.0)
    put(tables, "errors.pivot_um.2", 5.0)
    put(tables, "tools.0.diameter_mm", 4.0)
    put(tables, "new.table.key", 1)
    assert tables["cutter"]["taper_deg"] == 14.0
    assert tables["errors"]["pivot_um"] == [0.0, 0.0, 5.0]
    assert tables["tools"][0]["diameter_mm"] == 4.0
    assert tables["new"] == {"table": {"key": 1}}
    for key in ("cutter.taper_deg.x", "tools.1.diameter_mm", "errors.pivot_um.3", "tools.x.y"):
        with pytest.raises(InputError, match=key.split(".")[0]):
            put(tables, key, 1.0)


def test_a_jobs_values_leave_the_studys_tables_alone(study):
    tables = tables_of(study, 1)
    assert tables["cutter"]["taper_deg"] == 14.9
    assert study.tables["cutter"]["taper_deg"] == 15.0


GEAR = (
    "metrology.spaces=1", "metrology.points=9", "metrology.rows=3", "metrology.columns=3", "surface.face_width_mm=4.0",
    "toolpath.slots.radial_step_mm=5.0", "toolpath.roughing.axial_step_mm=2.0", "simulation.dexel_pitch_mm=3.0",
    "toolpath.roughing.involute_step_mm=5.0", "toolpath.finishing.involute_step_mm=2.0",
    "toolpath.finishing.axial_step_mm=2.0",
)  # fmt: skip
ERRORS = {
    "errors.axes.X.scale_um_m": (0.0, 30.0, 0.0, 0.0),
    "errors.axes.B.offset_x_um": (0.0, -4.0, 0.0, 0.0),
    "errors.axes.C.backlash_urad": (0.0, 5.0, 0.0, 0.0),
    "errors.tool_radius_um": (0.0, 1.0, -30.0, 90.0),
}


@pytest.fixture(scope="module")
def gears() -> Study:
    scene, folder = load_scene("helical-external", GEAR)
    tables = scene_table(scene.model_copy(update={"budget": None, "reference": None}))
    parameters = tuple(Parameter(key, values) for key, values in ERRORS.items())
    return Study("gears", "", tables, folder, parameters, "list", 7, Asked(("maps", "iso"), 0.0), 4)


def test_gears_with_errors_are_those_that_the_whole_program_cuts(gears):
    """Of a tool 90 um too thick the blocks near the flanks tell nothing for certain: the whole program does."""
    found = run_chunk(gears, range(4))[0]
    assert [o.error for o in found] == [""] * 4
    brief = Brief(maps=True, iso=True)
    for job in (1, 3):
        outcome = found[job]
        whole = shortened(plan(scene_of(tables_of(gears, job), "gears"), gears.folder), brief)
        (done,) = performed([Planned(whole)], "cpu", None)
        maps = {m.surface: m for r in done.readings for m in r.measurements if isinstance(m, GridMeasurement)}
        assert set(maps) == set(outcome.maps) == {"left", "right"}
        for side, m in maps.items():
            assert np.array_equal(1e3 * m.deviation.value, outcome.maps[side].deviation_um, equal_nan=True)
    assert np.nanmax(np.abs(found[0].maps["left"].deviation_um)) < 1.0
    assert found[3].maps["left"].deviation_um.mean() == pytest.approx(-90.0, abs=2.0)
    assert found[1].figures["iso.F_alpha.left_um"] != found[0].figures["iso.F_alpha.left_um"]


def test_blocks_left_out_are_farther_from_every_point_than_they_must_be(gears):
    """Against the tool's own distance at many instants of each block that is left out."""
    scene = scene_of(tables_of(gears, 0), "gears")
    made = programmed(scene, gears.folder)
    rays = [all_rays(probing(made.probed.gear, s, made.probed.reached[s], 5), (0,)).origin for s in ("left", "right")]
    points = np.concatenate(rays)[::4]
    near = nearby(made, points, 1e-9)
    assert 0 < near.sum() < 0.3 * len(near)
    (operation,) = disturbed_operations(made.program.blocks, made.tools, Disturbance(), 1e-9, chosen=~near)
    for x in np.linspace(-1.0, 1.0, 5):
        powers = x ** np.arange(6)
        tip, axis = (np.einsum("k,nkc->nc", powers, c)[::3] for c in (operation.table.tip, operation.table.axis))
        off = points[:, None] - tip
        z = (off * axis).sum(axis=-1)
        r = np.linalg.norm(off - z[..., None] * axis, axis=-1)
        assert operation.cutter.signed_distance(r, z).min() > 0.1


def test_of_a_scene_without_maps_nothing_is_within_tolerance():
    scene, folder = load_scene("gouge-border")
    parameters = (Parameter("simulation.tolerance_mm", (1e-9, 1e-8)),)
    study = Study("bare", "", scene_table(scene), folder, parameters, "list", 7, ONE_ROAD, 2)
    outcomes, _ = run_chunk(study, range(2))
    for outcome in outcomes:
        assert (outcome.verdict, outcome.figures["within_tolerance"]) == ("unchecked", None)
        assert "nothing was measured" in outcome.status


def test_files_that_cannot_be_read_are_told_as_the_scene_names_them(study, tmp_path):
    tables = {**study.tables, "toolpath": {"file": "one.cl"}}
    gone = replace(study, tables=tables, folder=tmp_path, parameters=(Parameter("toolpath.file", ("a.cl", "b.cl")),))
    assert [o.error for o in run_chunk(gone, range(2))[0]] == [
        f"cannot read CL file {name}: No such file or directory" for name in ("a.cl", "b.cl")
    ]


def test_a_map_is_of_the_whole_program_and_all_judged_motions_are_held_against_the_tolerance():
    grid = GridInspection("convex", ("roll", "phoenix", "star"), ("roll",), 3, 3, judged=("roll", "phoenix"))
    assert mapped(grid, "phoenix") == "phoenix"
    assert mapped(replace(grid, name="inspection grid"), "phoenix") == ""
    assert mapped(grid, "another") == "roll"
    assert one_road(grid, "phoenix").variants == ("phoenix", "roll")
    assert one_road(grid, "phoenix").judged == ("roll", "phoenix")
    assert one_road(grid, "star").variants == ("star", "roll", "phoenix")
    assert one_road(replace(grid, judged=()), "star").judged == ("star",)


def test_what_is_larger_than_was_planned_for_is_asked_again_of_the_whole(study):
    """And what is not, is not."""
    made = []
    short = plan(scene_of(tables_of(study, 0), "one"), study.folder)
    short = shortened(short, Brief())

    def whole():
        made.append("whole")
        return short

    first, again = performed([Planned(short, 1.0, whole), Planned(short, 1e-9, whole)], "cpu", None)
    assert made == ["whole"]
    for one, other in zip(first.readings, again.readings, strict=True):
        assert np.array_equal(one.measurements[0].deviation.value, other.measurements[0].deviation.value)
