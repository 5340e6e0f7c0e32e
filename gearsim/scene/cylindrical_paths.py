"""Tables [[tools]] and [toolpath] of a cylindrical gear: tools, and what is done with which of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import radians
from typing import Annotated, Any

from pydantic import Field, model_validator

from gearsim.errors import InputError
from gearsim.programs.operation import Tool
from gearsim.scene.holder import HolderTable
from gearsim.scene.tables import Length, Table
from gearsim.surfaces.flank_modification import FlankModification
from gearsim.toolpaths.cylindrical.settings import (
    Bore,
    Clearance,
    Cutting,
    Facing,
    Finishing,
    OutsideDiameter,
    ReferenceRing,
    RootMilling,
    Roughing,
    Settings,
    Slotting,
)

Share = Annotated[float, Field(gt=0.0, le=1.0)]


class EndMillTable(Table):
    """An entry of the tool table: a cylindrical end mill, by its T number.

    ``length_mm``: so far over its tip it goes on, as thick as its flutes.
    """

    number: int = Field(default=1, ge=1, le=99_999_999)
    name: str = "end mill"
    diameter_mm: Length
    flute_length_mm: Length
    length_mm: Length | None = None
    flutes: int = Field(ge=1, le=20)
    holder: HolderTable | None = None

    def build(self) -> Tool:
        return Tool(self.number, self.name, self.diameter_mm, self.flute_length_mm, self.flutes)


class ClearanceTable(Table):
    """Table [toolpath.clearance]: how far rapids keep off the tip cylinder and the top face."""

    rim_mm: Length = 5.0
    top_mm: Length = 5.0


class CuttingTable(Table):
    """What tables of operations share: the tool and its conditions."""

    tool: int = Field(default=1, ge=1)
    spindle_rpm: Length = 12000.0
    feed_per_tooth_mm: Length = 0.0508

    def cutting(self, tools: dict[int, Tool], name: str) -> Cutting:
        """The tool and its conditions; ``name`` is the table's. Raises InputError for a tool that is not among them."""
        if self.tool not in tools:
            there = ", ".join(map(str, sorted(tools)))
            raise InputError(f"toolpath.{name}.tool: no tool {self.tool} (1 where none is named); tools has {there}")
        return Cutting(tools[self.tool], self.spindle_rpm, self.feed_per_tooth_mm)

    def build(self, **common: Any) -> Settings:
        """What the operation is told; ``common``: cutting and clearance."""
        raise NotImplementedError


class TeethTable(CuttingTable):
    """Passes along the flanks; a step along the involute in mm of its arc or in degrees of roll."""

    axial_step_mm: Length = 1.0
    involute_step_mm: Length | None = None
    involute_step_deg: float | None = Field(default=None, gt=0.0, lt=90.0)

    @model_validator(mode="after")
    def _one_step(self) -> TeethTable:
        if self.involute_step_mm is not None and self.involute_step_deg is not None:
            raise ValueError("give involute_step_mm (of arc) or involute_step_deg (of roll), not both")
        return self

    def steps(self) -> dict[str, Any]:
        if self.involute_step_deg is not None:
            return {"axial_step": self.axial_step_mm, "involute_step": radians(self.involute_step_deg),
                    "spacing": "roll"}  # fmt: skip
        return {"axial_step": self.axial_step_mm, "involute_step": self.involute_step_mm or 1.0, "spacing": "arc"}


class RoughingTable(TeethTable):
    """Table [toolpath.roughing]: layers of stock, down to ``stock_mm`` on the flanks."""

    radial_immersion: Share = 0.25
    stock_mm: Length = 0.1

    def build(self, **common: Any) -> Roughing:
        return Roughing(radial_immersion=self.radial_immersion, stock=self.stock_mm, **self.steps(), **common)


class FinishingTable(TeethTable):
    """Table [toolpath.finishing]: one layer, the flank itself."""

    axial_step_mm: Length = 0.5
    feed_per_tooth_mm: Length = 0.0254

    def build(self, **common: Any) -> Finishing:
        return Finishing(**self.steps(), **common)


