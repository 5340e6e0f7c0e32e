"""A part on its way from the blank: the true stock after every few rows of its operations, with its surface."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.solid import Solid
from gearsim.simulation.contour.surface import Contour, contour
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.ends import Normals
from gearsim.simulation.normals import EndNormals
from gearsim.simulation.operation import Operation
from gearsim.simulation.saved_blank import with_earlier
from gearsim.simulation.stock import Done, Stock, blank_stock, cut_stock, turn_stock
from gearsim.simulation.turning import Turning
from gearsim.simulation.workshop import Workshop

_FEWEST = 2  # of an operation


class Stage(NamedTuple):
    """The ``stock`` once so many ``rows`` of an ``operation``, by its number (-1: the blank itself), are done."""

    stock: Stock
    contour: Contour
    operation: int
    rows: int


@dataclass(frozen=True)
class Way:
    """Operations done one after the other to a ``blank``, seen by the tri-dexel of a box, to be looked at in between.

    ``stops``: of each operation the rows, rising, after which it is looked at, the last of them all its rows.
    ``saved``: the stock in that box that they go on from, exactly. ``turning`` comes before the first stage.
    """

    blank: Solid
    box: DexelBox
    operations: Sequence[Operation]
    stops: Sequence[NDArray[np.integer]]
    turning: Turning | None = None
    saved: Stock | None = None

    def __len__(self) -> int:
        """Stages, that of the blank included."""
        return 1 + sum(map(len, self.stops))

    def stages(self, workshop: Workshop) -> Iterator[Stage]:
        """Stage after stage, the blank first. Raises NumericalError where a status forbids trust."""
        stock, makers = self.saved or blank_stock(self.box, self.blank), list[Operation | Solid](self.operations)
        if self.turning:
            stock = turn_stock(stock, self.turning.kept, self.turning.name)
            makers.insert(0, self.turning.kept)
        normals: Normals = EndNormals(self.blank, makers, workshop.device, workshop.tolerance)
        if self.saved:
            normals = with_earlier(self.saved, normals)
        yield Stage(stock, contour(stock, normals), -1, 0)
        for number, (operation, stops) in enumerate(zip(self.operations, self.stops, strict=True)):
            before, done = stock.done, 0
            for stop in map(int, stops):
                first = stock.next_tag - done
                stock = cut_stock(stock, [operation.part(np.arange(done, stop))], workshop)
                done = stop
                stock = replace(stock, done=(*before, Done(operation.name, done, first)))
                yield Stage(stock, contour(stock, normals), number, done)


def even_stops(operations: Sequence[Operation], count: int) -> list[NDArray[np.integer]]:
    """About so many stops in all, after even ways of the tip in feed; at least two an operation that has the rows."""
    ways = [np.where(o.rapid, 0.0, np.linalg.norm(tip_end(o) - tip_end(o, -1.0), axis=1)) for o in operations]
    total = sum(float(w.sum()) for w in ways)
    return [_stops(way, max(_FEWEST, round(count * float(way.sum()) / total) if total > 0.0 else 0)) for way in ways]


def _stops(way: NDArray, count: int) -> NDArray:
    gone = np.cumsum(way)
    wanted = gone[-1] * np.arange(1, count) / count
    return np.unique(np.append(np.minimum(np.searchsorted(gone, wanted) + 1, len(way)), len(way)))


def tip_end(operation: Operation, x: float = 1.0) -> NDArray:
    """Where the tip is at an end of each row [mm], shape (rows, 3): the last, or with -1 the first."""
    return _at(operation.table.tip, x)


def axis_end(operation: Operation) -> NDArray:
    """The tool's axis at the end of each row, shape (rows, 3)."""
    return _at(operation.table.axis, 1.0)


def _at(coefficients: NDArray, x: float) -> NDArray:
    return np.asarray((coefficients * x ** np.arange(coefficients.shape[1])[:, None]).sum(axis=1))
