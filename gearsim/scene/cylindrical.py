"""Scenes of cylindrical gears milled by generation on a five-axis machine: plan, program, cut, inspect."""

from __future__ import annotations

from collections.abc import Callable
from math import radians
from typing import Annotated, Literal

from pydantic import Field, model_validator

from gearsim.cutters.end_mills import flat
from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.machines.chain import Machine
from gearsim.machines.errors import RealMachine
from gearsim.programs.gcode import ReadSettings
from gearsim.scene.base import Scene, SimulationTable
from gearsim.scene.bevel import Number
from gearsim.scene.catalogue import AnyRunMachine
from gearsim.scene.cylindrical_paths import EndMillTable, GearPathTable
from gearsim.scene.holder import above_mill
from gearsim.scene.machine_errors import MachineErrorsTable
from gearsim.scene.program import ControlTable, PostTable
from gearsim.scene.tables import Angle, Count, GridTable, Length, LengthOrZero, Table
from gearsim.surfaces.cylindrical_gear import CylindricalGear
from gearsim.surfaces.flank_modification import FlankModification, Relief
from gearsim.surfaces.gear_outline import GearOutline
from gearsim.toolpaths.cylindrical.settings import Finishing, Settings

Degrees = Annotated[float, Field(gt=-90.0, lt=90.0, allow_inf_nan=False)]
Micrometres = Annotated[float, Field(ge=-1e4, le=1e4, allow_inf_nan=False)]
Step = Annotated[float, Field(gt=0.0, le=100.0, allow_inf_nan=False)]


class ReliefTable(Table):
    """A relief: material taken off from a roll angle to the end of the flank."""

    amount_um: Micrometres
    start_deg: float = Field(gt=0.0, lt=180.0, allow_inf_nan=False)
    shape: Literal["linear", "parabolic"] = "linear"

    def build(self) -> Relief:
        return Relief(1e-3 * self.amount_um, radians(self.start_deg), 1 if self.shape == "linear" else 2)


class ModificationTable(Table):
    """Table [surface.modification]: designed deviations along the flank's normal, positive adds material."""

    tip_relief: ReliefTable | None = None
    root_relief: ReliefTable | None = None
    profile_slope_um: Micrometres = 0.0
    profile_crowning_um: Micrometres = 0.0
    helix_slope_um: Micrometres = 0.0
    helix_crowning_um: Micrometres = 0.0

    def build(self) -> FlankModification:
        tip, root = (None if r is None else r.build() for r in (self.tip_relief, self.root_relief))
        return FlankModification(
            tip, root,
            1e-3 * self.profile_slope_um, 1e-3 * self.profile_crowning_um,
            1e-3 * self.helix_slope_um, 1e-3 * self.helix_crowning_um,
        )  # fmt: skip


