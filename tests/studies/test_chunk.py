"""A chunk's jobs give what each gives alone, and what a run of its scene gives."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.motion.segments import compile_cl, compile_motion
from gearsim.motion.sources import CLMotion
from gearsim.processes.run import plan, run_job
from gearsim.programs.cldata import CLPath, CLProgram, CLTool, as_read, format_cl, parse_cl
from gearsim.scene import load_scene
from gearsim.scene.keys import put
from gearsim.scene.loading import scene_table
from gearsim.studies.chunk import run_chunk, tables_of
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
    assert third.cross_checked().sum() == 1
    assert np.array_equal(third.cross_checked(), replace(third, name="other").cross_checked())
    assert not study.cross_checked().any()


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
