"""Face-milled bevel gears from first principles: settings that lead a head's circle through the mean point."""

from __future__ import annotations

from math import atan2, cos, hypot, radians, sin

from gearsim.cutters.catalogue import face_mill_head
from gearsim.machines.generator import CradleGenerator
from gearsim.surfaces.blank import BevelBlank, outer_cone_distance, pitch_angle
from gearsim.surfaces.face_milled import FaceMilledTooth

MODULE, HEAD, FACE = 4.8338, 63.5 / 82.6707, 27.5 / 82.6707
WHEEL, PINION = (1.76, 7.67, 1.3718, 5.1616), (6.7968, 2.6332, 5.1616, 1.3718)


def settings(spiral, radius, blank, hand):
    """The generator whose head of ``radius`` [mm] crosses the mean point at the spiral angle [rad].

    In the cradle's plane the mean point lies at the mean cone distance, and the circle's tangent there leans by the
    spiral angle. The cradle is a plane gear, the work rolls on it: ratio cos(dedendum angle) / sin(pitch angle). The
    tip plane touches the root cone, whose apex is not that of the pitch cone.
    """
    x, y = blank.mean - radius * sin(spiral), radius * cos(spiral)
    ratio = cos(blank.pitch - blank.root_angle) / sin(blank.pitch)
    return CradleGenerator(
        hypot(x, y), (-1.0 if hand == "left" else 1.0) * atan2(y, x), blank.root_angle, ratio,
        sliding_base=-blank.root_apex * sin(blank.root_angle),
    )  # fmt: skip


def gear(spiral_deg, hand="left", teeth=33, mate=9, shaft_deg=90.0, edge=1.524, width=2.54, blade=12.0):
    """A gear like Zhou's with another spiral angle, tooth numbers, shaft angle, edge radius, point width [mm].

    Face and head are in proportion to the cone distance, the tooth's heights and angles those of his wheel, or of his
    pinion where the mate has more teeth.
    """
    pitch = pitch_angle(teeth, mate, radians(shaft_deg))
    cone = outer_cone_distance(MODULE, teeth, pitch)
    addendum, dedendum, over, under = WHEEL if teeth >= mate else PINION
    face, root = pitch + radians(over) * 82.6707 / cone, pitch - radians(under) * 82.6707 / cone
    blank = BevelBlank(teeth, pitch, cone, FACE * cone, addendum, dedendum, face, root, 0.8732, 8.0)
    head = face_mill_head(HEAD * cone, width, radians(22.0), radians(22.0), edge, blade)
    return FaceMilledTooth(blank, head, settings(radians(spiral_deg), HEAD * cone, blank, hand))
