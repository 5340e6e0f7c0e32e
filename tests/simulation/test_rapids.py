"""Rapids through material: which rows are clear for certain, and grazes of hundredths seen as the stock stands."""

import numpy as np
import pytest

from gearsim.cutters.end_mills import ball, flat
from gearsim.geometry.solid import Block
from gearsim.motion.sources import CLMotion
from gearsim.simulation.near import rows_near
from gearsim.simulation.operation import operation
from gearsim.simulation.rapids import look_at_rapids
from gearsim.simulation.sequence import whole_box
from gearsim.simulation.stock import blank_stock
from gearsim.simulation.workshop import Workshop

BLOCK = Block(np.zeros(3), np.array([30.0, 20.0, 10.0]))


def moves(cutter, *ways, rapid):
    sources = [CLMotion(np.array(w, dtype=float), np.tile([0.0, 0.0, 1.0], (len(w), 1))) for w in ways]
    return operation("moves", cutter, sources, 1e-9, rapid=rapid)


def looked(*arguments, rapid, pitch=0.5):
    box = whole_box(BLOCK, pitch)
    return look_at_rapids(BLOCK, blank_stock(box, BLOCK), moves(*arguments, rapid=rapid), Workshop("cpu"))


def over(z):
    return [(-9, 6, z), (39, 6, z)]


@pytest.mark.parametrize(("z", "touches"), [(9.95, True), (10.0, False), (10.01, False)])
@pytest.mark.parametrize("cutter", [flat(4.0, 30.0), ball(8.0, 30.0)], ids=["flat", "ball"])
def test_a_rapid_that_grazes_the_top_by_five_hundredths_is_found_and_one_that_slides_on_it_is_not(cutter, z, touches):
    touch, near = looked(cutter, over(z), rapid=[True])
    assert near > 0
    assert (touch is not None) == touches
    if touch is not None:
        assert touch.place[2] == pytest.approx(9.975, abs=0.0251)
        assert touch.row == 0


def test_a_rapid_in_what_a_feed_before_it_cut_touches_nothing_and_beside_it_does():
    slot, back, aside = over(5.0), over(5.0)[::-1], [(-9, 6.05, 5), (39, 6.05, 5)]
    assert looked(flat(4.0, 30.0), slot, back, rapid=[False, True]).touch is None
    assert looked(flat(4.0, 30.0), back, slot, rapid=[True, False]).touch.row == 0
    touch = looked(flat(4.0, 30.0), slot, aside, rapid=[False, True], pitch=0.25).touch
    assert touch.row == 1
    assert touch.place[1] == pytest.approx(8.025, abs=0.026)


def test_rows_that_stay_away_are_clear_for_certain_and_no_other_is():
    """By a tenth of a millimetre beside the block, across it, through a corner that its middle is far from."""
    mill = flat(4.0, 30.0)
    beside = [(-9, -2.1, 5), (39, -2.1, 5)]
    corner = [(-40, 14.97, 2), (6, 22.97, 2)]
    table = moves(mill, over(10.0), over(41.0), beside, corner, over(-20.01), rapid=()).table
    assert rows_near(table, mill, BLOCK)[[0, 1, 3, 4]].tolist() == [True, False, True, True]
    assert not rows_near(moves(mill, [(-9, -5, 5), (39, -5, 5)], rapid=()).table, mill, BLOCK).any()
