"""Flank milling of a generated tooth with a conical cutter, for comparison with the ruled one (Zhou 4.4.2)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import cos, sin, tan

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.geometry import series
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.series import Series
from gearsim.motion.sources import CLMotion, CurveMotion
from gearsim.surfaces.patch import SIDES
from gearsim.surfaces.slot_patch import GeneratedPatch
from gearsim.toolpaths.tangent import check_mouth, cl_points, tangent_pose

_STATIONS = 65


@dataclass(frozen=True)
class GeneratedFlankPath:
    """The pass that finishes one generated flank from toe to heel, as `FlankPath` does the ruled one.

    The flank has no rule: in its place stands the tangent of its profile, in the plane normal to the pitch
    cone's generator through the contact point. The contact path lies at mid working depth, and the cutter's
    flank begins ``start_height`` [mm] over the root cone, measured along that tangent: the height at which
    the blade's edge radius ends (neither rule is given in the source; both follow 4.23-4.27). ``run`` [mm]
    is how far the path goes on beyond toe and heel. The parameter is the contact's cone distance [mm].
    """

    patch: GeneratedPatch
    cutter: Profile
    start_height: float
    run: float

    @property
    def motion(self) -> CurveMotion:
        """The theoretical motion over the face and its run-in and run-out.

        Raises InputError where the flank, prolonged, does not reach that far.
        """
        cone = self._track[0]
        return CurveMotion(self.poses, float(cone[0]), float(cone[-1]))

    def cl_motion(self, points: int) -> CLMotion:
        """The path as CL data with ``points`` points over the face, the run at the same spacing."""
        return cl_points(self.motion, self.patch.blank.toe, self.patch.blank.cone_distance, points)

    def contact_height(self, cone: NDArray | float) -> NDArray:
        """Height [mm] of the contact path over the pitch cone: mid working depth (Zhou 4.23)."""
        return np.asarray(self.patch.blank.mid_working_depth_at(cone)) - self.patch.blank.dedendum_at(cone)

    def poses(self, cone: NDArray, order: int) -> PoseSeries:
        """Tip and axis as series in the contact's cone distance [mm], shape (n,) (Zhou 4.24-4.27).

        nan where the flank, prolonged, does not reach that cone distance.
        """
        blank = self.patch.blank
        contact, normal = self._contact(np.asarray(cone, dtype=float), order)
        generator, up = self._cone_frame(contact)
        rule = series.unit(series.cross(generator, normal))
        rise = series.dot(rule, up)
        sense = np.sign(rise.value)
        depth = Series.variable(cone, order) * self._slope + float(blank.mid_working_depth_at(0.0))
        distance = (depth - self.start_height) / (rise * sense)
        return tangent_pose(self.cutter, contact, rule * sense[:, None], -normal, distance)

    def check_passage(self) -> None:
        """Raise InputError where the cutter would cut the next tooth's tip away (`check_mouth`)."""
        blank, length = self.patch.blank, np.linspace(0.0, 1.0, _STATIONS)
        cone = blank.toe + blank.face_width * length
        tips = [(wall, wall.locate(length, np.ones(_STATIONS))) for wall in map(self.patch.tooth.flank, SIDES)]
        mouth = np.mean([wall.jet(*at).r for wall, at in tips], axis=0)
        half_land, half_mouth = self.patch.windows(*tips[SIDES.index(self.patch.side)][1])
        check_mouth(self.cutter, self.poses(cone, 0), mouth, cone, half_land, half_mouth)

    @cached_property
    def _track(self) -> NDArray:
        """Cone distance [mm] and the flank's parameters along the contact path, shape (3, n).

        Raises InputError where the flank, prolonged, does not reach that far.
        """
        blank = self.patch.blank
        cone = np.linspace(blank.toe - self.run, blank.cone_distance + self.run, _STATIONS)
        return np.stack([cone, *self.patch.meet(cone, self.contact_height(cone))])

    @property
    def _slope(self) -> float:
        """Rise of the mid working depth along the cone."""
        blank = self.patch.blank
        return 0.5 * (tan(blank.face_angle - blank.pitch) + tan(blank.pitch - blank.root_angle))

    def _contact(self, cone: NDArray, order: int) -> tuple[Series, Series]:
        """The contact path and the flank's normal on it.

        The surface's parameters become series: each step with the first derivatives at the point itself
        makes one more order of cone distance and height come right.
        """
        blank, target = self.patch.blank, Series.variable(cone, order)
        along, *track = self._track
        near = (np.interp(cone, along, track[0]), np.interp(cone, along, track[1]))
        u0, v0 = self.patch.seek(cone, self.contact_height(cone), near)
        jet = self.patch.jet(u0, v0)
        generator, up = blank.cone_directions(jet.r)
        a, b, c, d = (np.sum(p * q, axis=1) for p in (generator, up) for q in (jet.ru, jet.rv))
        height = target * (self._slope - tan(blank.pitch - blank.root_angle)) + float(self.contact_height(0.0))
        nil = Series(np.zeros_like(target.c))
        u, v = nil + u0, nil + v0
        for _ in range(order + 1):
            point, _ = self.patch.sheet.curve(u, v)
            e, f = self._misses(point, target, height)
            u = u + (e * d - f * b) / (a * d - b * c)
            v = v + (f * a - e * c) / (a * d - b * c)
        return self.patch.sheet.curve(u, v)

    def _misses(self, point: Series, cone: Series, height: Series) -> tuple[Series, Series]:
        """What cone distance and height of points lack."""
        x, y, z = (Series(point.c[..., k]) for k in range(3))
        radius, pitch = series.sqrt(x * x + y * y), self.patch.blank.pitch
        return (
            cone - (radius * sin(pitch) + z * cos(pitch)),
            height - (radius * cos(pitch) - z * sin(pitch)),
        )

    def _cone_frame(self, point: Series) -> tuple[Series, Series]:
        """The pitch cone's generator and its outward normal through points."""
        x, y = Series(point.c[..., 0]), Series(point.c[..., 1])
        radius, pitch = series.sqrt(x * x + y * y), self.patch.blank.pitch
        c, s, nil = x / radius, y / radius, Series(np.zeros_like(x.c))
        return (
            series.stack([c * sin(pitch), s * sin(pitch), nil + cos(pitch)]),
            series.stack([c * cos(pitch), s * cos(pitch), nil - sin(pitch)]),
        )
