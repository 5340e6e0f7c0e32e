"""Table [stock]: the whole blank, cut operation after operation."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from gearsim.geometry.solid import Block, Solid
from gearsim.geometry.turned import Turned
from gearsim.scene.blank_files import SavedTable, SolidFileTable
from gearsim.scene.outline import Coordinate, Outline
from gearsim.scene.tables import Length, LengthOrZero, Table
from gearsim.scene.turning import TurningTable

_Corner = tuple[Coordinate, Coordinate, Coordinate]


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
    bottom_mm: Coordinate
    top_mm: Coordinate

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
    outline_mm: Outline

    def build(self) -> Solid:
        return Turned(np.array(self.outline_mm, dtype=float))


AnyBlank = Annotated[BlockTable | CylinderTable | TurnedTable, Field(discriminator="kind")]
AnyStock = Annotated[
    BlockTable | CylinderTable | TurnedTable | SolidFileTable | SavedTable, Field(discriminator="kind")
]


class StockTable(Table):
    """Table [stock]: a tri-dexel of the whole blank, cut by the scene's program; ``blank`` is the part's own if none.

    ``spaces``: whether the program of one tooth space is run once, or indexed to all; ``sector``: to all, but of the
    blank only one space's sector is looked at, since all are alike. ``rapid_mm_min``: the machine's rapid rate of the
    tip over the part; without it rapids take no known time. ``pitch_mm`` may be left out where the blank is a stock
    that was saved, which has one.
    """

    pitch_mm: Length | None = None
    blank: AnyStock | None = None
    turning: TurningTable | None = None
    spaces: Literal["one", "all", "sector"] = "one"
    rapid_mm_min: Length | None = None

    @model_validator(mode="after")
    def _has_a_pitch(self) -> StockTable:
        if self.pitch_mm is None and not isinstance(self.blank, SavedTable):
            raise ValueError("pitch_mm: missing; it is the ray spacing of the tri-dexel")
        return self
