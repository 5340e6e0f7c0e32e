"""Tables [errors] of bevel gears: how tool, settings and mounting that cut differ from those that were planned for.

What is intended stays as the scene's other tables say, and so does the planned path; zero is no error.
"""

from __future__ import annotations

from dataclasses import replace
from math import cos, radians, sin
from typing import Annotated

import numpy as np
from pydantic import Field

from gearsim.cutters.head_errors import HeadErrors, HeadSizes
from gearsim.cutters.mill_errors import MillErrors
from gearsim.cutters.profile import Profile
from gearsim.geometry.rigid import Rigid
from gearsim.machines.generator import CradleGenerator
from gearsim.scene.bevel import Turn
from gearsim.scene.catalogue import CatalogueTable
from gearsim.scene.error_table import ErrorTable
from gearsim.scene.stock import StockTable
from gearsim.surfaces.face_milled import FaceMilledTooth

Off = Annotated[float, Field(ge=-1000.0, le=1000.0, allow_inf_nan=False)]  # um
Gone = Annotated[float, Field(ge=0.0, le=1000.0, allow_inf_nan=False)]  # um
Lean = Annotated[float, Field(ge=-5.0, le=5.0, allow_inf_nan=False)]  # deg
Ratio = Annotated[float, Field(ge=-0.1, le=0.1, allow_inf_nan=False)]
_MM = 1e-3


class MountingErrorsTable(ErrorTable):
    """Where the gear sits on its machine: its axis off the machine's, and its apex off where it should be.

    ``eccentricity_um`` goes towards ``eccentricity_direction_deg``, in the gear's frame, x to y;
    ``mounting_distance_um`` along its axis, +z.
    """

    eccentricity_um: Off = 0.0
    eccentricity_direction_deg: Turn = 0.0
    mounting_distance_um: Off = 0.0

    @property
    def mounting(self) -> Rigid | None:
        """From where the machine believes the gear to where it is: what moves every motion in the gear's frame."""
        if not (self.eccentricity_um or self.mounting_distance_um):
            return None
        off, way = _MM * self.eccentricity_um, radians(self.eccentricity_direction_deg)
        return Rigid(np.eye(3), -np.array([off * cos(way), off * sin(way), _MM * self.mounting_distance_um]))

    def acting(self, above: str = "") -> list[str]:
        """As of every table; a direction alone is no error."""
        told = super().acting(above)
        return told if self.eccentricity_um else [t for t in told if not t.startswith("eccentricity_direction_deg")]


def require_one_space(errors: MountingErrorsTable, stock: StockTable | None) -> None:
    """Raise ValueError where all spaces of a gear that runs out of true are to be cut as if they were alike."""
    if errors.eccentricity_um and stock is not None and stock.spaces != "one":
        raise ValueError(
            "errors.eccentricity_um: the spaces of a gear off its axis are not alike, as stock.spaces = "
            f'"{stock.spaces}" takes them to be; expected "one"'
        )


class FlankErrorsTable(MountingErrorsTable):
    """Table [errors] of flank milling: what is wrong with the tool of [cutter], as of ``cutters.mill_errors``."""

    tool_radius_um: Off = 0.0
    tool_taper_deg: Lean = 0.0
    tool_runout_um: Gone = 0.0
    tool_form_um: Gone = 0.0
    tool_length_um: Off = 0.0
    tool_corner_um: Off = 0.0

    def cutter(self, nominal: Profile) -> Profile:
        """What cuts in the place of the nominal cutter. Raises InputError where it can be none."""
        return MillErrors(
            _MM * self.tool_radius_um, radians(self.tool_taper_deg), _MM * self.tool_runout_um, _MM * self.tool_form_um,
            _MM * self.tool_length_um, _MM * self.tool_corner_um,
        ).cutter(nominal)  # fmt: skip


class GeneratorErrorsTable(ErrorTable):
    """Table [errors.generator]: added to the machine settings of the same name in [generator]."""

    radial_distance_um: Off = 0.0
    cradle_angle_deg: Lean = 0.0
    machine_root_angle_deg: Lean = 0.0
    ratio_of_roll: Ratio = 0.0
    tilt_deg: Lean = 0.0
    swivel_deg: Lean = 0.0
    sliding_base_um: Off = 0.0
    blank_offset_um: Off = 0.0
    machine_centre_to_back_um: Off = 0.0

    def set(self, nominal: CradleGenerator) -> CradleGenerator:
        """The settings that the machine has. Raises InputError where no machine has them."""
        return replace(
            nominal,
            radial_distance=nominal.radial_distance + _MM * self.radial_distance_um,
            cradle_angle=nominal.cradle_angle + radians(self.cradle_angle_deg),
            machine_root_angle=nominal.machine_root_angle + radians(self.machine_root_angle_deg),
            ratio_of_roll=nominal.ratio_of_roll + self.ratio_of_roll,
            tilt=nominal.tilt + radians(self.tilt_deg),
            swivel=nominal.swivel + radians(self.swivel_deg),
            sliding_base=nominal.sliding_base + _MM * self.sliding_base_um,
            blank_offset=nominal.blank_offset + _MM * self.blank_offset_um,
            machine_centre_to_back=nominal.machine_centre_to_back + _MM * self.machine_centre_to_back_um,
        )


class HeadErrorsTable(ErrorTable):
    """Table [errors.head]: what is wrong with the head and its blades, as of ``cutters.head_errors``."""

    radius_um: Off = 0.0
    point_width_um: Off = 0.0
    inner_angle_deg: Lean = 0.0
    outer_angle_deg: Lean = 0.0
    edge_radius_um: Off = 0.0
    runout_um: Gone = 0.0
    length_um: Off = 0.0
    inner_wear_um: Gone = 0.0
    outer_wear_um: Gone = 0.0
    tip_wear_um: Gone = 0.0

    def head(self, nominal: CatalogueTable) -> Profile:
        """What cuts in the place of a head. Raises InputError where it can be none."""
        errors = HeadErrors(
            _MM * self.radius_um, _MM * self.point_width_um, radians(self.inner_angle_deg),
            radians(self.outer_angle_deg), _MM * self.edge_radius_um, _MM * self.runout_um, _MM * self.length_um,
            _MM * self.inner_wear_um, _MM * self.outer_wear_um, _MM * self.tip_wear_um,
        )  # fmt: skip
        return errors.head(nominal.build(), HeadSizes(**nominal.parameters()))


class CutErrorsTable(ErrorTable):
    """One head's errors, and those of the machine's settings for it."""

    generator: GeneratorErrorsTable = GeneratorErrorsTable()
    head: HeadErrorsTable = HeadErrorsTable()

    def real(self, nominal: FaceMilledTooth, head: CatalogueTable) -> FaceMilledTooth:
        """What cuts in the place of a head and its settings; of the same roll. Raises InputError where nothing can."""
        return replace(nominal, head=self.head.head(head), generator=self.generator.set(nominal.generator))


class FaceMillingErrorsTable(CutErrorsTable, MountingErrorsTable):
    """Table [errors] of a face-milled gear."""


class HypoidErrorsTable(CutErrorsTable, MountingErrorsTable):
    """Table [errors] of a hypoid pinion; ``convex``: of the head and the settings of [convex]."""

    convex: CutErrorsTable = CutErrorsTable()
