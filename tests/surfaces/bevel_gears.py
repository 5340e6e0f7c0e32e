"""Face-milled bevel gears from first principles: settings that put a head's circle on the mean point."""

from __future__ import annotations

from math import atan2, cos, radians, sin

from gearsim.cutters.catalogue import face_mill_head
from gearsim.machines.generator import CradleGenerator
from gearsim.surfaces.blank import BevelBlank, outer_cone_distance, pitch_angle
from gearsim.surfaces.face_milled import FaceMilledTooth


def settings(spiral, radius, mean, pitch, root, hand="left"):
    """The generator whose head of ``radius`` [mm] runs at the spiral angle [rad] through the mean point.

    In the cradle's plane the mean point lies ``mean`` [mm] from the cradle axis; the circle's tangent leans by the
    spiral angle. Cradle and work roll like a plane gear and this one on their pitch cones: ratio cos(dedendum angle)
    / sin(pitch angle).
    """
    x, y = mean - radius * sin(spiral), radius * cos(spiral)
    sign = -1.0 if hand == "left" else 1.0
    return CradleGenerator((x * x + y * y) ** 0.5, sign * atan2(y, x), root, cos(pitch - root) / sin(pitch))


def gear(spiral_deg, hand="left", teeth=33, mate=9, shaft_deg=90.0, edge=1.524, width=2.54, **changes):
    """A gear like Zhou's (module 4.8338, face 27.5, head 63.5 mm) with another spiral angle, number of teeth, shaft.

    The heights of a tooth are his if the gear has more teeth than its mate, else the mate's, both at his cone
    distance; the root cone's apex is that of the pitch cone's dedendum angle.
    """
    pitch = pitch_angle(teeth, mate, radians(shaft_deg))
    cone = outer_cone_distance(4.8338, teeth, pitch)
    scale = cone / 82.6707
    wheel = teeth >= mate
    addendum, dedendum = (1.76, 7.67) if wheel else (6.7968, 2.6332)
    over, under = (1.3718, 5.1616) if wheel else (5.1616, 1.3718)
    blank = BevelBlank(
        teeth, pitch, cone, 27.5 * scale, addendum, dedendum, pitch + radians(over) / scale,
        pitch - radians(under) / scale, 0.8732, 8.0,
    )  # fmt: skip
    lower = blank.root_apex * sin(blank.root_angle)
    generator = settings(radians(spiral_deg), 63.5 * scale, blank.mean, pitch, blank.root_angle, hand)
    from dataclasses import replace

    generator = replace(generator, sliding_base=-lower, **changes)
    return FaceMilledTooth(blank, face_mill_head(63.5 * scale, width, *[radians(22.0)] * 2, edge, 12.0), generator)
