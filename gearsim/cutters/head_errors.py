"""How the face-mill head that cuts differs from the nominal one: set, ground and worn otherwise."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, tan
from typing import NamedTuple

from gearsim.cutters.grinding import face_mill_head
from gearsim.cutters.mill_errors import lifted
from gearsim.cutters.profile import Profile


class HeadSizes(NamedTuple):
    """The parameters of ``face_mill_head``, lengths in mm and angles in rad."""

    radius: float
    point_width: float
    inner_angle: float
    outer_angle: float
    edge_radius: float
    height: float


@dataclass(frozen=True)
class HeadErrors:
    """Errors of a head; lengths in mm, angles in rad; all zero: the head as its settings name it.

    | error | meaning |
    | --- | --- |
    | radius, point_width, inner_angle, outer_angle, edge_radius | added to the parameter of ``face_mill_head`` |
    | runout | the head's axis lies this far off the spindle's, parallel to it: the ring is wider on both sides |
    | length | the head stands this much farther towards the gear, along its axis |
    | inner_wear, outer_wear | the flank of the inside or the outside blade has receded by this much, along its normal |
    | tip_wear | the tip land has receded by this much along the axis, between flanks that stay |
    """

    radius: float = 0.0
    point_width: float = 0.0
    inner_angle: float = 0.0
    outer_angle: float = 0.0
    edge_radius: float = 0.0
    runout: float = 0.0
    length: float = 0.0
    inner_wear: float = 0.0
    outer_wear: float = 0.0
    tip_wear: float = 0.0

    def head(self, nominal: Profile, sizes: HeadSizes) -> Profile:
        """What sweeps in the place of a ``nominal`` head of some sizes; itself where nothing is wrong with it.

        Raises InputError where it can be none.
        """
        if self == HeadErrors():
            return nominal
        inner, outer = sizes.inner_angle + self.inner_angle, sizes.outer_angle + self.outer_angle
        half, off = 0.5 * (sizes.point_width + self.point_width), abs(self.runout)
        inside = sizes.radius + self.radius - half - off + self.inner_wear / cos(inner) - self.tip_wear * tan(inner)
        outside = sizes.radius + self.radius + half + off - self.outer_wear / cos(outer) + self.tip_wear * tan(outer)
        real = face_mill_head(
            0.5 * (inside + outside), outside - inside, inner, outer, sizes.edge_radius + self.edge_radius,
            sizes.height - self.tip_wear,
        )  # fmt: skip
        return Profile(real.name, tuple(lifted(e, self.tip_wear - self.length) for e in real.elements))
