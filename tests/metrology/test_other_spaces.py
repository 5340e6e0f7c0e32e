"""The other spaces of a gear: asked where the first one's surfaces lie when turned, and told by one rule."""

import numpy as np
import pytest

from gearsim.metrology.gear_probing import probing
from gearsim.metrology.other_spaces import _turn
from gearsim.metrology.verdict import spaces_left
from tests.metrology.gears import gear_of

ALONE = "1 of 9 spaces is cut and judged: what indexing to the others adds is not in it"
ONE_ROAD = "{} of 9 spaces were measured by one road only"


@pytest.mark.parametrize(
    ("measured", "cut", "doubts", "remarks"),
    [
        (range(9), (), [], []),
        ((0,), (), [], [ALONE]),
        ((0,), range(1, 9), [], [ONE_ROAD.format(8)]),
        ((0,), (1, 2, 3, 5, 6, 7, 8), ["nothing cuts 1 of 9 spaces (5), though"], [ONE_ROAD.format(7)]),
        ((0,), (8,), ["nothing cuts 7 of 9 spaces (2, 3, 4, 5 and 3 more), though"], [ONE_ROAD.format(1)]),
        ((0, 1), (), ["nothing cuts 7 of 9 spaces (3, 4, 5, 6 and 3 more), though"], []),
        ((0, 1), range(2, 9), [], [ONE_ROAD.format(7)]),
    ],
)
def test_spaces_are_judged_if_all_are_cut_or_one_alone(measured, cut, doubts, remarks):
    found, told = spaces_left(9, measured, cut)
    assert len(found) == len(doubts)
    assert all(text.startswith(words) for text, words in zip(found, doubts, strict=True))
    assert told == remarks


@pytest.mark.parametrize("teeth", [15, -20])
def test_a_turned_space_is_the_one_of_its_number(teeth):
    gear = gear_of(teeth)
    for side in ("left", "right"):
        lines = probing(gear, side, (gear.root_roll, gear.tip_roll), 5)
        for space in (1, 7):
            turned, own = lines.rays(0).moved(_turn(space, gear.count)), lines.rays(space)
            np.testing.assert_allclose(turned.origin, own.origin, atol=1e-12)
            np.testing.assert_allclose(turned.direction, own.direction, atol=1e-13)