class SlotsTable(CuttingTable):
    """Table [toolpath.slots]: radial slots in the spaces of an external gear, ``root_stock_mm`` left above its root."""

    radial_immersion: Share = 0.25
    radial_step_mm: Length = 1.0
    stock_mm: Length = 0.1
    root_stock_mm: Length | None = None

    def build(self, **common: Any) -> Slotting:
        return Slotting(
            radial_immersion=self.radial_immersion, radial_step=self.radial_step_mm, stock=self.stock_mm,
            root_stock=self.root_stock_mm, **common,
        )  # fmt: skip


class RootTable(CuttingTable):
    """Table [toolpath.root]: root land and fillets of an external spur gear, along their outline."""

    axial_step_mm: Length = 1.0

    def build(self, **common: Any) -> RootMilling:
        return RootMilling(axial_step=self.axial_step_mm, **common)


class LevelsTable(CuttingTable):
    """What operations on the blank share: levels ``axial_step_mm`` apart, in layers."""

    radial_immersion: Share = 0.25
    axial_step_mm: Length = 1.0

    def steps(self) -> dict[str, Any]:
        return {"axial_step": self.axial_step_mm, "radial_immersion": self.radial_immersion}


class FacingTable(LevelsTable):
    """Table [toolpath.facing]: the top face."""

    radius_mm: Length
    allowance_mm: Length = 1.0

    def build(self, **common: Any) -> Facing:
        return Facing(self.radius_mm, self.allowance_mm, **self.steps(), **common)


class BoreTable(LevelsTable):
    """Table [toolpath.bore]: the centre bore, or an internal gear hogged out to its tip circle."""

    radius_mm: Length
    depth_mm: Length

    def build(self, **common: Any) -> Bore:
        return Bore(self.radius_mm, self.depth_mm, **self.steps(), **common)


class OutsideTable(LevelsTable):
    """Table [toolpath.outside]: the outside diameter."""

    blank_radius_mm: Length
    radius_mm: Length
    depth_mm: Length

    def build(self, **common: Any) -> OutsideDiameter:
        return OutsideDiameter(self.blank_radius_mm, self.radius_mm, self.depth_mm, **self.steps(), **common)


class RingTable(LevelsTable):
    """Table [toolpath.ring]: a reference ring in the top face."""

    inner_mm: Length
    outer_mm: Length
    depth_mm: Length

    def build(self, **common: Any) -> ReferenceRing:
        return ReferenceRing(self.inner_mm, self.outer_mm, self.depth_mm, **self.steps(), **common)


_OPERATIONS = ("facing", "outside", "bore", "ring", "slots", "root", "roughing", "finishing")


class GearPathTable(Table):
    """Table [toolpath]: the operations done, in the order in which they stand here."""

    clearance: ClearanceTable = ClearanceTable()
    facing: FacingTable | None = None
    outside: OutsideTable | None = None
    bore: BoreTable | None = None
    ring: RingTable | None = None
    slots: SlotsTable | None = None
    root: RootTable | None = None
    roughing: RoughingTable | None = None
    finishing: FinishingTable = FinishingTable()

    def settings(
        self, tools: Sequence[EndMillTable], design: FlankModification | None, fillet: float | None
    ) -> tuple[Settings, ...]:
        """What each operation is told, finishing last; ``fillet`` [mm] of the roots.

        Raises InputError for unknown or doubled tools.
        """
        table = {t.number: t.build() for t in tools}
        if len(table) < len(tools):
            raise InputError("tools: two tools share a number")
        clear = Clearance(self.clearance.rim_mm, self.clearance.top_mm)
        asked = [(name, op) for name in _OPERATIONS if (op := getattr(self, name)) is not None]
        made = [op.build(cutting=op.cutting(table, name), clearance=clear) for name, op in asked]
        assert isinstance(made[-1], Finishing)
        made = [replace(step, fillet=fillet) if isinstance(step, RootMilling) else step for step in made]
        return (*made[:-1], replace(made[-1], modification=design))
