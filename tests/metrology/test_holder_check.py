"""Shanks and holders against what stands when they come by: pockets cut before, walls left, single moves."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from gearsim.cutters.catalogue import flat
from gearsim.cutters.holder import holder, standing_on
from gearsim.geometry.rays import RayBundle, join_rays
from gearsim.geometry.solid import Block
from gearsim.geometry.turned import Turned
from gearsim.metrology.holder_check import HolderInspection, Moves
from gearsim.metrology.indexed import tools_and_holders
from gearsim.metrology.inspection import perform
from gearsim.metrology.job import Job
from gearsim.motion.sources import CLMotion
from gearsim.simulation.operation import Variant, operation
from gearsim.simulation.workshop import Workshop
from gearsim.surfaces.part import Part

DISC = Turned(np.array([[0.0, -20.0], [40.0, -20.0], [40.0, 0.0], [0.0, 0.0]]))
MILL = flat(10.0, 5.0)
UP = [0.0, 0.0, 1.0]


def cut_by(held, paths, rapid=()):
    """A mill of 5 mm with something above it, along paths of tips."""
    sources = [CLMotion(np.array(p, dtype=float), np.tile(UP, (len(p), 1))) for p in paths]
    return Variant("program", "", (operation("mill", MILL, sources, 1e-9, rapid=rapid, holder=held),))


def finding(held, *paths, rapid=()):
    """What is told of the mill over a disc whose top is z = 0."""
    whole = cut_by(held, paths, rapid)
    part = Part("frame", DISC, {"top": SimpleNamespace(patch=SimpleNamespace(blank=None), tolerance=None)})
    job = Job("disc", part, (whole,), "program", ())
    reading = perform(HolderInspection("program", ()).steps(job), Workshop("cpu"))
    assert reading.doubts == ()
    return reading.findings[0] if reading.findings else None


def level(depth):
    """A slot across the disc."""
    return [[-60.0, 0.0, -depth], [60.0, 0.0, -depth]]


THIN, WIDE = holder(5.0, [(8.0, 8.0, 30.0)]), holder(5.0, [(8.0, 8.0, 3.0), (30.0, 40.0, 20.0)])


def test_a_shank_in_a_slot_cut_layer_by_layer_touches_nothing():
    assert finding(THIN, level(4.0), level(8.0), level(12.0)) is None


def test_a_shank_over_the_flutes_of_a_slot_cut_at_once_touches():
    found = finding(THIN, level(4.0), level(12.0))
    assert (found.kind, found.fails, found.patch) == ("holder_cut", True, "part")
    assert "the holder of mill touches material" in found.text
    assert found.place_mm[2] == pytest.approx(-7.0, abs=0.7)  # between the slot of before and the flutes' end


def test_a_holder_wider_than_the_slot_touches_as_soon_as_it_is_low_enough():
    """It begins 8 mm over the tip."""
    assert finding(WIDE, level(4.0), level(7.9)) is None
    assert finding(WIDE, level(4.0), level(8.3)) is not None


def test_a_holder_that_slides_on_the_top_face_touches_nothing():
    """Exactly flush; the rays stand on the face or lie just below it."""
    up, along = np.array([[x, y, -9.0] for x in (-20.0, 0.0, 15.0) for y in (-8.0, 0.0, 8.0)]), np.eye(3)
    flat_rays = np.array([[-30.0, y, 0.0] for y in (-8.0, 0.0, 8.0)])
    chords = join_rays([
        RayBundle(up, np.tile(along[2], (9, 1)), np.zeros(9), np.full(9, 9.0)),
        RayBundle(flat_rays, np.tile(along[0], (3, 1)), np.zeros(3), np.full(3, 60.0)),
    ])  # fmt: skip
    whole = cut_by(WIDE, [level(4.0), level(8.0)])
    holders = Variant("holders", "", (whole.operations[0].carried(1e-9),))
    assert perform(Moves.of(whole, holders).first_touch(chords), Workshop("cpu")) == (None, True)


def test_a_cutter_goes_ahead_of_its_shank_within_a_move():
    """Straight down by more than the flutes' length: the shank only follows."""
    assert finding(THIN, [[0.0, 0.0, 5.0], [0.0, 0.0, -12.0]]) is None
    wide = holder(5.0, [(10.5, 10.5, 30.0)])
    assert finding(wide, [[0.0, 0.0, 5.0], [0.0, 0.0, -12.0]]) is not None