class CylindricalGearTable(Table):
    """Table [surface] of kind ``cylindrical-gear``; module and pressure angle both normal or both transverse.

    ``fillet_radius_mm``: of the arcs between root land and flanks, in the transverse section; 0: sharp corners.
    """

    kind: Literal["cylindrical-gear"]
    teeth: int = Field(ge=-1000, le=1000)
    module_mm: Length | None = None
    pressure_angle_deg: Angle | None = None
    transverse_module_mm: Length | None = None
    transverse_pressure_angle_deg: Angle | None = None
    helix_angle_deg: Degrees = 0.0
    face_width_mm: Length
    profile_shift: Number = 0.0
    addendum: Number = 1.0
    dedendum: Number = 1.25
    tip_alteration: Number = 0.0
    rim_mm: Length
    fillet_radius_mm: LengthOrZero = 0.0
    modification: ModificationTable | None = None

    @model_validator(mode="after")
    def _one_section(self) -> CylindricalGearTable:
        normal = (self.module_mm, self.pressure_angle_deg)
        transverse = (self.transverse_module_mm, self.transverse_pressure_angle_deg)
        if [None not in pair for pair in (normal, transverse)].count(True) != 1 or (
            [pair == (None, None) for pair in (normal, transverse)].count(True) != 1
        ):
            raise ValueError(
                "give module_mm with pressure_angle_deg (normal section), or transverse_module_mm with "
                "transverse_pressure_angle_deg; not both, not a mixture"
            )
        return self

    def gear(self) -> CylindricalGear:
        """The gear. Raises InputError where it is impossible."""
        rest = {
            "profile_shift": self.profile_shift,
            "addendum": self.addendum,
            "dedendum": self.dedendum,
            "tip_alteration": self.tip_alteration,
        }
        beta, b = radians(self.helix_angle_deg), self.face_width_mm
        if self.module_mm is not None and self.pressure_angle_deg is not None:
            return CylindricalGear(self.teeth, self.module_mm, radians(self.pressure_angle_deg), beta, b, **rest)
        assert self.transverse_module_mm is not None
        assert self.transverse_pressure_angle_deg is not None
        angle = radians(self.transverse_pressure_angle_deg)
        return CylindricalGear.from_transverse(self.teeth, self.transverse_module_mm, angle, beta, b, **rest)

    def outline(self) -> GearOutline:
        """Its transverse section, root and all. Raises InputError for fillets that do not fit."""
        return GearOutline(self.gear(), self.fillet_radius_mm)

    def design(self) -> FlankModification | None:
        return None if self.modification is None else self.modification.build()


class GearProgramTable(PostTable):
    """Table [program]: how the G-code is written, or a ``file`` of the user's own in a ``dialect``, cut instead.

    ``work_offset`` stands on the gear's origin: a file that moves in another one needs its place in [control].
    """

    tip_control: bool = False
    file: str | None = Field(default=None, min_length=1)
    dialect: Literal["fanuc", "linuxcnc"] = "fanuc"


class ErrorsTable(MachineErrorsTable):
    """Table [errors]: how the machine that cuts differs from the planned one."""

    tool_radius_um: Micrometres = 0.0
    tool_runout_um: Micrometres = 0.0
    pivot_um: tuple[Micrometres, Micrometres, Micrometres] = (0.0, 0.0, 0.0)
    eccentricity_um: Micrometres = 0.0


class BudgetTable(Table):
    """Table [budget]: sizes of the causes that are cut one at a time, to see what each costs."""

    decimals: tuple[int, ...] = (3, 4, 5, 6)
    involute_steps_mm: tuple[Step, ...] = (1.0, 0.5, 0.25)
    axial_steps_mm: tuple[Step, ...] = (1.0, 0.5, 0.25)
    tool_radius_um: Micrometres = 1.0
    tool_runout_um: Micrometres = 1.0
    pivot_um: Micrometres = 10.0
    eccentricity_um: Micrometres = 10.0


class GearMetrologyTable(GridTable):
    """Table [metrology]: the class of ISO 1328-1 asked for, and where the flanks are probed.

    ``tolerance_um`` is for the dense map of space 0; ``points`` of a trace; ``spaces`` how many spaces are probed
    (0: all of them). Of a whole part ([stock]) ``root_tolerance_um`` and ``root_excess_um`` limit what may be taken
    from root lands and fillets and left on them, ``body_tolerance_um`` tip, faces and bore.
    """

    iso_class: int = Field(default=5, ge=1, le=11)
    tolerance_um: Length = 1.0
    root_tolerance_um: Length = 50.0
    root_excess_um: Length = 50.0
    body_tolerance_um: Length = 10.0
    points: Count = 201
    spaces: int = Field(default=0, ge=0, le=1000)
    rows: Count = 25
    columns: Count = 41
    margin: float = Field(default=0.01, gt=0.0, lt=0.5)
    section_pitch_mm: Length = 0.05


class GearSimulationTable(SimulationTable):
    """Table [simulation]: rays through a gear that is cut space by space are cut into many pieces."""

    interval_slots: int = Field(default=64, ge=1, le=256)


