"""CL files of several tools: each pass is cut by its own, from the file or the scene, or refused by line."""

from pathlib import Path

import pytest

from gearsim.cutters.catalogue import ball, barrel, flat, lollipop
from gearsim.errors import InputError
from gearsim.metrology.grid import DENSE
from gearsim.motion.sources import CLMotion
from gearsim.processes.cl_tools import cl_cutters, cl_operations
from gearsim.processes.run import plan, run_job
from gearsim.programs.cldata import parse_cl
from gearsim.scene import check_scene, load_scene
from gearsim.simulation.operation import Variant
from gearsim.simulation.sequence import in_sequence

FOLDER = Path(__file__).parents[1] / "data" / "cl"
BALL, MILL = "CUTTER/16.0,8.0,0,8.0,0,0,60", "CUTTER/6,0,3,0,0,0,20"


def two(first, second):
    return parse_cl(f"{first}\nFROM/0,0,0\nGOTO/1,0,0\n{second}\nGOTO/2,0,0\n", "own.cl")


@pytest.fixture(scope="module")
def gouged():
    """The file of the ball that gouges, by the scene beside it."""
    scene, folder = load_scene(FOLDER / "twotools65.toml")
    return scene, run_job(plan(scene, folder))


def test_the_ball_of_the_first_pass_gouges_by_three_millimetres(gouged):
    _, result = gouged
    assert result.verdict == "fail"
    for side in ("convex", "concave"):
        whole = result.measurements[side, "program", DENSE].deviation
        assert result.measurements[side, "own pass", DENSE].deviation.summary_um()["min"] > -1.0
        assert whole.summary_um()["through"] > 40
    cross = [f for f in result.findings if f.kind == "cross_cut"]
    assert [f.fails for f in cross] == [True] * 4
    assert sorted(f.text.rpartition(" in ")[2] for f in cross[2:]) == ["space 2", "space 33"]  # the next ones, too
    assert cross[0].depth_um == pytest.approx(-3068.0, abs=1.0)


def as_program(scene, text, folder, **more):
    """The same gear in a scene of any program, cut by this CL data."""
    (folder / "own.cl").write_text(text)
    tables = scene.model_dump(exclude_none=True)
    return check_scene({
        "scene": {"name": "own"}, "surface": tables["surface"], "simulation": tables["simulation"],
        "metrology": {"tolerance_um": 5.0, "rows": 5, "columns": 17, "judged": ["convex"]},
        "toolpath": {"kind": "program", "file": "own.cl"},
    } | more, "own")  # fmt: skip


def test_numbers_alone_are_cut_by_the_scene_s_tools(gouged, tmp_path):
    scene, result = gouged
    text = (FOLDER / "twotools65.cl").read_text()
    numbers = "\n".join(line for line in text.splitlines() if not line.startswith("CUTTER")) + "\n"
    ball16 = {"kind": "ball", "diameter_mm": 16.0, "height_mm": 60.0}
    tools = [{"number": 2, "cutter": scene.model_dump()["cutter"]}, {"number": 1, "cutter": ball16}]
    job = plan(as_program(scene, numbers, tmp_path, tools=tools), tmp_path)
    assert [o.cutter.name for o in job.variant("program").operations] == ["ball end mill", "conical cutter"]
    own = run_job(job).measurements["convex", "program", DENSE].deviation
    whole = result.measurements["convex", "program", DENSE].deviation
    assert own.value == pytest.approx(whole.value, abs=1e-6, nan_ok=True)
    with pytest.raises(InputError, match=r"own\.cl, line 118: tool 2 is not known: tools has 1; give it seven numbers"):
        plan(as_program(scene, numbers, tmp_path, tools=tools[1:]), tmp_path)


