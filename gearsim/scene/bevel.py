"""Tables of bevel gears: the blank, and the generator that cuts its teeth."""

from __future__ import annotations

from math import radians
from typing import Annotated, Literal

from pydantic import Field

from gearsim.machines.generator import CradleGenerator
from gearsim.scene.tables import Length, LengthOrZero, Table
from gearsim.surfaces.blank import BevelBlank, outer_cone_distance, pitch_angle
from gearsim.surfaces.tooth_demand import ToothDemand

Number = Annotated[float, Field(gt=-1e5, lt=1e5, allow_inf_nan=False)]
Turn = Annotated[float, Field(ge=-360.0, le=360.0, allow_inf_nan=False)]


class ConesTable(Table):
    """What blanks of bevel gears share: tooth number, face, heights and angles."""

    teeth: int = Field(ge=5, le=1000)
    face_width_mm: Length
    addendum_mm: Length
    dedendum_mm: Length
    face_angle_deg: float = Field(gt=0.0, lt=180.0, allow_inf_nan=False)
    root_angle_deg: float = Field(gt=0.0, lt=180.0, allow_inf_nan=False)
    clearance_mm: LengthOrZero
    rim_mm: Length

    def _blank(self, pitch: float, cone_distance: float) -> BevelBlank:
        return BevelBlank(
            self.teeth, pitch, cone_distance, self.face_width_mm, self.addendum_mm, self.dedendum_mm,
            radians(self.face_angle_deg), radians(self.root_angle_deg), self.clearance_mm, self.rim_mm,
        )  # fmt: skip


class BevelBlankTable(ConesTable):
    """The blank of a bevel gear, by module, tooth numbers and shaft angle."""

    mate_teeth: int = Field(ge=3, le=1000)
    module_mm: Length
    shaft_angle_deg: float = Field(gt=0.0, lt=180.0, allow_inf_nan=False)

    def blank(self) -> BevelBlank:
        """The blank. Raises InputError where it is impossible."""
        pitch = pitch_angle(self.teeth, self.mate_teeth, radians(self.shaft_angle_deg))
        return self._blank(pitch, outer_cone_distance(self.module_mm, self.teeth, pitch))


class HypoidBlankTable(ConesTable):
    """The blank of a hypoid pinion, by its own pitch cone."""

    pitch_angle_deg: float = Field(gt=0.0, lt=90.0, allow_inf_nan=False)
    cone_distance_mm: Length

    def blank(self) -> BevelBlank:
        """The blank, apex of the pitch cone at the origin. Raises InputError where it is impossible."""
        return self._blank(radians(self.pitch_angle_deg), self.cone_distance_mm)


class GeneratorTable(Table):
    """Table [generator]: settings of the conventional cradle generator."""

    radial_distance_mm: LengthOrZero
    cradle_angle_deg: Turn
    machine_root_angle_deg: Turn
    ratio_of_roll: Number
    tilt_deg: Turn = 0.0
    swivel_deg: Turn = 0.0
    sliding_base_mm: Number = 0.0
    blank_offset_mm: Number = 0.0
    machine_centre_to_back_mm: Number = 0.0
    modified_roll: tuple[Number, ...] = ()

    def build(self) -> CradleGenerator:
        return CradleGenerator(
            self.radial_distance_mm, radians(self.cradle_angle_deg), radians(self.machine_root_angle_deg),
            self.ratio_of_roll, radians(self.tilt_deg), radians(self.swivel_deg), self.sliding_base_mm,
            self.blank_offset_mm, self.machine_centre_to_back_mm, self.modified_roll,
        )  # fmt: skip


class ToothTable(Table):
    """Table [metrology.tooth]: what the part demands of the tooth that its settings generate, with tolerances.

    ``depth_tolerance_um``: of the bottom land off the root cone, all along the face; ``join_tolerance_um``: of gaps
    between flank, fillet and bottom land. At the mean cone distance, on the pitch cone: ``spiral_angle_deg``, ``hand``
    of spiral, and ``thickness_mm`` of the tooth around the gear axis; without them nothing is demanded there.
    """

    depth_tolerance_um: Length = 200.0
    join_tolerance_um: Length = 1.0
    spiral_angle_deg: float | None = Field(default=None, ge=0.0, lt=90.0, allow_inf_nan=False)
    spiral_angle_tolerance_deg: float = Field(default=0.5, gt=0.0, lt=90.0, allow_inf_nan=False)
    hand: Literal["left", "right"] | None = None
    thickness_mm: Length | None = None
    thickness_tolerance_um: Length = 50.0

    def build(self) -> ToothDemand:
        return ToothDemand(
            self.depth_tolerance_um, self.join_tolerance_um, self.spiral_angle_deg, self.spiral_angle_tolerance_deg,
            self.thickness_mm, self.thickness_tolerance_um, self.hand,
        )  # fmt: skip
