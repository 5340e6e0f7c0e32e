"""Table [stock]: the whole blank, cut operation after operation."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from gearsim.geometry.solid import Block, Solid
from gearsim.geometry.turned import Turned
from gearsim.scene.tables import Length, LengthOrZero, Table

_Coordinate = Annotated[float, Field(gt=-1e5, lt=1e5, allow_inf_nan=False)]
_Corner = tuple[_Coordinate, _Coordinate, _Coordinate]


class BlockTable(Table):
    """Table [stock.blank] of kind ``block``: a box along the part's axes."""

    kind: Literal["block"]
    lower_mm: _Corner
    upper_mm: _Corner

    def build(self) -> Solid:
        """Raises InputError for a box without an inside."""
        return Block(np.array(self.lower_mm), np.array(self.upper_mm))


class CylinderTable(Table):
    """Table [stock.blank] of kind ``cylinder``: a bar or tube about the part's z axis."""

    kind: Literal["cylinder"]
    diameter_mm: Length
    bore_mm: LengthOrZero = 0.0
    bottom_mm: _Coordinate
    top_mm: _Coordinate

    @model_validator(mode="after")
    def _has_an_inside(self) -> CylinderTable:
        if not self.top_mm > self.bottom_mm or not self.diameter_mm > self.bore_mm:
            raise ValueError("top_mm must be above bottom_mm, and diameter_mm larger than bore_mm")
        return self

    def build(self) -> Solid:
        inner, outer = 0.5 * self.bore_mm, 0.5 * self.diameter_mm
        low, high = self.bottom_mm, self.top_mm
        return Turned(np.array([[inner, low], [outer, low], [outer, high], [inner, high]]))


class TurnedTable(Table):
    """Table [stock.blank] of kind ``turned``: corners (radius, z) of its outline, once around."""

    kind: Literal["turned"]
    outline_mm: tuple[tuple[LengthOrZero, _Coordinate], ...] = Field(min_length=3)

    @model_validator(mode="after")
    def _holds_an_area(self) -> TurnedTable:
        corners = np.array(self.outline_mm)
        after = np.roll(corners, -1, axis=0)
        for i in np.flatnonzero((corners == after).all(axis=1)):
            raise ValueError(f"outline_mm: corner {i + 1} of {len(corners)} is the next one too; name each once")
        for i, j in _meeting(corners, after):
            raise ValueError(f"outline_mm: it meets itself, after corner {i + 1} and after corner {j + 1}")
        r, z = corners.T
        if not abs(float(r @ np.roll(z, -1) - z @ np.roll(r, -1))) > 1e-12:
            raise ValueError("outline_mm: its corners enclose no area")
        return self

    def build(self) -> Solid:
        return Turned(np.array(self.outline_mm, dtype=float))


def _meeting(start: NDArray, end: NDArray) -> NDArray:
    """Pairs (n, 2) of edges of an outline that meet and do not follow each other; the axis may be met."""
    way, n = end - start, len(start)

    def side(points: NDArray) -> NDArray:
        off = points - start[:, None]
        return np.sign(way[:, None, 0] * off[..., 1] - way[:, None, 1] * off[..., 0])

    parted = side(start) * side(end) <= 0.0
    lower, upper = np.minimum(start, end), np.maximum(start, end)
    near = (lower[:, None] <= upper).all(axis=-1) & (upper[:, None] >= lower).all(axis=-1)
    apart = np.subtract.outer(np.arange(n), np.arange(n)) % n
    solid = upper[:, 0] > 0.0
    other = (apart > 1) & (apart < n - 1) & solid & solid[:, None]
    return np.argwhere(np.triu(parted & parted.T & near & other))


AnyBlank = Annotated[BlockTable | CylinderTable | TurnedTable, Field(discriminator="kind")]


class StockTable(Table):
    """Table [stock]: a tri-dexel of the whole blank, cut by the scene's program; ``blank`` is the part's own if none.

    ``spaces``: whether the program of one tooth space is run once, or indexed to all; ``sector``: to all, but of the
    blank only one space's sector is looked at, since all are alike. ``rapid_mm_min``: the machine's rapid rate of the
    tip over the part; without it rapids take no known time.
    """

    pitch_mm: Length
    blank: AnyBlank | None = None
    spaces: Literal["one", "all", "sector"] = "one"
    rapid_mm_min: Length | None = None