def test_a_tool_is_that_of_its_number_or_its_sizes_or_as_stated():
    named = {1: ball(16.0, 60.0), 2: flat(6.0, 20.0)}
    cutters, notes = cl_cutters(two("LOADTL/1", "LOADTL/2"), "own.cl", None, named)
    assert (cutters, notes) == (tuple(named.values()), ())
    cutters, notes = cl_cutters(two(BALL, MILL), "own.cl", None, named)
    assert (cutters, notes) == (tuple(named.values()), ())
    cutters, notes = cl_cutters(two(BALL, MILL), "own.cl", ball(16.0, 60.0))
    assert cutters[0].name == "ball end mill"
    assert (cutters[1].max_radius, cutters[1].height) == (3.0, 20.0)
    assert notes == ("CUTTER/6, 0, 3, 0, 0, 0, 20 (line 4) is cut as CUTTER states it, to its printed digits",)


@pytest.mark.parametrize(
    ("second", "named", "message"),
    [
        ("LOADTL/3", {1: ball(16.0, 60.0)}, "own.cl, line 4: tool 3 is not known: tools has 1"),
        ("LOADTL/DRILL", {}, "own.cl, line 4: tool DRILL is not known: no CUTTER states its sizes"),
        ("CUTTER/5", {}, "own.cl, line 4: CUTTER/5 is none of the scene's: CUTTER/5 states no whole tool"),
        (
            "LOADTL/1\nCUTTER/12",
            {1: ball(16.0, 60.0)},
            r"own.cl is for CUTTER/12 .*; the scene's tool 1 is .*: d differ",
        ),
    ],
)
def test_a_tool_that_nothing_describes_is_refused_by_line(second, named, message):
    with pytest.raises(InputError, match=message):
        cl_cutters(two(MILL, second), "own.cl", None, named)


def test_a_file_of_no_tool_needs_one_cutter_in_the_scene():
    program = parse_cl("FROM/0,0,0\nGOTO/1,0,0\n", "own.cl")
    assert cl_cutters(program, "own.cl", ball(16.0, 60.0))[0][0].name == "ball end mill"
    assert cl_cutters(program, "own.cl", None, {5: ball(16.0, 60.0)})[0][0].name == "ball end mill"
    with pytest.raises(InputError, match=r"own\.cl: its tool is not known: tools has 1, 2"):
        cl_cutters(program, "own.cl", None, {1: ball(16.0, 60.0), 2: flat(6.0, 20.0)})


def test_tools_of_shapes_that_no_numbers_state_are_found_by_their_number():
    named = {1: barrel(10.0, 60.0, 10.0, 30.0), 2: flat(6.0, 20.0)}
    assert cl_cutters(two("LOADTL/1", "LOADTL/2"), "own.cl", None, named)[0] == tuple(named.values())
    cutters, notes = cl_cutters(two(f"LOADTL/1\n{BALL}", f"LOADTL/2\n{MILL}"), "own.cl", None, named)
    assert cutters == tuple(named.values())
    assert notes[0].endswith("(line 2) was not compared: the scene's tool 1, barrel cutter, is no APT cutter")
    stated, _ = cl_cutters(
        two(BALL, MILL), "own.cl", None, {1: barrel(10.0, 60.0, 10.0, 30.0), 2: lollipop(16.0, 4.0, 60.0)}
    )
    assert [c.max_radius for c in stated] == [8.0, 3.0]
    assert all(c.is_convex for c in stated)


def test_moves_stand_under_the_pass_that_they_lead_to():
    text = (
        "FROM/0,0,50\nRAPID\nGOTO/0,0,9\nPPRINT PASS rough-1\nFEDRAT/100,MMPM\nGOTO/0,0,0\nRAPID\nGOTO/0,0,9\n"
        "PPRINT PASS rough-2\nGOTO/5,0,0\nRAPID\nGOTO/5,0,9\nPPRINT PASS fine.7\nGOTO/5,5,0\nRAPID\nGOTO/5,5,50\n"
    )
    program = parse_cl(text)
    sources = [CLMotion(p.tips, p.axes) for p in program.paths]
    (made,) = cl_operations(program, [flat(4.0, 20.0)], sources, 1e-9, [None])
    assert made.headings == ("rough", "fine")
    assert [made.headings[s] for s in made.section] == ["rough"] * 4 + ["fine"] * 3
    assert [made.headings[o.section[0]] for o in in_sequence(Variant("program", "", (made,)))] == ["rough", "fine"]
