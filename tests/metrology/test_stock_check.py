"""The whole part as stock: what its operations are told to do, and what its rays' ends say of the surfaces."""

from dataclasses import replace

import numpy as np
import pytest

from gearsim.cutters.end_mills import ball, flat
from gearsim.errors import InputError
from gearsim.geometry.solid import Block
from gearsim.metrology.grid import DENSE
from gearsim.metrology.job import Job
from gearsim.metrology.stock_check import StockInspection
from gearsim.motion.sources import CLMotion
from gearsim.processes.run import estimate, plan, run, run_job
from gearsim.scene import load_scene
from gearsim.simulation.operation import Variant, operation, turned_copies
from gearsim.simulation.sequence import in_sequence, look_box, ray_count, whole_box
from gearsim.surfaces.part import Part

BLOCK = Block(np.zeros(3), np.array([30.0, 20.0, 10.0]))
SMALL = ("metrology.rows=3", "metrology.columns=5", "metrology.convergence=[]", "simulation.dexel_pitch_mm=1.5")

GEAR = ("metrology.spaces=1", "metrology.points=15", "toolpath.finishing.axial_step_mm=2.5")


def line(name, cutter, *tips, rapid=False, seconds=()):
    motion = CLMotion(np.array(tips, dtype=float), np.tile([0.0, 0.0, 1.0], (len(tips), 1)))
    return operation(name, cutter, [motion], 1e-9, rapid=[rapid], seconds=seconds)


def measured(*operations, **options):
    """A block machined by operations in the order given."""
    steps = np.cumsum([0, *(1 + o.step.max() for o in operations)])
    apart = tuple(replace(o, step=o.step + s) for o, s in zip(operations, steps, strict=False))
    asked = StockInspection("program", BLOCK, whole_box(BLOCK, 0.5), **options)
    job = Job("block", Part("block", BLOCK, {}), (Variant("program", "", apart),), "program", (asked,))
    result = run_job(job)
    (found,) = result.measurements.values()
    return found, result


def test_rows_and_operations_are_told_what_they_take():
    """A slot twice along the same way, the second time through air, and a groove across what it has left."""
    slot = line("slot", flat(4.0, 30.0), (-5, 6, 5), (35, 6, 5), (-5, 6, 5), seconds=[[np.nan, 6.0, 12.0]])
    across = line("across", flat(4.0, 30.0), (15, -5, 5), (15, 25, 5), seconds=[[np.nan, 10.0]])
    found, _ = measured(slot, across, rapid_mm_min=1000.0)
    first, second = found.operations
    assert (first.name, second.name) == ("slot", "across")
    assert np.allclose(first.removed, 30 * 4 * 5, rtol=0.06)
    assert np.allclose(second.removed, (20 - 4) * 4 * 5, rtol=0.06)
    assert first.volume.tolist() == pytest.approx([600.0, 0.0], rel=0.06)
    assert first.air.tolist() == [False, True]
    assert first.way.tolist() == pytest.approx([40.0, 40.0])
    assert first.seconds.tolist() == [6.0, 12.0]
    assert sum(found.blank_volumes) / 3 == pytest.approx(BLOCK.volume, rel=0.06)
    assert np.allclose(np.array(found.blank_volumes) - found.stock.volumes, np.add(first.removed, second.removed))


def test_a_rapid_through_material_fails_and_one_where_it_was_cut_before_does_not():
    down = line("slot", flat(4.0, 30.0), (-5, 6, 5), (35, 6, 5))
    back = line("back", flat(4.0, 30.0), (35, 6, 5), (-5, 6, 5), rapid=True)
    _, clear = measured(down, back, rapid_mm_min=1000.0)
    assert [f.kind for f in clear.findings] == []
    found, hit = measured(back, down, rapid_mm_min=1000.0)
    (told,) = hit.findings
    assert told.kind == "rapid_cut"
    assert told.fails
    assert told.text == "a rapid move of back goes through material, 30 mm of it along a ray"
    assert told.place_mm[0] == pytest.approx(15.0)
    assert found.operations[0].seconds == pytest.approx([2.4])


def test_a_rapid_that_grazes_by_rounding_hides_no_later_one():
    ways = ((-5, 6, 10 - 5e-7), (35, 6, 10 - 5e-7), (35, 12, 20), (35, 12, 5), (-5, 12, 5))
    _, hit = measured(line("across", flat(4.0, 30.0), *ways, rapid=True), rapid_mm_min=1000.0)
    (told,) = hit.findings
    assert told.text == "a rapid move of across goes through material, 30 mm of it along a ray"


def test_a_program_is_cut_up_where_its_tool_changes():
    one, two = (
        line("one", flat(4.0, 30.0), (0, 0, 0), (1, 0, 0), (2, 0, 0)),
        line("two", ball(2.0, 9.0), (0, 0, 0), (1, 0, 0)),
    )
    apart = replace(one, step=np.array([0, 2])), replace(two, step=np.array([1]))
    mixed = Variant("program", "", apart)
    assert [(o.name, len(o)) for o in in_sequence(mixed)] == [("one", 1), ("two", 1), ("one (2)", 1)]


