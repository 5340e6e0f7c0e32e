"""Scenes whose surfaces a motion generates: the intended surface is an envelope in closed form."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

from pydantic import Field, model_validator

from gearsim.cutters.profile import Profile
from gearsim.machines.chain import Machine
from gearsim.scene.base import Scene
from gearsim.scene.bevel import BevelBlankTable, GeneratorTable, HypoidBlankTable, Number, ToothTable
from gearsim.scene.catalogue import AnyCutter, AnyMachine
from gearsim.scene.tables import Count, FileName, GridTable, Length, Table
from gearsim.scene.tool_errors import FaceMillingErrorsTable, HypoidErrorsTable, require_one_space
from gearsim.surfaces.face_milled import FaceMilledTooth
from gearsim.surfaces.hypoid import HypoidPinion
from gearsim.surfaces.patch import SIDES, Side


class GeneratedMetrologyTable(GridTable):
    """Table [metrology]: what is measured; ``judged`` names the motions that the tolerance is for."""

    tolerance_um: Length
    judged: tuple[str, ...] = ()
    rows: Count = 21
    columns: Count = 129
    margin: float = Field(default=0.01, gt=0.0, lt=0.5)
    window: float = Field(default=1.0, gt=0.0, le=4.0)
    convergence: tuple[Count, ...] = ()


class ToothMetrologyTable(GeneratedMetrologyTable):
    """Table [metrology] of a generated tooth: ``tooth`` is what its blank is held against."""

    tooth: ToothTable = ToothTable()


class GeneratedScene(Scene):
    """What scenes of generated surfaces share."""

    cutter: AnyCutter
    metrology: GeneratedMetrologyTable

    def tool(self) -> Profile:
        profile: Profile = self.cutter.build()
        return profile


class EnvelopeFlankTable(Table):
    """One side of the swept tool: left or right of the feed, as seen with the shank up."""

    name: str = Field(min_length=1)
    side: Literal["left", "right"]


class EnvelopeTable(Table):
    """Table [surface] of kind ``envelope``: the tool's own envelope, measured as the scene names its flanks."""

    kind: Literal["envelope"]
    flanks: tuple[EnvelopeFlankTable, ...] = Field(min_length=1)
    window_mm: Length = 2.0

    @model_validator(mode="after")
    def _one_name_a_flank(self) -> EnvelopeTable:
        names = [flank.name for flank in self.flanks]
        if len(set(names)) < len(names):
            raise ValueError(f"flanks: names {names} must differ")
        return self


class AxisPointsTable(Table):
    """Table [toolpath] of an envelope scene: one NC step, tip position [mm] and rotary axes [deg] at both ends."""

    axes: tuple[str, ...] = Field(min_length=3)
    points: tuple[tuple[Number, ...], ...] = Field(min_length=2, max_length=2)

    @model_validator(mode="after")
    def _one_value_an_axis(self) -> AxisPointsTable:
        for i, point in enumerate(self.points):
            if len(point) != len(self.axes):
                raise ValueError(f"point {i + 1} has {len(point)} values for {len(self.axes)} axes")
        return self


class EnvelopeScene(GeneratedScene):
    """A tool moved along an NC program, as theory, CL data and both ways of interpolation see it."""

    surface: EnvelopeTable
    machine: AnyMachine
    toolpath: AxisPointsTable

    def controller(self) -> Machine:
        machine: Machine = self.machine.build()
        return machine

    def builders(self) -> tuple[Callable[[], object], ...]:
        return (self.tool, self.controller)


class FaceMilledTable(BevelBlankTable):
    """Table [surface] of kind ``face-milled``: blank of a face-milled spiral bevel gear.

    ``generated`` false: cradle and work stand still and the head plunges (Formate).
    """

    kind: Literal["face-milled"]
    generated: bool = True

    def tooth(self, head: Profile, generator: GeneratorTable) -> FaceMilledTooth:
        """The slot that a head leaves. Raises InputError for another tool."""
        return FaceMilledTooth(self.blank(), head, generator.build(), self.generated)


class FaceMillingScene(GeneratedScene):
    """One slot of a spiral bevel gear cut by a head on a cradle generator."""

    surface: FaceMilledTable
    metrology: ToothMetrologyTable
    generator: GeneratorTable
    errors: FaceMillingErrorsTable = FaceMillingErrorsTable()

    @model_validator(mode="after")
    def _errors_that_act(self) -> FaceMillingScene:
        require_one_space(self.errors, self.stock)
        if not self.surface.generated and self.errors.generator.ratio_of_roll:
            raise ValueError("errors.generator.ratio_of_roll: nothing rolls (surface.generated = false); remove it")
        return self

    def tooth(self) -> FaceMilledTooth:
        return self.surface.tooth(self.tool(), self.generator)

    def real(self) -> FaceMilledTooth:
        """The slot's head and settings with their errors. Raises InputError where nothing could cut so."""
        return self.errors.real(self.tooth(), self.cutter)

    def builders(self) -> tuple[Callable[[], object], ...]:
        return (self.tooth, self.real) if self.errors.acting() else (self.tooth,)


class HeadTable(Table):
    """Table [convex]: a head and settings of its own for the convex flank."""

    cutter: AnyCutter
    generator: GeneratorTable


class HypoidTable(HypoidBlankTable):
    """Table [surface] of kind ``hypoid-pinion``."""

    kind: Literal["hypoid-pinion"]

    def pinion(self, head: Profile, generator: GeneratorTable, convex: HeadTable | None) -> HypoidPinion:
        """The slot that one head leaves, or one for each flank. Raises InputError where they do not fit."""
        blank = self.blank()
        concave = FaceMilledTooth(blank, head, generator.build())
        if convex is None:
            return HypoidPinion(concave, concave)
        return HypoidPinion(concave, FaceMilledTooth(blank, convex.cutter.build(), convex.generator.build()))


class RollTable(Table):
    """Table [toolpath] of a generated tooth: how the roll is handed to six-axis machines."""

    rows: Count = 65
    decimals: int = Field(default=6, ge=3, le=12)


class HypoidScene(GeneratedScene):
    """A hypoid pinion generated by roll, and cut from the axis values of six-axis machines."""

    surface: HypoidTable
    metrology: ToothMetrologyTable
    generator: GeneratorTable
    convex: HeadTable | None = None
    machine: dict[FileName, AnyMachine]
    toolpath: RollTable = RollTable()
    errors: HypoidErrorsTable = HypoidErrorsTable()

    @model_validator(mode="after")
    def _errors_that_act(self) -> HypoidScene:
        require_one_space(self.errors, self.stock)
        if self.convex is None and self.errors.convex.acting():
            raise ValueError("errors.convex: one head cuts both flanks; give [convex] or remove the table")
        return self

    def pinion(self) -> HypoidPinion:
        return self.surface.pinion(self.tool(), self.generator, self.convex)

    def real(self) -> dict[Side, FaceMilledTooth]:
        """Each flank's head and settings with their errors. Raises InputError where nothing could cut so."""
        pinion = self.pinion()
        found: dict[Side, FaceMilledTooth] = {s: self.errors.real(pinion.cut(s), self.cutter) for s in SIDES}
        if self.convex is not None:
            found["convex"] = self.errors.convex.real(pinion.convex, self.convex.cutter)
        return found

    def machines(self) -> dict[str, Machine]:
        return {name: table.build() for name, table in self.machine.items()}

    def builders(self) -> tuple[Callable[[], object], ...]:
        return (self.pinion, self.machines, *[self.real] * bool(self.errors.acting()))
