"""A whole gear from an oversize disc, all of its surfaces judged: eight teeth of spur-external-complete, coarsely."""

from dataclasses import replace
from math import sqrt

import numpy as np
import pytest

from gearsim.metrology.grid import DENSE
from gearsim.metrology.stock_check import one_road
from gearsim.metrology.stock_surfaces import beside_solid
from gearsim.processes.run import estimate, run
from gearsim.scene import load_scene
from gearsim.surfaces.gear_outline import GearOutline

STEPS = [f"toolpath.{name}.axial_step_mm=5" for name in ("root", "roughing", "finishing")]
COARSE = (
    "surface.teeth=8", "surface.rim_mm=5", "stock.pitch_mm=1.25", "stock.blank.diameter_mm=54", *STEPS,
    "toolpath.facing.radius_mm=28", "toolpath.outside.blank_radius_mm=27", "toolpath.outside.radius_mm=25",
    "toolpath.outside.axial_step_mm=10.5", "toolpath.bore.radius_mm=8.75", "toolpath.bore.axial_step_mm=10.5",
    "toolpath.slots.radial_step_mm=4", "metrology.points=15", "metrology.spaces=1", "metrology.rows=3",
    "metrology.columns=5", "simulation.dexel_pitch_mm=1", "metrology.section_pitch_mm=0.5",
)  # fmt: skip
NAMES = ["FACING", "OUTSIDE DIAMETER", "BORE", "SLOTS", "ROOT", "TOOTH ROUGHING", "TOOTH FINISHING"]


@pytest.fixture(scope="module")
def result():
    return run("spur-external-complete", overrides=COARSE)


@pytest.fixture(scope="module")
def found(result):
    return result.measurements["", "program", "stock"]


def test_it_passes_and_every_surface_is_judged(result, found):
    assert result.verdict == "pass"
    assert not [f for f in result.findings if f.fails]
    whole = result.job.part.whole
    faces = ("left", "right", "root", "tip", "top face", "bottom face", "bore")
    assert tuple(s.surface for s in found.surfaces) == tuple(whole.tolerances) == faces
    assert all(s.ends > 50 for s in found.surfaces)
    ends = sum(2 * len(k.lo) for k in found.stock.left)
    assert sum(s.ends for s in found.surfaces) == ends  # none escapes
    assert one_road(whole, result.job.part)[0].startswith("tip, top face, bottom face, bore: by one road only")
    assert "; tip, top face, bottom face, bore: by one road only" in result.headline


def test_the_root_of_one_space_is_measured_along_its_normals_by_both_roads(result):
    """A root pass asked again alone: between two chords of the way round a fillet at most the chord's sag is left."""
    by_program, alone = (result.measurements["root", name, DENSE] for name in ("program", "last operation"))
    um = 1e3 * by_program.deviation.value
    assert by_program.deviation.measured.all()
    assert -0.1 < um.min() < um.max() < 0.2
    assert alone.gap.valid == um.size
    assert alone.gap.trusted
    assert alone.by.text.endswith("(T3)")


def test_every_operation_has_its_name_its_tool_and_its_figures(found):
    assert [o.name for o in found.operations] == NAMES
    assert len({id(o.operation.cutter) for o in found.operations}) == 4
    for o in found.operations:
        fed = ~o.operation.rapid
        assert np.mean(o.removed) > 50.0
        assert np.nansum(o.seconds) > 0.0
        assert np.isfinite(o.seconds).all()
        assert 0.0 <= o.way[o.air].sum() < o.way[fed].sum()
        assert o.volume[o.operation.rapid].max() == 0.0
    left = np.array(found.blank_volumes) - np.sum([o.removed for o in found.operations], axis=0)
    assert left == pytest.approx(found.stock.volumes, abs=1e-6)


def test_the_volume_left_is_the_intended_one_within_the_grid_s_error(result, found):
    """A bundle is wrong by no more than the cells that the outline crosses, at most sqrt(2) L / p; along z, by its rays
    in the intended section exactly.
    """
    whole, box = result.job.part.whole, found.stock.box
    assert found.intended_volume == whole.volume
    outline = 2.0 * np.pi * (25.0 + 8.75) + 8 * 2.0 * (25.0 - 13.75) * 1.5
    bound = sqrt(2.0) * outline * box.pitch * 10.0
    assert np.abs(np.array(found.stock.volumes) - whole.volume).max() < bound
    assert np.mean(found.stock.volumes) == pytest.approx(whole.volume, rel=0.02)
    assert found.contour.mesh.volume == pytest.approx(whole.volume, rel=0.02)
    middle = box.rays(2).origin * [1.0, 1.0, 0.0] + [0.0, 0.0, -5.0]
    inside = int((whole.signed_distance(middle) < 0.0).sum())
    assert found.stock.volumes[2] == pytest.approx(10.0 * box.cell_area(2) * inside, abs=1e-6)


def test_what_differs_from_the_intended_solid_is_found_on_its_face(result, found):
    """The same stock held against other gears: no fillets, a smaller bore, a wider face, one tooth more."""
    whole = result.job.part.whole
    gear = whole.outline.gear

    def against(other):
        return {s.surface: s for s in beside_solid(other, found.stock)[0]}

    sharp = against(replace(whole, outline=GearOutline(gear, 0.0)))["root"]
    assert 0.1 < sharp.excess <= (sqrt(2.0) - 1.0) * 1.9
    assert sharp.overcut > -1e-3
    assert against(replace(whole, back=8.70))["bore"].overcut == pytest.approx(-0.05, abs=1e-6)
    wide = against(replace(whole, outline=GearOutline(replace(gear, facewidth=10.03), 1.9)))
    assert wide["bottom face"].overcut == pytest.approx(-0.03, abs=1e-9)
    more = against(replace(whole, outline=GearOutline(replace(gear, profile_shift=-0.01), 1.9)))
    assert more["root"].excess == pytest.approx(0.05, abs=0.01)
    assert more["left"].excess > 0.01


def test_faces_without_ends_are_doubted(result, found):
    nothing = [replace(k, lo=k.lo[:0], hi=k.hi[:0], first=0 * k.first, lo_segment=k.lo_segment[:0],
                       hi_segment=k.hi_segment[:0]) for k in found.stock.left]  # fmt: skip
    along_z = replace(found.stock, left=(*nothing[:2], found.stock.left[2]))
    figures, doubts = beside_solid(result.job.part.whole, along_z)
    assert len(doubts) == 1
    assert doubts[0].startswith("no ray of the whole part ends at left, right, root, tip, bore; a finer")
    assert [f.surface for f in figures if f.ends] == ["top face", "bottom face"]
    assert beside_solid(result.job.part.whole, replace(found.stock, left=tuple(nothing)))[1][0].startswith("no ray of")


def test_a_dry_run_counts_what_the_run_counts(result):
    counted = estimate(*load_scene("spur-external-complete", COARSE))
    assert counted["rays"] == result.counts["rays"] - result.counts["following_rays"]
