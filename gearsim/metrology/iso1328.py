"""Flank tolerances of cylindrical gears after ISO 1328-1:2013, and the class that a measured value achieves.

Formulas as public implementations agree on them; where a licensed copy of the standard is at hand, it rules.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees, floor, hypot, sqrt

from gearsim.errors import InputError

CLASSES = range(1, 12)
PARAMETERS = ("f_p", "F_p", "f_Halpha", "f_falpha", "F_alpha", "f_Hbeta", "f_fbeta", "F_beta")


@dataclass(frozen=True)
class GearSize:
    """What the tolerances depend on: |z|, m_n, d, b [mm] and the helix angle [rad] (its sign does not count).

    Raises InputError outside the standard's scope: its formulas are not to be extrapolated.
    """

    teeth: int
    module: float
    reference_diameter: float
    face_width: float
    helix_angle: float = 0.0

    def __post_init__(self) -> None:
        scope = (
            ("number of teeth |z|", abs(self.teeth), 5, 1000, ""),
            ("reference diameter d", self.reference_diameter, 5.0, 15000.0, " mm"),
            ("normal module m_n", self.module, 0.5, 70.0, " mm"),
            ("face width b", self.face_width, 4.0, 1200.0, " mm"),
            ("helix angle |beta|", degrees(abs(self.helix_angle)), 0.0, 45.0, " deg"),
        )
        for name, value, low, high, unit in scope:
            if not low <= value <= high * (1.0 + 1e-12):
                raise InputError(
                    f"ISO 1328-1:2013 gives no tolerances for {name} = {value:g}{unit}: its scope is {low:g} to "
                    f"{high:g}{unit}, and its formulas must not be extrapolated"
                )


def unrounded_um(size: GearSize, gear_class: int) -> dict[str, float]:
    """Tolerances [um] of a class (1 to 11) before rounding, by the names in ``PARAMETERS``.

    Raises InputError for a class that does not exist.
    """
    if gear_class not in CLASSES:
        raise InputError(f"ISO 1328-1:2013 has flank tolerance classes 1 to 11, not {gear_class}")
    m, d, b = size.module, size.reference_diameter, size.face_width
    s = sqrt(2.0) ** (gear_class - 5)
    slope_a, form_a = (0.4 * m + 0.001 * d + 4.0) * s, (0.55 * m + 5.0) * s
    slope_b, form_b = (0.05 * sqrt(d) + 0.35 * sqrt(b) + 4.0) * s, (0.07 * sqrt(d) + 0.45 * sqrt(b) + 4.0) * s
    return {
        "f_p": (0.001 * d + 0.4 * m + 5.0) * s,
        "F_p": (0.002 * d + 0.55 * sqrt(d) + 0.7 * m + 12.0) * s,
        "f_Halpha": slope_a,
        "f_falpha": form_a,
        "F_alpha": hypot(slope_a, form_a),
        "f_Hbeta": slope_b,
        "f_fbeta": form_b,
        "F_beta": hypot(slope_b, form_b),
    }


def rounded_um(value: float) -> float:
    """A tolerance [um] as the standard prints it: to 1 above 10, to 0.5 from 5 to 10, to 0.1 below 5.

    Halves go up; what lies within 1e-9 steps of a half counts as one.
    """
    step = 1.0 if value > 10.0 else 0.5 if value >= 5.0 else 0.1
    return round(floor(value / step + 0.5 + 1e-9) * step, 1)


def tolerances_um(size: GearSize, gear_class: int) -> dict[str, float]:
    """Tolerances [um] of a class, rounded; the slopes' hold for both signs (+-)."""
    return {name: rounded_um(value) for name, value in unrounded_um(size, gear_class).items()}


def achieved_class(size: GearSize, parameter: str, value_um: float) -> int | None:
    """The smallest class whose rounded tolerance |value| does not exceed; None beyond class 11 or for nan."""
    for gear_class in CLASSES:
        if abs(value_um) <= tolerances_um(size, gear_class)[parameter]:
            return gear_class
    return None
