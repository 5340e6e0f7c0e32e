"""What a control lets pass as an arc: how far the numbers of a program may be off the circle they state."""

from __future__ import annotations

from dataclasses import dataclass, replace

INCH = 25.4


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
        return replace(self, centre_mm=tolerance, centre_inch=tolerance / INCH)


# Parameter 3410 as machine builders set it. Least increment of the finest system (IS-E): 1e-6 mm; all digits are read.
FANUC_ARCS = ArcRules(
    centre_mm=0.01, centre_inch=0.01 / INCH, share=0.0, largest=1.0, radius_mm=0.01, radius_inch=0.01 / INCH,
    smallest_mm=1e-6, smallest_inch=1e-6 / INCH, same_angle=0.0, same_distance=1e-6,
)  # fmt: skip
# LinuxCNC 2.9: ``src/emc/rs274ngc/interp_internal.hh`` and ``interp_arc.cc``; the angle is posemath's CIRCLE_FUZZ.
LINUXCNC_ARCS = ArcRules(
    centre_mm=2 * 0.01 * 2**0.5, centre_inch=2 * 0.001 * 2**0.5, share=1e-3, largest=100.0,
    radius_mm=0.00005 * INCH, radius_inch=0.00005, smallest_mm=0.00005 * INCH, smallest_inch=0.00005,
    same_angle=1e-6, same_distance=0.0,
)  # fmt: skip
