"""Scenes of any surface cut by a program of the user's own: G-code or CL data, by one tool or several."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import PurePath
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.geometry.rigid import Rigid
from gearsim.machines.chain import Machine
from gearsim.programs.gcode import ReadSettings
from gearsim.scene.bevel import Number
from gearsim.scene.catalogue import AnyCutter, AnyMachine
from gearsim.scene.cylindrical import CylindricalGearTable
from gearsim.scene.flank_milling import FaceMilledFlankTable, RuledBevelTable
from gearsim.scene.program import ControlTable, OffsetName
from gearsim.scene.sculptured import NurbsTable
from gearsim.scene.tables import Count, GridTable, Length, Scene, Table

GCODE = frozenset((".nc", ".ngc", ".tap", ".cnc", ".mpf", ".eia", ".gcode", ".ncc"))
AnySurface = Annotated[
    RuledBevelTable | FaceMilledFlankTable | CylindricalGearTable | NurbsTable, Field(discriminator="kind")
]
Vector = tuple[Number, Number, Number]


class ProgramToolTable(Table):
    """An entry of [[tools]]: a cutter of any kind by its T number."""

    number: int = Field(ge=1, le=99_999_999)
    cutter: AnyCutter


class MountingTable(Table):
    """Table [toolpath.mounting]: the program's frame as the part's frame sees it."""

    origin_mm: Vector = (0.0, 0.0, 0.0)
    x_axis: Vector = (1.0, 0.0, 0.0)
    z_axis: Vector = (0.0, 0.0, 1.0)

    def build(self) -> Rigid:
        """From the program's frame to the part's. Raises InputError for axes that are not at right angles."""
        x, z = np.array(self.x_axis), np.array(self.z_axis)
        sizes = np.linalg.norm(x), np.linalg.norm(z)
        if min(sizes) < 1e-9 or abs(x @ z) > 1e-9 * sizes[0] * sizes[1]:
            axes = f"x_axis {self.x_axis} and z_axis {self.z_axis}"
            raise InputError(f"toolpath.mounting: {axes} must be at right angles, of any length")
        x, z = x / sizes[0], z / sizes[1]
        return Rigid(np.column_stack([x, np.cross(z, x), z]), np.array(self.origin_mm))


class ProgramPathTable(Table):
    """Table [toolpath] of kind ``program``: a ``file`` of G-code in a ``dialect``, by its ending, or of CL data.

    ``work_offset`` stands on the program's origin: moves in another one need its place in [control].
    """

    kind: Literal["program"] = "program"
    file: str = Field(min_length=1)
    dialect: Literal["fanuc", "linuxcnc"] = "fanuc"
    work_offset: OffsetName = "G54"
    mounting: MountingTable = MountingTable()

    @property
    def is_gcode(self) -> bool:
        return PurePath(self.file).suffix.lower() in GCODE


class ProgramMetrologyTable(GridTable):
    """Table [metrology]: a dense grid on every surface; ``judged`` names those that have a tolerance (none: all).

    ``root_tolerance_um`` is for cuts into fillets and bottom lands (default: the tolerance), where material may stay.
    """

    tolerance_um: Length
    root_tolerance_um: Length | None = None
    judged: tuple[str, ...] = ()
    rows: Count = 21
    columns: Count = 65
    margin: float = Field(default=0.01, gt=0.0, lt=0.5)
    window: float = Field(default=1.0, gt=0.0, le=4.0)
    window_mm: Length = 5.0


class ProgramScene(Scene):
    """Any surface, a program of the user's own, and its tools: one [cutter], or [[tools]] by their numbers."""

    surface: AnySurface
    cutter: AnyCutter | None = None
    tools: tuple[ProgramToolTable, ...] = ()
    machine: AnyMachine | None = None
    toolpath: ProgramPathTable
    control: ControlTable | None = None
    metrology: ProgramMetrologyTable

    @model_validator(mode="after")
    def _tools_and_machine(self) -> ProgramScene:
        if (self.cutter is None) == (not self.tools):
            raise ValueError("give one [cutter], which is tool 1, or [[tools]] with their numbers; not both, not none")
        numbers = [tool.number for tool in self.tools]
        if len(set(numbers)) < len(numbers):
            raise ValueError(f"tools: numbers {numbers} must differ")
        if self.toolpath.is_gcode and self.machine is None:
            raise ValueError("machine: missing; G-code is run by a [machine]")
        if not self.toolpath.is_gcode and self.control is not None:
            raise ValueError("control: CL data is run by no control; remove the table")
        return self

    def cutters(self) -> dict[int, Profile]:
        """The cutters by their numbers."""
        if self.cutter is not None:
            return {1: self.cutter.build()}
        return {tool.number: tool.cutter.build() for tool in self.tools}

    def controller(self) -> Machine | None:
        return None if self.machine is None else self.machine.build()

    def reading(self) -> ReadSettings | None:
        """How G-code is read; None for CL data. Raises InputError as ``ControlTable.settings`` does."""
        machine, control = self.controller(), self.control or ControlTable()
        if machine is None or not self.toolpath.is_gcode:
            return None
        return control.settings(self.toolpath.work_offset, tuple(self.cutters()), machine)

    def builders(self) -> tuple[Callable[[], object], ...]:
        shape: tuple[Callable[[], object], ...] = ()
        if isinstance(self.surface, CylindricalGearTable):
            shape = (self.surface.gear,)
        elif not isinstance(self.surface, NurbsTable):
            shape = (self.surface.build,)
        return (self.cutters, self.controller, self.reading, self.toolpath.mounting.build, *shape)
