"""A blank that does not hold the part, or differs from the part's own."""

from dataclasses import replace

import numpy as np
import pytest

from gearsim.geometry.wedge import Wedge
from gearsim.metrology.blank_check import outside
from gearsim.metrology.holder_check import HolderInspection
from gearsim.metrology.samples import sample_grid
from gearsim.metrology.stock_check import StockInspection, _judged, _none_near
from gearsim.metrology.stock_surfaces import SurfaceFigures, cut_ends, near_surface
from gearsim.processes.run import plan
from gearsim.scene import load_scene
from gearsim.scene.stock import CylinderTable
from gearsim.simulation.saved_blank import saved_solid
from gearsim.simulation.stock import blank_stock

BAR = 'stock.blank={kind="cylinder", diameter_mm=180.0, bottom_mm=-10.0, top_mm=60.0}'
CELLS = "stock.pitch_mm=8.0"


def planned(*overrides):
    job = plan(*load_scene("spiral-bevel-flank", (CELLS, "metrology.convergence=[]", *overrides)))
    return job, next(i for i in job.inspections if isinstance(i, StockInspection))


def bar(diameter, bottom, top):
    return CylinderTable(kind="cylinder", diameter_mm=diameter, bottom_mm=bottom, top_mm=top).build()


def found(job, blank, copies=1, known_to=0.0):
    flank = job.part.surfaces["convex"]
    return list(outside(sample_grid(flank.patch, 9, 9, 0.01), flank.tolerance, blank, copies, job.part, known_to))


def test_the_part_s_own_blank_and_a_bar_around_it_hold_all_surfaces():
    job, asked = planned()
    own = asked.blank
    for blank, copies in ((own, 1), (own, 33), (bar(180.0, -10.0, 60.0), 33), (Wedge(own, 0.0, np.pi / 33), 33)):
        assert found(job, blank, copies) == []


def test_a_blank_too_small_fails_by_as_much_as_is_missing():
    job, _ = planned()
    (told,) = found(job, bar(180.0, -40.0, 20.0))
    assert told.fails
    assert told.kind == "beyond_the_blank"
    assert told.depth_um == pytest.approx(-1e3 * (told.place_mm[2] - 20.0))


def test_a_saved_stock_lacks_what_it_misses_by_more_than_a_cell():
    """Its surface is joined between rays: within a cell nothing is known, and that is said."""
    job, asked = planned()
    whole, thin = (blank_stock(asked.box, solid) for solid in (asked.blank, bar(80.0, -40.0, 60.0)))
    again = replace(asked, saved=whole, blank=saved_solid(whole, "whole"))
    ((solid, known_to),) = again._begun_with()
    assert known_to == pytest.approx(3.0**0.5 * 8.0)
    assert found(job, solid)  # as if it were exact
    assert found(job, solid, known_to=known_to) == []
    assert found(job, saved_solid(thin, "thin"), known_to=known_to)
    assert again._remarks() == ("whether the saved stock holds the surfaces to be cut is known to 13.9 mm alone",)
    assert asked._remarks() == ()
    assert list(replace(again, intended=object())._begun_with()) == []  # all its ends are held against that


def test_a_blank_that_nothing_cuts_near_a_judged_surface_is_not_judged():
    job, asked = planned()
    far = blank_stock(asked.box, bar(180.0, -40.0, 0.0))
    none = [near_surface(sample_grid(s.patch, 5, 5, 0.01), cut_ends(far)) for s in job.part.surfaces.values()]
    (doubt,) = _none_near(none, job)
    assert "no cut end of the whole part's rays lies near a judged surface" in doubt
    assert _none_near([none[0]._replace(ends=1), *none[1:]], job) == ()


def test_a_surface_that_is_too_low_all_over_is_told_once():
    job, _ = planned()
    low = SurfaceFigures("convex", 9, -0.05, -0.02, np.zeros(3), np.zeros(3))
    (told,) = _judged(low, job.part.surfaces["convex"].tolerance, job)
    assert told.depth_um == pytest.approx(-50.0)


def test_holders_are_looked_at_in_the_blank_that_is_given():
    job, asked = planned(BAR, "holder.sections_mm=[[20.0, 20.0, 40.0]]")
    (holders,) = (i for i in job.inspections if isinstance(i, HolderInspection))
    assert holders.stock is asked.blank


@pytest.mark.parametrize(("spaces", "copies"), [("one", 1), ("all", 33), ("sector", 33)])
def test_holders_are_looked_at_in_the_whole_blank_in_all_spaces_that_are_cut(spaces, copies):
    job, _ = planned(f'stock.spaces="{spaces}"', "stock.pitch_mm=1.0", "holder.sections_mm=[[20.0, 20.0, 40.0]]")
    (holders,) = (i for i in job.inspections if isinstance(i, HolderInspection))
    assert (holders.stock, holders.copies) == (job.part.stock, copies)
