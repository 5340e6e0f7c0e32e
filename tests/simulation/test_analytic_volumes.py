"""What is taken from a block or left of a bar, in closed form, against the sums of a tri-dexel's rays.

A sum over the middles of cells is off the volume by at most half a spacing times the surface seen across the rays, both
ways: so by less than a spacing times the surface. With the lattice anywhere the error falls with the spacing at least,
and where no wall runs along the rows with its power of 1.5.
"""

from math import factorial, pi, radians, tan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearsim.cutters.catalogue import apt
from gearsim.cutters.end_mills import ball, tapered
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.series import Series
from gearsim.geometry.solid import Block
from gearsim.geometry.turned import Turned
from gearsim.motion.sources import CLMotion, CurveMotion
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.operation import operation
from gearsim.simulation.stock import blank_stock, cut_stock
from gearsim.simulation.workshop import Workshop

BLOCK = Block(np.zeros(3), np.array([30.0, 20.0, 10.0]))
SLOPE = tan(radians(30.0))
FLAT = apt(4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 30.0)
BLANK = Turned(np.array([[4.0, 0.0], [16.0, 0.0], [16.0, 3.0], [9.0, 9.0], [4.0, 9.0]]))


def straight(*tips):
    return CLMotion(np.array(tips, dtype=float), np.tile([0.0, 0.0, 1.0], (len(tips), 1)))


def arc(height, angle):
    """About the block's middle, 6 mm from it; the exact arc."""

    def curve(at, order):
        turns = [at + 0.5 * pi * k for k in range(order + 1)]
        tip = [
            np.stack([6.0 * np.cos(a), 6.0 * np.sin(a), 0.0 * a], axis=-1) / factorial(k) for k, a in enumerate(turns)
        ]
        axis = np.zeros((order + 1, len(at), 3))
        axis[0, :, 2] = 1.0
        moved = np.array(tip)
        moved[0] += [15.0, 10.0, height]
        return PoseSeries(Series(moved), Series(axis))

    return CurveMotion(curve, 0.0, angle)


# cutter, motion, volume taken, more than the surface of what is taken, whether no wall runs along the rows
CASES = {
    "ball along a line": (ball(6.0, 30.0), straight((-5, 10, 6), (35, 10, 6)), 30 * (4.5 * pi + 6), 600.0, False),
    "ball along an arc": (ball(6.0, 30.0), arc(7.0, 2.0), 4.5 * pi * 12 + 18 * pi, 300.0, True),
    "torus groove": (ball(6.0, 30.0), arc(7.0, 2.0 * pi), 4.5 * pi * 12 * pi, 600.0, True),
    "cylinder plunge": (FLAT, straight((15, 10, 12), (15, 10, 4)), 24 * pi, 110.0, False),
    "cone sweep": (
        tapered(2.0, radians(30.0), 12.0), straight((8, 10, 5), (22, 10, 5)),
        14 * 5 * (2 + 5 * SLOPE) + pi / 3 * 5 * (1 + (1 + 5 * SLOPE) + (1 + 5 * SLOPE) ** 2), 500.0, False,
    ),
}  # fmt: skip


def box_around(solid, pitch, shift):
    lower, upper = solid.box
    return DexelBox(Rigid(np.eye(3), np.zeros(3)), lower - pitch * (1.0 + shift), upper + 2.0 * pitch, pitch)


def mean_squares(volumes, exact, surface, solid):
    """Root mean square of the error at two pitches, 1 and 0.25 mm, over lattices anywhere; none beyond its bound."""
    rng, found = np.random.default_rng(3), []
    for pitch in (1.0, 0.25):
        errors = np.array([volumes(box_around(solid, pitch, rng.uniform(size=3))) for _ in range(8)]) - exact
        assert np.abs(errors).max() < pitch * surface
        found.append(float(np.sqrt((errors**2).mean())))
    return found


@pytest.mark.parametrize("name", CASES)
def test_what_a_tool_takes_converges_to_the_closed_form(name):
    cutter, motion, exact, surface, curved = CASES[name]
    done, shop = operation(name, cutter, [motion], 1e-9), Workshop("cpu")

    def taken(box):
        blank = blank_stock(box, BLOCK)
        return np.subtract(blank.volumes, cut_stock(blank, [done], shop).volumes)

    coarse, fine = mean_squares(taken, exact, surface, BLOCK)
    assert fine < (coarse / 6.0 if curved else coarse / 3.0)


def test_a_gear_s_blank_converges_to_pappus_and_guldin():
    coarse, fine = mean_squares(lambda box: blank_stock(box, BLANK).volumes, BLANK.volume, 3000.0, BLANK)
    assert BLANK.volume == pytest.approx(pi * (16**2 * 3 + (16**2 + 16 * 9 + 9**2) * 2 - 4**2 * 9))
    assert fine < coarse / 3.0


@settings(max_examples=25, deadline=None)
@given(
    shift=st.tuples(*[st.sampled_from([0.0, 0.25, 0.5, 1e-9]) | st.floats(0.0, 1.0)] * 3),
    wall=st.sampled_from([0.0, 2.0, 5.0]) | st.floats(0.0, 8.0),
    floor=st.sampled_from([0.0, 2.5, 10.0]) | st.floats(0.0, 10.0),
)
def test_a_tool_tangent_to_faces_leaves_no_skin_and_no_gouge(shift, wall, floor):
    """A flat end mill along x, its wall on the block's side or within, its floor on bottom or top or between.

    The lattice lies anywhere or exactly on all of them; ends lie on what was cut, and nowhere else.
    """
    done = operation("slot", FLAT, [straight((-5.0, wall + 2.0, floor), (35.0, wall + 2.0, floor))], 1e-9)
    stock = cut_stock(blank_stock(box_around(BLOCK, 0.5, np.array(shift)), BLOCK), [done], Workshop("cpu"))
    planes = {0: (0.0, 30.0), 1: (0.0, 20.0, wall, wall + 4.0), 2: (0.0, 10.0, floor)}
    for axis, left in enumerate(stock.left):
        origin = stock.box.rays(axis).origin[left.ray]
        for ends in (left.lo, left.hi):
            at = origin[:, axis] + ends
            assert np.abs(at[:, None] - np.array(planes[axis])).min(axis=1, initial=9.0).max(initial=0.0) < 1e-8
        across = np.abs(origin[:, 1] - wall - 2.0) < 2.0 - 1e-6
        deep = origin[:, 2] > floor + 1e-6
        assert axis != 0 or not np.any(across & deep)  # rays within the slot hold nothing
        thin = 0.0 < floor < 1e-5 or 1e-5 > 10.0 - floor > 0.0 or 0.0 < wall < 1e-5  # what is really so thin
        assert thin or np.all(left.hi - left.lo > 1e-6)
