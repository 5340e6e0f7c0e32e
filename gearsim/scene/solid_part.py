"""Scenes of a solid part: a body with cuts, made from a blank by operations in sequence."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from gearsim.cutters.profile import Profile
from gearsim.geometry.solid import Shifted, Solid
from gearsim.machines.chain import Machine
from gearsim.scene.any_program import ProgramToolTable
from gearsim.scene.base import Scene
from gearsim.scene.bevel import Number
from gearsim.scene.blank_files import SavedTable, SolidFileTable
from gearsim.scene.catalogue import AnyRunMachine
from gearsim.scene.stock import AnyBlank, StockTable
from gearsim.scene.tables import Length, Table
from gearsim.surfaces.machined_solid import MachinedSolid
from gearsim.surfaces.part import Tolerance

_Point = tuple[Number, Number, Number]


class CutOutTable(Table):
    """An entry of [[surface.minus]]: a ``shape`` as in [stock.blank], its axis at ``at_mm`` (x, y)."""

    shape: AnyBlank
    at_mm: tuple[tuple[Number, Number], ...] = ((0.0, 0.0),)

    def build(self) -> list[Solid]:
        """One solid a place. Raises InputError as the shape does."""
        solid = self.shape.build()
        return [Shifted(solid, np.array([x, y, 0.0])) for x, y in self.at_mm]


class SolidTable(Table):
    """Table [surface] of kind ``solid-part``: a ``body`` less what is cut out of it."""

    kind: Literal["solid-part"]
    body: AnyBlank
    minus: tuple[CutOutTable, ...] = ()

    def build(self, tolerance_um: float) -> MachinedSolid:
        """Raises InputError for shapes that cannot be."""
        minus = tuple(solid for table in self.minus for solid in table.build())
        return MachinedSolid(self.body.build(), minus, Tolerance.both(tolerance_um))


class DrillTable(Table):
    """An entry of [[operations]] of kind ``drill``: holes along z at ``at_mm``, the tip down to ``bottom_mm``.

    The tool goes by rapid to ``clear_mm``, there in feed; with ``peck_mm`` it comes up again after every such step.
    """

    kind: Literal["drill"]
    name: str = "drilling"
    tool: int = 1
    at_mm: tuple[tuple[Number, Number], ...] = Field(min_length=1)
    clear_mm: Number
    bottom_mm: Number
    peck_mm: Length | None = None
    feed_mm_min: Length

    @model_validator(mode="after")
    def _goes_down(self) -> DrillTable:
        if not self.clear_mm > self.bottom_mm:
            raise ValueError(f"clear_mm {self.clear_mm:g} must be above bottom_mm {self.bottom_mm:g}")
        return self


class MillTable(Table):
    """An entry of [[operations]] of kind ``mill``: the tip along straight lines through ``points_mm``, axis along z."""

    kind: Literal["mill"]
    name: str = "milling"
    tool: int = 1
    points_mm: tuple[_Point, ...] = Field(min_length=2)
    clear_mm: Number
    feed_mm_min: Length

    @model_validator(mode="after")
    def _starts_above(self) -> MillTable:
        highest = max(z for _, _, z in self.points_mm)
        if not self.clear_mm > highest:
            raise ValueError(f"clear_mm {self.clear_mm:g} must be above all points, the highest at {highest:g}")
        return self


AnyOperation = Annotated[DrillTable | MillTable, Field(discriminator="kind")]


class SolidMetrologyTable(Table):
    """Table [metrology]: how far the machined part may lie off the intended one."""

    tolerance_um: Length


class SequenceScene(Scene):
    """A part made from a blank by operations in sequence, with tools by their numbers.

    A [machine] cuts nothing else: its travel, speeds and bodies are looked at.
    """

    stock: StockTable
    tools: tuple[ProgramToolTable, ...] = Field(min_length=1)
    machine: AnyRunMachine | None = None
    operations: tuple[Any, ...]

    @model_validator(mode="after")
    def _tools_are_there(self) -> SequenceScene:
        numbers = [tool.number for tool in self.tools]
        if len(set(numbers)) < len(numbers):
            raise ValueError(f"tools: numbers {numbers} must differ")
        for i, operation in enumerate(self.operations):
            if operation.tool not in numbers:
                listed = ", ".join(map(str, numbers))
                raise ValueError(f"operations.{i}.tool: got {operation.tool}; [[tools]] has {listed}")
        if self.stock.blank is None:
            raise ValueError("stock.blank: missing; it says what the part is made from")
        if self.stock.spaces != "one":
            raise ValueError(f"stock.spaces: got {self.stock.spaces!r}; only a bevel gear's spaces are; remove the key")
        return self

    def blank(self) -> Solid | None:
        """The blank where a shape says it; None where a file does."""
        blank = self.stock.blank
        return None if blank is None or isinstance(blank, SolidFileTable | SavedTable) else blank.build()

    def cutters(self) -> dict[int, Profile]:
        """The cutters by their numbers."""
        return {tool.number: tool.build() for tool in self.tools}

    def holders(self) -> dict[int, Profile]:
        """What stands above the cutters' flutes, where it is given, by their numbers."""
        nose = () if self.machine is None else self.machine.spindle_nose_mm
        return {tool.number: body for tool in self.tools if (body := tool.above(nose)) is not None}

    def controller(self) -> Machine | None:
        return None if self.machine is None else self.machine.build()

    def builders(self) -> tuple[Callable[[], object], ...]:
        return (self.blank, self.cutters, self.holders, self.controller)


class SolidScene(SequenceScene):
    """A solid part, its blank, and operations in sequence with tools by their numbers."""

    surface: SolidTable
    operations: tuple[AnyOperation, ...] = Field(min_length=1)
    metrology: SolidMetrologyTable

    def part(self) -> MachinedSolid:
        return self.surface.build(self.metrology.tolerance_um)

    def builders(self) -> tuple[Callable[[], object], ...]:
        return (self.part, *super().builders())
