"""Tables of the errors of a machine's axes, squareness and temperature: see docs/machine-errors.md for every key.

Signs are those of axes: positive moves the tool relative to the workpiece, along the machine's X, Y, Z or right-handed
about them.
"""

from __future__ import annotations

from math import radians
from typing import Annotated, ClassVar

from pydantic import Field

from gearsim.errors import InputError
from gearsim.machines.chain import Machine
from gearsim.machines.errors import Growth, MachineErrors, RealMachine, RotaryErrors, SlideErrors, Squareness
from gearsim.scene.bevel import Number, Turn
from gearsim.scene.error_table import ErrorTable
from gearsim.scene.tables import Length

Small = Annotated[float, Field(ge=-1e4, le=1e4, allow_inf_nan=False)]  # um, urad, um/m, urad/m, urad/rad
Play = Annotated[float, Field(ge=0.0, le=1e4, allow_inf_nan=False)]
Kelvin = Annotated[float, Field(ge=-200.0, le=200.0, allow_inf_nan=False)]
_MICRO, _UM, _PER_M = 1e-6, 1e-3, 1e-3  # 1e-6; mm in a micrometre; per mm of what is per metre


class SlideErrorsTable(ErrorTable):
    """Table [errors.axes.X], Y or Z: a linear axis's six component errors (ISO 230-1) and its backlash."""

    conditions: ClassVar[frozenset[str]] = frozenset({"bow_length_mm", "reference_mm"})

    scale_um_m: Small = 0.0
    bow_x_um: Small = 0.0
    bow_y_um: Small = 0.0
    bow_z_um: Small = 0.0
    bow_length_mm: Length = 500.0
    about_x_urad_m: Small = 0.0
    about_y_urad_m: Small = 0.0
    about_z_urad_m: Small = 0.0
    reference_mm: tuple[Number, Number, Number] = (0.0, 0.0, 0.0)
    backlash_um: Play = 0.0

    def errors(self, warming: float) -> SlideErrors:
        """Its errors; ``warming`` is what temperature adds to its scale."""
        return SlideErrors(
            scale=_MICRO * self.scale_um_m + warming,
            bow=(_UM * self.bow_x_um, _UM * self.bow_y_um, _UM * self.bow_z_um),
            bow_length=self.bow_length_mm,
            turn=(
                _MICRO * _PER_M * self.about_x_urad_m,
                _MICRO * _PER_M * self.about_y_urad_m,
                _MICRO * _PER_M * self.about_z_urad_m,
            ),
            reference=self.reference_mm,
            backlash=_UM * self.backlash_um,
        )


class RotaryErrorsTable(ErrorTable):
    """Table [errors.axes.A], B, C or D: a rotary axis's location errors (ISO 230-7), how far it turns, its backlash."""

    conditions: ClassVar[frozenset[str]] = frozenset({"once_per_turn_phase_deg"})

    offset_x_um: Small = 0.0
    offset_y_um: Small = 0.0
    offset_z_um: Small = 0.0
    tilt_x_urad: Small = 0.0
    tilt_y_urad: Small = 0.0
    tilt_z_urad: Small = 0.0
    zero_urad: Small = 0.0
    scale_urad_rad: Small = 0.0
    once_per_turn_urad: Small = 0.0
    once_per_turn_phase_deg: Turn = 0.0
    backlash_urad: Play = 0.0

    def errors(self) -> RotaryErrors:
        return RotaryErrors(
            offset=(_UM * self.offset_x_um, _UM * self.offset_y_um, _UM * self.offset_z_um),
            tilt=(_MICRO * self.tilt_x_urad, _MICRO * self.tilt_y_urad, _MICRO * self.tilt_z_urad),
            zero=_MICRO * self.zero_urad,
            scale=_MICRO * self.scale_urad_rad,
            swing=_MICRO * self.once_per_turn_urad,
            swing_phase=radians(self.once_per_turn_phase_deg),
            backlash=_MICRO * self.backlash_urad,
        )


class AxesErrorsTable(ErrorTable):
    """Table [errors.axes]: a table an axis, by its name."""

    X: SlideErrorsTable = SlideErrorsTable()
    Y: SlideErrorsTable = SlideErrorsTable()
    Z: SlideErrorsTable = SlideErrorsTable()
    A: RotaryErrorsTable = RotaryErrorsTable()
    B: RotaryErrorsTable = RotaryErrorsTable()
    C: RotaryErrorsTable = RotaryErrorsTable()
    D: RotaryErrorsTable = RotaryErrorsTable()


class SquarenessTable(ErrorTable):
    """Table [errors.squareness]: of Y to X about Z, of Z to Y about X, of Z to X about Y."""

    c0y_urad: Small = 0.0
    a0z_urad: Small = 0.0
    b0z_urad: Small = 0.0

    def errors(self) -> Squareness:
        return Squareness(_MICRO * self.c0y_urad, _MICRO * self.a0z_urad, _MICRO * self.b0z_urad)


class ThermalTable(ErrorTable):
    """Table [errors.thermal]: the spindle's growth, to ``spindle_um`` with the time constant ``spindle_minutes`` and
    by ``spindle_um_min`` besides; how much warmer the linear axes' scales are than the workpiece, ``scales_k``.
    """

    conditions: ClassVar[frozenset[str]] = frozenset({"spindle_minutes", "expansion_um_m_k"})

    spindle_um: Small = 0.0
    spindle_minutes: Length = 30.0
    spindle_um_min: Small = 0.0
    scales_k: Kelvin = 0.0
    expansion_um_m_k: Annotated[float, Field(ge=0.0, le=100.0, allow_inf_nan=False)] = 11.5

    @property
    def scale(self) -> float:
        """What the scales' temperature adds to the way of every linear axis, as a part of it."""
        return _MICRO * self.expansion_um_m_k * self.scales_k

    def growth(self) -> Growth:
        return Growth(_UM * self.spindle_um, self.spindle_minutes, _UM * self.spindle_um_min)


class MachineErrorsTable(ErrorTable):
    """Tables [errors.axes], [errors.squareness] and [errors.thermal]; zero is no error."""

    axes: AxesErrorsTable = AxesErrorsTable()
    squareness: SquarenessTable = SquarenessTable()
    thermal: ThermalTable = ThermalTable()

    def of_axes(self) -> MachineErrors:
        """The errors in mm and rad."""
        axes, scale = self.axes, self.thermal.scale
        return MachineErrors(
            {name: getattr(axes, name).errors(scale) for name in ("X", "Y", "Z")},
            {name: getattr(axes, name).errors() for name in ("A", "B", "C", "D")},
            self.squareness.errors(),
            self.thermal.growth(),
        )

    def real(self, machine: Machine | None, missing: str = "[machine]") -> RealMachine | None:
        """The machine with these errors, None where all are zero.

        Raises InputError for axes that it has not, and for errors where table ``missing`` gives no machine.
        """
        errors = self.of_axes()
        if machine is None and errors.act:
            raise InputError(
                f"errors: axes, squareness and thermal are a machine's that runs a program; give {missing}, or remove "
                "them"
            )
        try:
            return None if machine is None else errors.real(machine)
        except InputError as error:
            raise InputError(f"errors: {error}") from None
