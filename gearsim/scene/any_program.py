"""Scenes of any surface cut by a program of the user's own: G-code, CL data or axis values, by one tool or several."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import PurePath
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from gearsim.cutters.end_mills import flat
from gearsim.cutters.holder import Section
from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.geometry.rigid import Rigid
from gearsim.machines.chain import Machine
from gearsim.machines.errors import RealMachine
from gearsim.programs.gcode import ReadSettings
from gearsim.scene.base import Scene
from gearsim.scene.bevel import GeneratorTable, Number, ToothTable
from gearsim.scene.catalogue import AnyCutter, AnyMill, AnyRunMachine
from gearsim.scene.cylindrical import CylindricalGearTable
from gearsim.scene.flank_milling import FaceMilledFlankTable, RuledBevelTable
from gearsim.scene.generated import FaceMilledTable, HeadTable, HypoidTable
from gearsim.scene.holder import HolderTable, above, above_mill
from gearsim.scene.kinds import AXIS_TABLE, GCODE
from gearsim.scene.machine_errors import MachineErrorsTable
from gearsim.scene.program import ControlTable, OffsetName
from gearsim.scene.sculptured import NurbsTable
from gearsim.scene.tables import Count, GridTable, Length, Table
from gearsim.surfaces.hypoid import HypoidPinion
from gearsim.surfaces.patch import Tooth

AnySurface = Annotated[
    RuledBevelTable | FaceMilledFlankTable | FaceMilledTable | HypoidTable | CylindricalGearTable | NurbsTable,
    Field(discriminator="kind"),
]
Vector = tuple[Number, Number, Number]


class ProgramToolTable(Table):
    """An entry of [[tools]] by its T number: a ``cutter`` of any kind, or an end mill as cylindrical gears list it.

    ``length_mm``: so far over its tip the end mill goes on, as thick as its flutes.
    """

    number: int = Field(default=1, ge=1, le=99_999_999)
    cutter: AnyMill | None = None
    holder: HolderTable | None = None
    name: str = "end mill"
    diameter_mm: Length | None = None
    flute_length_mm: Length | None = None
    length_mm: Length | None = None
    flutes: int = Field(default=1, ge=1, le=20)

    @model_validator(mode="after")
    def _one_shape(self) -> ProgramToolTable:
        known = ("name", "diameter_mm", "flute_length_mm", "length_mm", "flutes")
        fields = {name: type(self).model_fields[name].default for name in known}
        mill = [name for name, default in fields.items() if getattr(self, name) != default]
        if self.cutter is not None and mill:
            raise ValueError(f"a cutter needs no {', '.join(sorted(mill))}; its own table says all of it")
        if self.cutter is None and (self.diameter_mm is None or self.flute_length_mm is None):
            raise ValueError("give a cutter, or diameter_mm and flute_length_mm of an end mill")
        return self

    def build(self) -> Profile:
        """The tool's shape. Raises InputError for an impossible one."""
        if self.cutter is not None:
            profile: Profile = self.cutter.build()
            return profile
        assert self.diameter_mm is not None
        assert self.flute_length_mm is not None
        return flat(self.diameter_mm, self.flute_length_mm)

    def above(self, nose: tuple[Section, ...] = ()) -> Profile | None:
        """What stands above its flutes, the spindle's ``nose`` on top, where anything is given."""
        if self.cutter is None:
            return above_mill(self.build(), self.length_mm, self.holder, nose)
        return above(self.cutter, self.holder, nose)


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
    """Table [toolpath] of kind ``program``: a ``file`` of G-code in a ``dialect``, of axis values (``.csv``), or of CL
    data, by its ending.

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

    @property
    def is_axis_table(self) -> bool:
        return PurePath(self.file).suffix.lower() == AXIS_TABLE


class ProgramMetrologyTable(GridTable):
    """Table [metrology]: a dense grid on every surface; ``judged`` names those that have a tolerance (none: all).

    ``root_tolerance_um`` is for cuts into fillets and bottom lands (default: the tolerance), where material may stay.
    ``inspection_...``: an inspector's grid on the flanks of bevel gears. ``tooth``: what is demanded, beside its
    blank, of a tooth that a head generates.
    """

    tolerance_um: Length
    root_tolerance_um: Length | None = None
    judged: tuple[str, ...] = ()
    rows: Count = 21
    columns: Count = 65
    margin: float = Field(default=0.01, gt=0.0, lt=0.5)
    inspection_rows: Count = 5
    inspection_columns: Count = 9
    inspection_margin: float = Field(default=0.1, gt=0.0, lt=0.5)
    window: float = Field(default=1.0, gt=0.0, le=4.0)
    window_mm: Length = 5.0
    tooth: ToothTable | None = None


class ProgramScene(Scene):
    """Any surface, a program of the user's own, and its tools: one [cutter], or [[tools]] by their numbers.

    What generates a ``face-milled`` or ``hypoid-pinion`` surface, [head] (default: the [cutter]) with [generator] and
    [convex], cuts nothing here: it says which tooth is meant.
    """

    surface: AnySurface
    head: AnyCutter | None = None
    generator: GeneratorTable | None = None
    convex: HeadTable | None = None
    cutter: AnyMill | None = None
    holder: HolderTable | None = None
    tools: tuple[ProgramToolTable, ...] = ()
    machine: AnyRunMachine | None = None
    toolpath: ProgramPathTable
    control: ControlTable | None = None
    errors: MachineErrorsTable = MachineErrorsTable()
    metrology: ProgramMetrologyTable

    @model_validator(mode="after")
    def _tools_and_machine(self) -> ProgramScene:
        if (self.cutter is None) == (not self.tools):
            raise ValueError("give one [cutter], which is tool 1, or [[tools]] with their numbers; not both, not none")
        if self.tools and self.holder is not None:
            raise ValueError("holder: it belongs to [cutter]; give every entry of [[tools]] its own")
        numbers = [tool.number for tool in self.tools]
        if len(set(numbers)) < len(numbers):
            raise ValueError(f"tools: numbers {numbers} must differ")
        kind = "G-code is" if self.toolpath.is_gcode else "axis values are" if self.toolpath.is_axis_table else ""
        if kind and self.machine is None:
            raise ValueError(f"machine: missing; {kind} run by a [machine]")
        if self.toolpath.is_axis_table and len(numbers) > 1:
            raise ValueError("tools: axis values are cut with one tool; give one [cutter]")
        if not self.toolpath.is_gcode and self.control is not None:
            raise ValueError("control: only G-code is run by a control; remove the table")
        return self

    @model_validator(mode="after")
    def _generated_alone(self) -> ProgramScene:
        generated = isinstance(self.surface, FaceMilledTable | FaceMilledFlankTable | HypoidTable)
        if self.metrology.tooth is not None and not generated:
            raise ValueError(f"metrology.tooth: it is for teeth that a head generates, not {self.surface.kind}")
        return self

    @model_validator(mode="after")
    def _head_and_settings(self) -> ProgramScene:
        kind, given = self.surface.kind, (self.head, self.generator, self.convex)
        names = [n for n, table in zip(("head", "generator", "convex"), given, strict=True) if table is not None]
        if not isinstance(self.surface, FaceMilledTable | HypoidTable):
            if names:
                raise ValueError(f"{names[0]}: only face-milled and hypoid-pinion surfaces are generated, not {kind}")
            return self
        if self.generator is None:
            raise ValueError(f"generator: missing; its settings say which {kind} tooth is meant")
        if self.head is None and (self.cutter is None or self.cutter.kind != "face-mill-head"):
            raise ValueError(
                f"head: missing; the tools are no face-mill-head, so [head] says which {kind} tooth is meant"
            )
        if self.convex is not None and not isinstance(self.surface, HypoidTable):
            raise ValueError(f"convex: only hypoid-pinion surfaces have a cut of their own for it, not {kind}")
        return self

    def tooth(self) -> Tooth | HypoidPinion | None:
        """The bevel gear's tooth that is meant; None for another surface. Raises InputError for an impossible one."""
        if isinstance(self.surface, RuledBevelTable | FaceMilledFlankTable):
            return self.surface.build()
        if not isinstance(self.surface, FaceMilledTable | HypoidTable):
            return None
        made_by = self.head or self.cutter
        assert made_by is not None
        assert self.generator is not None
        head = made_by.build()
        if isinstance(self.surface, HypoidTable):
            pinion = self.surface.pinion(head, self.generator, self.convex)
            return pinion.concave if self.convex is None else pinion
        return self.surface.tooth(head, self.generator)

    def spaces(self) -> int:
        """How many spaces like the one that is meant the part has."""
        if isinstance(self.surface, CylindricalGearTable):
            return abs(self.surface.teeth)
        tooth = self.tooth()
        return 1 if tooth is None else tooth.blank.teeth

    def cutters(self) -> dict[int, Profile]:
        """The cutters by their numbers."""
        if self.cutter is not None:
            return {1: self.cutter.build()}
        return {tool.number: tool.build() for tool in self.tools}

    def holders(self) -> dict[int, Profile]:
        """What stands above the cutters' flutes, where it is given, by their numbers."""
        nose = () if self.machine is None else self.machine.spindle_nose_mm
        found = {tool.number: tool.above(nose) for tool in self.tools}
        if self.cutter is not None:
            found = {1: above(self.cutter, self.holder, nose)}
        return {number: body for number, body in found.items() if body is not None}

    def controller(self) -> Machine | None:
        return None if self.machine is None else self.machine.build()

    def faulty(self) -> RealMachine | None:
        """The machine with its errors, None where it has none.

        Raises InputError for errors of no machine or axis, and where it runs no G-code.
        """
        real = self.errors.real(self.controller())
        if real is not None and not self.toolpath.is_gcode:
            raise InputError(f"errors: a machine with errors runs G-code here, not {self.toolpath.file}; remove them")
        return real

    def reading(self) -> ReadSettings | None:
        """How G-code is read; None for CL data. Raises InputError as ``ControlTable.settings`` does."""
        machine, control = self.controller(), self.control or ControlTable()
        if machine is None or not self.toolpath.is_gcode:
            return None
        return control.settings(self.toolpath.work_offset, tuple(self.cutters()), machine)

    def builders(self) -> tuple[Callable[[], object], ...]:
        shape = self.surface.gear if isinstance(self.surface, CylindricalGearTable) else self.tooth
        return (
            self.cutters,
            self.holders,
            self.controller,
            self.faulty,
            self.reading,
            self.toolpath.mounting.build,
            shape,
        )
