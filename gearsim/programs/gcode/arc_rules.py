"""What a control lets pass as an arc: how far the numbers of a program may be off the circle they state."""

from __future__ import annotations

from dataclasses import dataclass, replace

INCH = 25.4
_MET = 1e-9  # [mm] what meets a limit exactly is within it, whatever the last bit says


@dataclass(frozen=True)
class ArcRules:
    """A control's limits; lengths of the first five are in the units in force, by ``_mm`` and ``_inch``.

    | limit | meaning |
    | --- | --- |
    | ``centre_mm``, ``centre_inch`` | how far the radii at both ends of an arc given by its centre may differ |
    | ``share`` | beyond that: as a part of the larger radius |
    | ``largest`` | but never more than so many times the first limit |
    | ``radius_mm``, ``radius_inch`` | how far a given radius may be short of half the chord |
    | ``smallest_mm``, ``smallest_inch`` | radii below are none |
    | ``same_angle`` [rad], ``same_distance`` [mm] | ends nearer to each other are one point: a full circle |
    """

    centre_mm: float
    centre_inch: float
    share: float
    largest: float
    radius_mm: float
    radius_inch: float
    smallest_mm: float
    smallest_inch: float
    same_angle: float
    same_distance: float

    def centre(self, scale: float) -> float:
        """The limit for arcs by their centre, where a unit has ``scale`` [mm]."""
        return self.centre_inch if scale == INCH else self.centre_mm

    def radius(self, scale: float) -> float:
        """The limit for arcs by their radius."""
        return self.radius_inch if scale == INCH else self.radius_mm

    def smallest(self, scale: float) -> float:
        """The radius below which there is no circle."""
        return self.smallest_inch if scale == INCH else self.smallest_mm

    def with_centre(self, tolerance: float | None) -> ArcRules:
        """The same with another limit [mm] for arcs by their centre (None: the control's own)."""
        if tolerance is None:
            return self
        return replace(self, centre_mm=tolerance + _MET, centre_inch=(tolerance + _MET) / INCH)


# Fanuc: parameter 3410 set to 0.01 mm; all digits are read, so ends are the same within half the least increment
# of the finest system, IS-E.
_FANUC_LIMIT, _FANUC_INCREMENT = 0.01 + _MET, 1e-6
FANUC_ARCS = ArcRules(
    centre_mm=_FANUC_LIMIT, centre_inch=_FANUC_LIMIT / INCH, share=0.0, largest=1.0,
    radius_mm=_FANUC_LIMIT, radius_inch=_FANUC_LIMIT / INCH,
    smallest_mm=_FANUC_INCREMENT, smallest_inch=_FANUC_INCREMENT / INCH, same_angle=0.0,
    same_distance=0.5 * _FANUC_INCREMENT,
)  # fmt: skip
# LinuxCNC 2.9: ``src/emc/rs274ngc/interp_internal.hh`` and ``interp_arc.cc``, bit for bit, as its own interpreter
# decides; the angle is posemath's CIRCLE_FUZZ.
LINUXCNC_ARCS = ArcRules(
    centre_mm=2 * 0.01 * 2**0.5, centre_inch=2 * 0.001 * 2**0.5, share=1e-3, largest=100.0,
    radius_mm=0.00005 * INCH, radius_inch=0.00005, smallest_mm=0.00005 * INCH, smallest_inch=0.00005,
    same_angle=1e-6, same_distance=0.0,
)  # fmt: skip