class MeasuredTable(Table):
    """One printed table of measured deviations [um] beside which ours are set; stations as the source names them."""

    name: str
    kind: Literal["profile", "helix"]
    side: Literal["left", "right"]
    stations: tuple[str, ...]
    slope_um: tuple[Number, ...]
    form_um: tuple[Number, ...]
    total_um: tuple[Number, ...]

    @model_validator(mode="after")
    def _one_number_a_station(self) -> MeasuredTable:
        for key in ("slope_um", "form_um", "total_um"):
            if len(getattr(self, key)) != len(self.stations):
                raise ValueError(f"{key} has {len(getattr(self, key))} entries for {len(self.stations)} stations")
        return self


class MeasuredTables(Table):
    """Table [reference]: where printed figures come from."""

    source: str
    note: str = ""
    hours: tuple[LengthOrZero, LengthOrZero] | None = None
    roughness_um: dict[str, tuple[LengthOrZero, LengthOrZero, LengthOrZero]] = Field(default_factory=dict)
    tables: tuple[MeasuredTable, ...] = ()


class CylindricalGearScene(Scene):
    """A cylindrical gear, planned, posted, read back, cut and inspected."""

    surface: CylindricalGearTable
    machine: AnyRunMachine
    tools: tuple[EndMillTable, ...] = Field(min_length=1)
    toolpath: GearPathTable
    program: GearProgramTable = GearProgramTable()
    control: ControlTable | None = None
    errors: ErrorsTable = ErrorsTable()
    budget: BudgetTable | None = None
    metrology: GearMetrologyTable = GearMetrologyTable()
    simulation: GearSimulationTable = GearSimulationTable()
    reference: MeasuredTables | None = None

    @model_validator(mode="after")
    def _control_of_a_file(self) -> CylindricalGearScene:
        if self.control is not None and not self.program.file:
            raise ValueError("control: the planned program states all it needs; the table is for a program.file")
        return self

    def gear(self) -> CylindricalGear:
        return self.surface.gear()

    def reading(self) -> ReadSettings:
        """How the program is read. Raises InputError as ``ControlTable.settings`` does."""
        control = self.control or ControlTable()
        return control.settings(self.program.work_offset, [t.number for t in self.tools], self.controller())

    def probed(self) -> None:
        """Raises InputError where more spaces are to be probed than there are."""
        spaces, there = self.metrology.spaces, self.gear().count
        if spaces > there:
            raise InputError(f"metrology.spaces: got {spaces}; the gear has {there} (0 probes them all)")

    def controller(self) -> Machine:
        machine: Machine = self.machine.build()
        return machine

    def faulty(self) -> RealMachine | None:
        """The machine with its axes' errors; None where they have none. Raises InputError for axes it has not."""
        return self.errors.real(self.controller())

    def builders(self) -> tuple[Callable[[], object], ...]:
        surface = (self.gear, self.surface.outline, self.surface.design)
        reading = (self.program.options, self.reading)
        return (*surface, self.faulty, *reading, self.paths, self.holders, self.probed)

    def holders(self) -> dict[int, Profile]:
        """What stands above the tools' flutes, where it is given, by their numbers."""
        nose, found = self.machine.spindle_nose_mm, dict[int, Profile]()
        for t in self.tools:
            body = above_mill(flat(t.diameter_mm, t.flute_length_mm), t.length_mm, t.holder, nose)
            if body is not None:
                found[t.number] = body
        return found

    def finishing(self) -> Finishing:
        """What finishing is told. Raises InputError as ``paths`` does."""
        last = self.paths()[-1]
        assert isinstance(last, Finishing)
        return last

    def paths(self) -> tuple[Settings, ...]:
        """What each operation is told, finishing last. Raises InputError for a tool that is not in the table."""
        return self.toolpath.settings(self.tools, self.surface.design(), self.surface.fillet_radius_mm or None)
