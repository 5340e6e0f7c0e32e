"""A slot from the blank to the finished root: operations in their order, each with its own tool and feed."""

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.processes.run import plan, run_job
from gearsim.processes.slot_program import _semi_finishing
from gearsim.programs.cldata import RAPID, parse_cl
from gearsim.scene import load_scene, scene_text
from gearsim.surfaces.patch import SIDES
from gearsim.toolpaths.clearance import CLEAR_MM, Clearance
from gearsim.toolpaths.slot_clearance import SlotClearance

SMALL = (
    "toolpath.points=17", "toolpath.run_mm=5", "root.ridge_um=15", "roughing.depth_mm=5", "metrology.tolerance_um=15",
    "metrology.root_tolerance_um=15", "metrology.root_excess_um=25", "metrology.rows=5", "metrology.columns=17",
    "metrology.convergence=[]", "simulation.dexel_pitch_mm=1.0", "roughing.holder.shank_diameter_mm=16",
    "roughing.holder.shank_length_mm=30",
)  # fmt: skip
SCENE = "spiral-bevel-complete"


@pytest.fixture(scope="module")
def job():
    return plan(*load_scene(SCENE, SMALL))


@pytest.fixture(scope="module")
def program(job):
    return parse_cl(job.files["toolpath.cl"])


def test_operations_follow_each_other_each_with_its_own_tool(job, program):
    cuts = [p for p in program.paths if p.name != RAPID]
    kinds = [p.name.split("-")[0] for p in cuts if p.name not in ("approach", "withdrawal")]
    assert list(dict.fromkeys(kinds)) == ["roughing", "semi", "convex", "concave", "root"]
    assert kinds.count("roughing") == 2
    assert kinds.count("root") > 10
    assert [t.number for t in program.tools] == ["1", "2", "3", "4"]
    assert [p.tool for p in program.paths] == sorted(p.tool for p in program.paths)
    assert {p.tool: p.feed for p in cuts} == {0: 300.0, 1: 500.0, 2: 600.0, 3: 600.0}
    assert [o.cutter.name for o in job.variant("program").operations] == 3 * ["conical cutter"] + [
        "tapered ball end mill"
    ]


def test_rapids_stay_clear_of_the_blank_and_lead_from_pass_to_pass(job, program):
    cutters = [o.cutter for o in job.variant("program").operations]
    for before, after in zip(program.paths[:-1], program.paths[1:], strict=True):
        if before.tool == after.tool:
            assert np.array_equal(before.tips[-1], after.tips[0])
    for k, cutter in enumerate(cutters):
        clearance = Clearance(job.part.stock, cutter)
        rapids = [p for p in program.paths if p.name == RAPID and p.tool == k]
        assert all(clearance.along(p.tips, p.axes) > CLEAR_MM - 1e-6 for p in rapids)


def test_the_machine_changes_tools_and_feeds(job):
    text = job.files["program.nc"]
    assert [line for line in text.splitlines() if "M06" in line] == [f"T{k} M06" for k in (1, 2, 3, 4)]
    assert "(PASSES ROUGHING-1, ROUGHING-2)" in text


def test_the_slot_is_finished_with_no_stock_left_in_the_root(job):
    """What stands in the root is no more than ridges and the chords of a few CL points; the shank is looked at, too."""
    result = run_job(job)
    assert [i.name for i in job.inspections].count("holders") == 1
    assert [o.holder is not None for o in job.variant("program").operations] == [True, False, False, False]
    assert result.verdict == "pass"
    assert "stock" not in result.headline
    roots = [m for (surface, *_), m in result.measurements.items() if surface and surface not in SIDES]
    assert len(roots) == 3
    for m in roots:
        assert -0.012 < np.nanmin(m.deviation.value) < np.nanmax(m.deviation.value) < 0.025


def test_roughing_tells_its_critical_depth(job):
    (note,) = job.notes
    assert note.startswith(
        "roughing by strategy II takes 2 passes and stops 0.299 mm over the root; its tool would cut"
    )


@pytest.mark.parametrize(
    ("overrides", "told"),
    [
        (("roughing.strategy='III'",), r"roughing\.strategy: got 'III'"),
        (("roughing.tool.taper_mm=3",), r"roughing\.tool\.taper_mm: unknown key; did you mean 'taper_deg'"),
        (("root.tool.taper_deg=100",), "taper"),
        (("root.ridge_um=0",), r"root\.ridge_um: got 0"),
        (("toolpath.spaces=34",), "got 34; the gear has 33"),
    ],
)
def test_mistakes_in_the_tables_are_told(overrides, told):
    with pytest.raises(InputError, match=told):
        load_scene(SCENE, overrides)


def test_a_semi_finishing_tool_that_does_not_fit_the_slot_is_refused():
    """The finishing cutter itself: an allowance off its flank it stands in the opposite one's fillet."""
    scene, _ = load_scene(SCENE, (*SMALL, "semi_finishing.tool.bottom_radius_mm=1.04"))
    with pytest.raises(InputError, match=r"pass of the concave flank cuts 39\.\d+ um into the intended convex fillet"):
        _semi_finishing(scene, SlotClearance(scene.tooth().patches))


def test_a_read_program_has_no_planned_operations(tmp_path):
    lines = scene_text(SCENE)[0].replace("points = 65", 'file = "my.cl"  # ').splitlines()
    drop = ("run_mm", "retract_mm", "decimals", "feed_mm_min = 600.0             # of the finishing")
    (tmp_path / "scene.toml").write_text("\n".join(line for line in lines if not line.startswith(drop)))
    with pytest.raises(InputError, match="replaces our planner; remove roughing, semi_finishing, root"):
        load_scene(str(tmp_path / "scene.toml"))