def test_a_tool_s_retreat_behind_the_next_heading_belongs_to_its_own_work():
    """As a program has it: a heading, home by rapid with the old tool, the tool change, then the new one's work."""
    ways = (0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)
    old, new = line("T1", flat(4.0, 30.0), *ways), line("T2", ball(2.0, 9.0), *ways[:2])
    told = {"headings": ("rough", "fine")}
    old = replace(old, rapid=np.array([False, False, True]), section=np.array([0, 0, 1]), **told)
    new = replace(new, step=np.array([3]), section=np.array([1]), **told)
    assert [(o.name, len(o)) for o in in_sequence(Variant("program", "", (old, new)))] == [("rough", 3), ("fine", 1)]
    cuts = replace(old, rapid=np.zeros(3, dtype=bool))
    named = [(o.name, len(o)) for o in in_sequence(Variant("program", "", (cuts, new)))]
    assert named == [("rough", 2), ("fine", 1), ("fine (2)", 1)]


def test_the_whole_gear_says_of_its_flanks_what_the_normals_say():
    whole = ("stock.pitch_mm=1.5", "stock.spaces='all'")
    result = run("spiral-bevel-flank", overrides=(*SMALL, *whole))
    found = result.measurements["", "program", "stock"]
    near = {s.surface: s for s in found.surfaces}
    for side in ("convex", "concave"):
        by_normals = 1e3 * result.measurements[side, "program", DENSE].deviation.value
        assert near[side].ends > 3000
        assert 1e3 * near[side].overcut > by_normals.min() - 0.2
        assert 1e3 * near[side].excess < by_normals.max() + 0.2
    assert [o.name for o in found.operations] == ["convex", "concave"]
    alone = run("spiral-bevel-flank", overrides=(*SMALL, "stock.pitch_mm=1.5"))
    for told, one in zip(found.operations, alone.measurements["", "program", "stock"].operations, strict=True):
        assert np.mean(told.removed) == pytest.approx(33 * np.mean(one.removed), rel=0.05)
    counted = estimate(*load_scene("spiral-bevel-flank", (*SMALL, *whole)))
    assert counted["rays"] == result.counts["rays"] - result.counts["following_rays"]


def test_copies_count_the_part_s_spaces():
    job = plan(*load_scene("spiral-bevel-flank", (*SMALL, "stock.pitch_mm=5", "stock.spaces='all'")))
    asked = next(i for i in job.inspections if isinstance(i, StockInspection))
    once = in_sequence(job.variant("program"))
    assert [len(o) for o in asked.operations(job)] == [33 * len(o) for o in once]
    assert len(turned_copies(once[0], 3)) == 3 * len(once[0])


def test_a_coarse_look_has_few_rays():
    fine = whole_box(BLOCK, 0.05)
    assert 40_000 < ray_count(look_box(fine)) < 70_000
    few = whole_box(BLOCK, 2.0)
    assert ray_count(look_box(few)) == ray_count(few)


@pytest.mark.parametrize(
    ("scene", "overrides", "message"),
    [
        ("gouge-cases", ("stock.pitch_mm=1",), "stock: scene gouge-cases cuts no part"),
        ("gouge-vertical-cylinder", ("stock.pitch_mm=1",), "this part has no blank of its own"),
        ("spur-external", (*GEAR, "stock.pitch_mm=1", "stock.spaces='all'"), "the program of one bevel gear's space"),
        ("spiral-bevel-flank", ("stock.pitch_mm=1e-3",), "mm would do, or of a bevel gear one space's sector"),
        ("spiral-bevel-flank", ("stock.pitch_mm=200",), "the blank is only"),
        ("spiral-bevel-flank", ("stock.pitch_mm=1", "stock.blank.kind='cylinder'", "stock.blank.diameter_mm=9",
                                "stock.blank.bottom_mm=3", "stock.blank.top_mm=3"), "top_mm must be above bottom_mm"),
        ("spiral-bevel-flank", ("stock.pitch_mm=1", "stock.blank.kind='turned'",
                                "stock.blank.outline_mm=[[0,0],[1,1],[2,2]]"), "enclose no area"),
    ],
)  # fmt: skip
def test_stock_that_cannot_be_is_told(scene, overrides, message):
    with pytest.raises(InputError, match=message):
        plan(*load_scene(scene, overrides))


def test_one_sector_stands_for_the_whole_gear():
    """A sector's volume is that share of the whole; its ends say of the flanks what the whole's say."""
    whole = run("spiral-bevel-flank", overrides=(*SMALL, "stock.pitch_mm=1.0", "stock.spaces='all'"))
    one = run("spiral-bevel-flank", overrides=(*SMALL, "stock.pitch_mm=0.4", "stock.spaces='sector'"))
    large, small = (r.measurements["", "program", "stock"] for r in (whole, one))
    assert small.sectors == 33
    assert small.exact_blank_volume == pytest.approx(large.exact_blank_volume / 33)
    assert np.mean(small.stock.volumes) == pytest.approx(np.mean(large.stock.volumes) / 33, rel=5e-3)
    assert small.contour.mesh.open_edges == 0
    for a, b in zip(large.surfaces[:2], small.surfaces[:2], strict=True):
        assert b.ends > 1000
        assert (1e3 * a.overcut, 1e3 * a.excess) == pytest.approx((1e3 * b.overcut, 1e3 * b.excess), abs=0.15)
    assert "one sector of them is judged at the ends of rays 0.4 mm apart" in one.headline


def test_a_block_has_no_sectors():
    block = ("stock.blank.kind='block'", "stock.blank.lower_mm=[-90,-90,0]", "stock.blank.upper_mm=[90,90,50]")
    with pytest.raises(InputError, match="has no alike sectors"):
        plan(*load_scene("spiral-bevel-flank", ("stock.pitch_mm=2", "stock.spaces='sector'", *block)))
