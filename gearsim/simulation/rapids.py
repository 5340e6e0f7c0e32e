"""Rapid moves through the stock as it stands when they come by, seen by all rays of a tri-dexel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rays import RayBundle
from gearsim.geometry.solid import Solid
from gearsim.simulation.intervals import IntervalSet, chosen, subtract
from gearsim.simulation.near import rows_near
from gearsim.simulation.operation import Operation
from gearsim.simulation.stock import AXES, Stock, cut_stock, material_rays
from gearsim.simulation.work import RapidTouch
from gearsim.simulation.workshop import Workshop

_SEEN_MM = 1e-6


class RapidLook(NamedTuple):
    """The ``touch`` of an operation's rapids, and how many of its rows by rapid might touch the uncut blank at all."""

    touch: RapidTouch | None
    near: int


def look_at_rapids(blank: Solid | None, stock: Stock, operation: Operation, workshop: Workshop) -> RapidLook:
    """Hold an operation's rapids against a ``stock`` of a blank on which it is about to be carried out.

    Rows that are clear of the uncut blank are, for certain (none are where it is None, known by its rays alone). The
    others are run through all rays as they stand before the operation; on those that lose anything the rows are told
    apart in their order, feeds included. Raises NumericalError where a status forbids trust.
    """
    fast = np.flatnonzero(operation.rapid)
    rapids = operation.part(fast)
    near = fast if blank is None else fast[rows_near(rapids.table, rapids.cutter, blank)]
    if not len(near):
        return RapidLook(None, 0)
    after = cut_stock(stock, [operation.part(near)], workshop)
    looks = [_Rays.less(stock, after, axis) for axis in AXES]
    looks = [look for look in looks if len(look.rays)]
    rows = _first_takers(looks, operation, near, workshop)
    return RapidLook(_first_touch(looks, operation, rows, workshop), len(near))


@dataclass(frozen=True)
class _Rays:
    """Some rays, and what stands on them."""

    rays: RayBundle
    left: IntervalSet

    @classmethod
    def less(cls, before: Stock, after: Stock, axis: int) -> _Rays:
        """Those of a bundle on which there is less after than before."""
        lengths = [_lengths(stock.left[axis]) for stock in (before, after)]
        some = np.flatnonzero(lengths[0] - lengths[1] > _SEEN_MM)
        return cls(material_rays(before, axis).part(some), chosen(before.left[axis], some))

    def without(self, operation: Operation, workshop: Workshop) -> _Rays:
        return _Rays(self.rays, subtract(self.left, workshop.cut([(self.rays, [operation])])[0]))

    def lost(self, operation: Operation, workshop: Workshop) -> IntervalSet:
        """What an operation takes of it."""
        return subtract(self.left, self.without(operation, workshop).left)


def _lengths(left: IntervalSet) -> NDArray[np.floating]:
    """Of every ray the length [mm] of its material."""
    return np.bincount(left.ray, left.hi - left.lo, minlength=len(left.first) - 1).astype(float)


def _first_takers(looks: list[_Rays], operation: Operation, near: NDArray, workshop: Workshop) -> list[int]:
    """The rapid rows that are the first to take something; of a ring, whose rows are not cut in order, all in question.

    Lengths below rounding are no matter: what such a row takes is looked at again.
    """
    if operation.cutter.is_ring or not looks:
        return near.tolist() if looks else []
    length = sum(workshop.cut_in_order(look.rays, look.left, operation).length for look in looks)
    return near[np.asarray(length)[near] > 0.0].tolist()


def _first_touch(looks: list[_Rays], operation: Operation, rows: list[int], workshop: Workshop) -> RapidTouch | None:
    """The first of some rows that takes more than rounding of what all rows before it have left."""
    done = 0
    for row in rows:
        if row > done:
            before = operation.part(np.arange(done, row))
            looks = [look.without(before, workshop) for look in looks]
        done = row
        touch = _deepest(looks, operation, row, workshop)
        if touch.depth > _SEEN_MM:
            return touch
    return None


def _deepest(looks: list[_Rays], operation: Operation, row: int, workshop: Workshop) -> RapidTouch:
    """Where a row goes through most of what is left, along a ray, and how far."""
    place, most = np.zeros(3), 0.0
    for look in looks:
        lost = look.lost(operation.part(np.array([row])), workshop)
        length = lost.hi - lost.lo
        if length.max(initial=0.0) > most:
            i = int(np.argmax(length))
            most, middle = float(length[i]), 0.5 * (lost.lo[i] + lost.hi[i])
            place = look.rays.origin[lost.ray[i]] + middle * look.rays.direction[lost.ray[i]]
    return RapidTouch(row, place, most)