def test_rapids_count_as_well_and_a_shank_as_wide_as_the_mill_only_rubs():
    assert finding(holder(5.0, [(10.0, 10.0, 30.0)]), level(4.0), level(8.0)) is None
    low = [[60.0, 0.0, -8.0], [60.0, 30.0, -8.0], [0.0, 30.0, -8.0]]
    assert finding(THIN, level(4.0), level(8.0), low, rapid=(False, False, True)) is not None


def test_the_order_of_the_moves_decides():
    """The deep slot first: its shank meets what the shallow one takes away too late."""
    assert finding(THIN, level(8.0), level(4.0)) is not None


def test_what_a_holder_does_keeps_the_columns_of_its_pieces():
    (whole,) = cut_by(THIN, [level(4.0), level(8.0)], rapid=(False, True)).operations
    carried = whole.carried(1e-9)
    assert carried.cutter is THIN
    assert np.array_equal(carried.rapid, np.array([False, True])[carried.table.path])
    assert set(whole.part(whole.table.path == 1).carried(1e-9).table.path.tolist()) == {1}
    with pytest.raises(ValueError, match="no holder"):
        carried.carried(1e-9)


@pytest.mark.parametrize(("longer", "touches"), [(-0.01, False), (1.0, True)])
def test_a_holder_one_millimetre_too_long_is_found_as_deep_and_one_that_is_clear_is_not(longer, touches):
    """Its lower face stands 8 mm over the tip, less what it is too long, and the tip 8 mm below the top."""
    held = holder(5.0, [(8.0, 8.0, 3.0 - longer), (30.0, 40.0, 20.0)])
    found = finding(held, *([[-9.0, 0.0, -z], [9.0, 0.0, -z]] for z in (4.0, 8.0)))
    assert (found is not None) == touches
    if touches:
        assert "the holder of mill touches material in move 1 of its path 2: it cuts 1 mm deep" in found.text


FLUTED = standing_on(flat(10.0, 30.0), 5.0, ())


def with_flutes(*paths):
    sources = [CLMotion(np.array(p, dtype=float), np.tile(UP, (len(p), 1))) for p in paths]
    whole = operation("mill", flat(10.0, 30.0), sources, 1e-9, holder=FLUTED)
    part = Part("frame", DISC, {"top": SimpleNamespace(patch=SimpleNamespace(blank=None), tolerance=None)})
    job = Job("disc", part, (Variant("program", "", (whole,)),), "program", ())
    return perform(HolderInspection("program", ()).steps(job), Workshop("cpu")).findings


@pytest.mark.parametrize(("depth", "touches"), [(5.0, False), (5.1, True)])
def test_a_cut_deeper_than_the_flutes_is_found_without_a_holder(depth, touches):
    """The cutter's upper part takes what its flutes, 5 mm high, do not reach."""
    found = with_flutes(level(depth))
    assert len(found) == touches
    if touches:
        assert "the upper part of mill touches material" in found[0].text
        assert "it cuts 0.1 mm deep" in found[0].text


def test_an_upper_part_as_thick_as_the_flutes_rubs_along_what_they_cut():
    assert with_flutes([[-9.0, 0.0, -5.0], [9.0, 0.0, -5.0]], [[-9.0, 0.0, -9.0], [9.0, 0.0, -9.0]]) == ()


def test_what_a_program_does_in_all_spaces_is_done_one_operation_after_the_other():
    first, second = cut_by(THIN, [level(4.0), level(5.0)]), cut_by(THIN, [level(8.0)])
    late = replace(second.operations[0], step=second.operations[0].step + 2)
    cutters, holders = tools_and_holders(Variant("program", "", (*first.operations, late)), 3)
    steps = [sorted(set(o.step.tolist())) for o in cutters]
    assert [len(s) for s in steps] == [6, 3]
    assert max(steps[0]) < min(steps[1])
    assert [o.step.tolist() for o in holders] == [o.step.tolist() for o in cutters]
    assert all(o.cutter is THIN for o in holders)


def test_it_is_told_in_which_space_a_holder_touches():
    """A quarter turn on there stands a block that the program of the first space does not come to."""
    whole = cut_by(WIDE, [[[20.0, 0.0, 1.0], [30.0, 0.0, 1.0]]])
    aside = Block(np.array([-5.0, 20.0, 0.0]), np.array([5.0, 30.0, 9.5]))
    job = Job("disc", Part("frame", DISC, {}), (whole,), "program", ())
    for copies, told in ((1, 0), (4, 1)):
        found = perform(
            HolderInspection("program", (), stock=aside, copies=copies).steps(job), Workshop("cpu")
        ).findings
        assert len(found) == told
    assert "touches material in move 1 of its path 1, space 2: it cuts 3.5 mm deep" in found[0].text
