"""Scenes that flank-mill a spiral bevel gear, its tooth ruled or as a face-mill head generates it."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, partial
from math import radians
from typing import Literal

from pydantic import Field, model_validator

from gearsim.cutters.holder import Section
from gearsim.cutters.profile import Profile
from gearsim.machines.errors import RealMachine
from gearsim.scene.base import Scene
from gearsim.scene.bevel import BevelBlankTable, GeneratorTable, Number, ToothTable, Turn
from gearsim.scene.catalogue import AnyCutter, AnyMill
from gearsim.scene.holder import HolderTable, above
from gearsim.scene.machine_errors import MachineErrorsTable
from gearsim.scene.program import ProgramTable
from gearsim.scene.slot_operations import RootTable, RoughingTable, SemiFinishingTable
from gearsim.scene.tables import Angle, Count, GridTable, Length, LengthOrZero, Table
from gearsim.scene.tool_errors import FlankErrorsTable, require_one_space
from gearsim.surfaces.face_milled import FaceMilledTooth
from gearsim.surfaces.patch import SIDES, Side, Tooth
from gearsim.surfaces.ruled_bevel import STRAIGHT, RuledBevelTooth
from gearsim.toolpaths.face_milled import GeneratedFlankPath
from gearsim.toolpaths.flank import FlankPath
from gearsim.toolpaths.tangent import FlankPass


class RuledBevelTable(BevelBlankTable):
    """Table [surface] of kind ``ruled-bevel``: blank and tooth of a ruled spiral bevel gear."""

    kind: Literal["ruled-bevel"]
    hand: Literal["left", "right"]
    spiral_angle_deg: float = Field(ge=0.0, lt=60.0, allow_inf_nan=False)
    lengthwise: Literal["arc", "straight"] = "arc"
    lengthwise_radius_mm: Length | None = None
    tapered: bool = False
    bottom_half_width_mm: LengthOrZero
    fillet_radius_mm: LengthOrZero
    pressure_angle_deg: Angle
    start_angle_deg: Turn = 0.0

    @model_validator(mode="after")
    def _arcs_have_a_radius(self) -> RuledBevelTable:
        if self.lengthwise == "arc" and self.lengthwise_radius_mm is None:
            raise ValueError("lengthwise_radius_mm: missing (lengthwise = 'straight' needs none)")
        if self.lengthwise == "straight" and self.lengthwise_radius_mm is not None:
            raise ValueError("lengthwise = 'straight' has no radius; remove lengthwise_radius_mm")
        return self

    def build(self) -> RuledBevelTooth:
        """The tooth slot on its blank."""
        return RuledBevelTooth(
            self.blank(), radians(self.spiral_angle_deg), self.hand, self.lengthwise_radius_mm or STRAIGHT,
            self.bottom_half_width_mm, self.fillet_radius_mm, radians(self.pressure_angle_deg),
            radians(self.start_angle_deg), self.tapered,
        )  # fmt: skip

    def planner(self, side: Side, cutter: Profile, run: float, allowance: float = 0.0) -> FlankPass:
        """The pass of one flank that leaves ``allowance`` [mm]; ``run`` [mm] goes beyond toe and heel."""
        return FlankPath(self.build(), side, cutter, run, allowance)


class FaceMilledFlankTable(BevelBlankTable):
    """Table [surface] of kind ``face-milled-flank``: the tooth that a face-mill head leaves, cut by another tool.

    ``head`` and ``generator`` define the intended tooth and cut nothing; ``generated`` as in ``face-milled``.
    """

    kind: Literal["face-milled-flank"]
    generated: bool = True
    head: AnyCutter
    generator: GeneratorTable

    def build(self) -> FaceMilledTooth:
        return FaceMilledTooth(self.blank(), self.head.build(), self.generator.build(), self.generated)

    def planner(self, side: Side, cutter: Profile, run: float, allowance: float = 0.0) -> FlankPass:
        """The pass of one flank that leaves ``allowance`` [mm]; ``run`` [mm] goes beyond toe and heel."""
        tooth = self.build()
        return GeneratedFlankPath(tooth.flank(side), cutter, tooth.blade_start(side), run, allowance)


class ToolpathTable(Table):
    """Table [toolpath]: our planner's values, or ``file``, a CL file to read instead.

    ``spaces``: how many of the gear's are cut, by indexing from the first (none: that one alone).
    """

    file: str | None = None
    points: Count = 65
    run_mm: LengthOrZero = 8.0
    retract_mm: Length = 15.0
    feed_mm_min: Length = 600.0
    decimals: int = Field(default=9, ge=3, le=12)
    spaces: int | None = Field(default=None, ge=1, le=1000)

    @model_validator(mode="after")
    def _file_alone(self) -> ToolpathTable:
        planned = sorted(self.model_fields_set - {"file"})
        if self.file is not None and planned:
            raise ValueError(f"'file' replaces our planner; remove {', '.join(planned)}")
        return self


class MetrologyTable(GridTable):
    """Table [metrology]: what is measured, and the tolerances of the verdict.

    ``root_excess_um``: how much may be left on fillets and bottom land (none: as much as it likes). ``tooth``: what the
    blank of a ``face-milled-flank`` is held against.
    """

    tolerance_um: Length
    root_tolerance_um: Length
    root_excess_um: Length | None = None
    rows: Count = 21
    columns: Count = 257
    margin: float = Field(default=0.01, gt=0.0, lt=0.5)
    inspection_rows: Count = 5
    inspection_columns: Count = 9
    inspection_margin: float = Field(default=0.1, gt=0.0, lt=0.5)
    window: float = Field(default=1.0, gt=0.0, le=4.0)
    profile_offsets_mm: tuple[Number, ...] = (0.0, 0.5, -0.5, 1.5, -1.5, 3.0, -3.0)
    convergence: tuple[Count, ...] = (9, 17, 33, 65, 129, 257)
    tooth: ToothTable | None = None


class ReferenceTable(Table):
    """Table [reference]: published deviations to print beside ours."""

    source: str
    note: str = ""
    overcut_is_positive: bool
    convex_um: tuple[Number, ...]
    concave_um: tuple[Number, ...]


@lru_cache(maxsize=64)
def _built(cutter: AnyMill) -> Profile:
    profile: Profile = cutter.build()
    return profile


class FlankMillingErrorsTable(MachineErrorsTable, FlankErrorsTable):
    """Table [errors]: of tool and mounting, and of the machine that runs [program]."""


class FlankMillingScene(Scene):
    """A scene that flank-mills a spiral bevel gear."""

    surface: RuledBevelTable | FaceMilledFlankTable = Field(discriminator="kind")
    cutter: AnyMill
    holder: HolderTable | None = None
    toolpath: ToolpathTable = ToolpathTable()
    roughing: RoughingTable | None = None
    semi_finishing: SemiFinishingTable | None = None
    root: RootTable | None = None
    program: ProgramTable | None = None
    errors: FlankMillingErrorsTable = FlankMillingErrorsTable()
    metrology: MetrologyTable
    reference: ReferenceTable | None = None

    @model_validator(mode="after")
    def _one_printed_number_an_offset(self) -> FlankMillingScene:
        offsets = len(self.metrology.profile_offsets_mm)
        for key in ("convex_um", "concave_um"):
            if self.reference is not None and len(getattr(self.reference, key)) != offsets:
                raise ValueError(
                    f"reference.{key} has {len(getattr(self.reference, key))} entries, metrology.profile_offsets_mm "
                    f"{offsets}; they stand beside each other"
                )
        return self

    @model_validator(mode="after")
    def _file_alone(self) -> FlankMillingScene:
        given = [name for name in ("roughing", "semi_finishing", "root") if getattr(self, name) is not None]
        if self.toolpath.file is not None and given:
            raise ValueError(f"toolpath.file replaces our planner; remove {', '.join(given)}")
        return self

    @model_validator(mode="after")
    def _spaces_of_the_gear(self) -> FlankMillingScene:
        if (self.toolpath.spaces or 1) > self.surface.teeth:
            raise ValueError(f"toolpath.spaces: got {self.toolpath.spaces}; the gear has {self.surface.teeth}")
        return self

    @model_validator(mode="after")
    def _generated_alone(self) -> FlankMillingScene:
        if self.metrology.tooth is not None and not isinstance(self.surface, FaceMilledFlankTable):
            raise ValueError(f"metrology.tooth: it is for teeth that a head generates, not {self.surface.kind}")
        return self

    @model_validator(mode="after")
    def _alike_spaces(self) -> FlankMillingScene:
        require_one_space(self.errors, self.stock)
        return self

    def tooth(self) -> Tooth:
        return self.surface.build()

    def tool(self) -> Profile:
        return _built(self.cutter)

    def real_tool(self) -> Profile:
        """What cuts along the tool's path: it with its errors. Raises InputError where it can be none."""
        return self.errors.cutter(self.tool())

    def held(self) -> Profile | None:
        """What stands above the cutter's flutes, where it is given."""
        return above(self.cutter, self.holder, self.nose)

    def faulty(self) -> RealMachine | None:
        """The machine with its errors, None where it has none. Raises InputError for errors of no machine or axis."""
        return self.errors.real(None if self.program is None else self.program.controlled(), "[program]")

    @property
    def runs_program(self) -> bool:
        """Whether the machine's program is what is judged, not the CL data. Raises InputError as ``faulty``."""
        return self.program is not None and (self.program.cut or self.faulty() is not None)

    @property
    def has_holders(self) -> bool:
        """Whether anything is known to stand above a tool."""
        tables = (self.roughing, self.semi_finishing, self.root)
        return self.held() is not None or any(t is not None and t.held(self.nose) is not None for t in tables)

    @property
    def nose(self) -> tuple[Section, ...]:
        """The spindle's nose, where the machine has one."""
        found: tuple[Section, ...] = () if self.program is None else self.program.machine.spindle_nose_mm
        return found

    def planners(self) -> dict[Side, FlankPass]:
        """Our planner's pass for each flank."""
        cutter = self.tool()
        return {side: self.surface.planner(side, cutter, self.toolpath.run_mm) for side in SIDES}

    def builders(self) -> tuple[Callable[[], object], ...]:
        program = (self.program.controlled, self.program.options) if self.program else ()
        others = [t for t in (self.roughing, self.semi_finishing, self.root) if t is not None]
        tools = (build for table in others for build in (table.cutter, partial(table.held, self.nose)))
        return (self.tooth, self.real_tool, self.held, self.faulty, *tools, *program)
