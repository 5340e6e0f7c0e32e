"""Scenes whose surfaces a motion generates: the intended surface is an envelope in closed form."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Literal

from pydantic import Field, model_validator

from gearsim.cutters.profile import Profile
from gearsim.machines.chain import Machine
from gearsim.scene.catalogue import AnyCutter, AnyMachine
from gearsim.scene.tables import Count, Length, Scene, Table

Number = Annotated[float, Field(gt=-1e5, lt=1e5, allow_inf_nan=False)]


class GeneratedMetrologyTable(Table):
    """Table [metrology]: what is measured; ``judged`` names the motions that the tolerance is for."""

    tolerance_um: Length
    judged: tuple[str, ...] = ()
    rows: Count = 21
    columns: Count = 129
    margin: float = Field(default=0.01, gt=0.0, lt=0.5)
    window: float = Field(default=1.0, gt=0.0, le=4.0)
    convergence: tuple[Count, ...] = ()


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


class AxisPointsTable(Table):
    """Table [toolpath] of an envelope scene: the NC program's points as axis values [mm, deg]."""

    axes: tuple[str, ...] = Field(min_length=3)
    points: tuple[tuple[Number, ...], ...] = Field(min_length=2)

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
