"""Patches of a bevel slot on generated sheets: where they lie on the real blank, and how far to look from them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import pi
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.surfaces.blank import BevelBlank
from gearsim.surfaces.generated import GeneratedJet, Sheet
from gearsim.surfaces.lengthwise import mean_profile
from gearsim.surfaces.patch import SIDES, Part, Side, Way, patch_name, slot_ways

_STEPS = 60
_WALK = 12
_SCAN = 721
_SEARCH = pi / 3.0  # cradle angles to either side of the centre among which a tooth is looked for
_SETTLED = 1e-12
_FOUND = 1e-9


class FaceRun(NamedTuple):
    """A run of u along which a sheet's cone distance [mm] rises through the face; ``at_mean`` is the motion's
    parameter in its middle."""

    u: NDArray
    cone: NDArray
    at_mean: float


def face_run(sheet: Sheet, blank: BevelBlank, v: float) -> FaceRun | None:
    """The run at profile arc length v [mm] that is cut nearest to the motion's middle, or None where there is none.

    A head at rest crosses the cone twice; its tooth lies where the gear's axial plane of y = 0 is.
    """
    u, at = np.linspace(*sheet.span, _SCAN), np.full(_SCAN, v)
    r, phi = sheet.jet(u, at).r, np.abs(sheet.pose_parameter(u, at))
    cone, above = blank.cone_height(r)
    beyond, reach = cone - blank.mean, 2.0 * blank.whole_depth_at(blank.cone_distance)
    with np.errstate(invalid="ignore"):
        near = (np.abs(above[1:]) < reach) & (phi[1:] <= _SEARCH)
        crossing = np.flatnonzero((beyond[1:] * beyond[:-1] <= 0.0) & near)
        rise = np.diff(cone)
    if not len(crossing):
        return None
    around = np.abs(np.arctan2(r[crossing, 1], r[crossing, 0])).round(9)
    middle = crossing[np.lexsort((np.abs(u[crossing]), around, phi[crossing].round(9)))[0]]
    sense = np.sign(rise[middle])
    stops = np.flatnonzero(~(rise * sense > 0.0))
    low, high = stops[stops < middle].max(initial=-1) + 1, stops[stops > middle].min(initial=_SCAN - 1)
    run = slice(low, high + 1)
    order = slice(None, None, int(sense))
    return FaceRun(u[run][order], cone[run][order], float(phi[middle]))


def never_cuts(blank: BevelBlank, name: str, reach: str) -> str:
    """What is wrong where a head misses a part of the slot; ``reach`` says in words where the head passes."""
    return (
        f"the head never cuts the {name} at the mean cone distance {blank.mean:.4g} mm: {reach}, the face lies "
        f"{blank.toe:.4g} to {blank.cone_distance:.4g} mm from the apex; check radial distance, cradle angle, machine "
        "root angle, ratio of roll and the head's radius"
    )


class GeneratedTooth(Protocol):
    """What a patch needs of its tooth."""

    @property
    def blank(self) -> BevelBlank: ...

    def sheet(self, part: Part, side: Side) -> Sheet: ...

    def reach(self, side: Side) -> str: ...

    def flank(self, side: Side) -> GeneratedPatch: ...


@dataclass(frozen=True)
class GeneratedPatch:
    """One part of a generated slot as a surface r(u, v): ``flank``, ``fillet`` or ``bottom``.

    u [rad] is the angle about the head's axis, v [mm] the arc length on its profile element ([rad] on a sharp edge).
    """

    tooth: GeneratedTooth
    part: Part
    side: Side

    @property
    def name(self) -> str:
        return patch_name(self.part, self.side)

    @property
    def blank(self) -> BevelBlank:
        """The gear blank the tooth is cut into."""
        return self.tooth.blank

    @property
    def ways(self) -> tuple[Way, Way]:
        """Along the slot, and up or across it."""
        return slot_ways(self.blank, self.part)

    @property
    def parameters(self) -> tuple[str, str]:
        """What u and v are called in tables."""
        return "u", "arc_length_mm"

    @cached_property
    def sheet(self) -> Sheet:
        """The surface without its limits on the blank."""
        return self.tooth.sheet(self.part, self.side)

    def jet(self, u: NDArray, v: NDArray) -> GeneratedJet:
        """Points and derivatives at parameters u, v, any shapes that broadcast to (n,)."""
        u, v = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(v, dtype=float))
        return self.sheet.jet(u, v)

    @property
    def ends(self) -> tuple[float, float]:
        """v [mm] at the root-side and at the other end of the profile element.

        The bottom land runs from the concave wall to the convex one. Elements follow the head's chain,
        whose outer side goes up from the tip land and whose inner side comes down to it.
        """
        rises = self.part != "bottom" and self.side == "concave"
        return (0.0, self.sheet.element.length) if rises else (self.sheet.element.length, 0.0)

    def pose_parameter(self, u: NDArray, v: NDArray) -> NDArray:
        """The motion's parameter at which points are cut (see `FaceMilledTooth.poses`), broadcast to shape (n,)."""
        u, v = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(v, dtype=float))
        return self.sheet.pose_parameter(u, v)

    def locate(self, length: NDArray, height: NDArray) -> tuple[NDArray, NDArray]:
        """Parameters (u, v) of points given on the real blank, both of one shape, each in [0, 1].

        ``length`` 0 is the toe, 1 the heel, by the point's own cone distance; ``height`` 0 is the patch's
        root-side edge, 1 its tip-side edge (for a flank, where it meets the face cone), in between v is
        linear at one cone distance. Raises InputError where the surface does not reach that far.
        """
        length, height = np.broadcast_arrays(np.asarray(length, dtype=float), np.asarray(height, dtype=float))
        shape, cone = length.shape, (self.blank.toe + self.blank.face_width * length).ravel()
        start, end = self.ends
        top = np.full(cone.shape, end)
        if self.part == "flank":
            _, top = self.meet(cone, np.asarray(self.blank.addendum_at(cone)))
            over = (top - start) / (end - start)
            if over.max(initial=0.0) > 1.0:
                raise InputError(
                    f"the head's blade ends below the tooth's tip: its {self.name} edge is {abs(end - start):.4g} mm "
                    f"long, {abs(end - start) * over.max():.4g} mm are needed to reach the face cone"
                )
        v = start + height.ravel() * (top - start)
        return self._solve(cone, v, by_height=False)[0].reshape(shape), v.reshape(shape)

    def meet(self, cone: NDArray, above: NDArray) -> tuple[NDArray, NDArray]:
        """Parameters (u, v) where the patch, prolonged, has cone distances and heights over the pitch cone.

        Both [mm], shape (n,). Raises InputError where it never does.
        """
        return self._solve(cone, above, by_height=True)

    def mean_profile(self, contact_height: float, offsets: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """u, v and the plane's normal of the profile through the mean point: see `ToothSurface`."""
        one, other = (self.tooth.flank(side) for side in SIDES)
        return mean_profile((one, other), self, contact_height + np.asarray(offsets, dtype=float))

    def windows(self, u: NDArray, v: NDArray) -> tuple[NDArray, NDArray]:
        """Half the tooth's thickness and half the slot's width [mm] about points, shape (n,).

        Between points of both flanks of one cone distance and height, around the gear axis, times the
        cosine of the spiral angle; fillets and bottom land take the values where the flank begins.
        """
        cone, above = self.blank.cone_height(self.jet(u, v).r)
        wall = self if self.part == "flank" else self.tooth.flank(self.side)
        if wall is not self:
            u, v = wall._solve(cone, np.full(cone.shape, wall.ends[0]), by_height=False)
            above = self.blank.cone_height(wall.jet(u, v).r)[1]
        here = wall.jet(u, v)
        other = self.tooth.flank("concave" if wall.side == "convex" else "convex")
        there = other.jet(*other.meet(cone, above)).r
        turn = np.angle((there[:, 0] + 1j * there[:, 1]) / (here.r[:, 0] + 1j * here.r[:, 1]))
        radius, across = np.hypot(here.r[:, 0], here.r[:, 1]), self._spiral_cosine(here)
        slot = 0.5 * radius * np.abs(turn) * across
        return pi * radius / self.blank.teeth * across - slot, slot

    def _spiral_cosine(self, jet: GeneratedJet) -> NDArray:
        """Cosine of the angle between the flank's trace in the cone through a point and the generator."""
        generator, normal = self.blank.cone_directions(jet.r)
        trace = np.cross(jet.normal, normal)
        return np.abs(_dot(trace, generator)) / np.linalg.norm(trace, axis=1)

    @property
    def _middle(self) -> float:
        start, end = self.ends
        half = 0.5 * abs(end - start)
        return start + np.sign(end - start) * min(half, 0.5 * float(self.blank.whole_depth_at(self.blank.mean)))

    @cached_property
    def _run(self) -> FaceRun:
        run = face_run(self.sheet, self.blank, self._middle)
        if run is None:
            raise InputError(never_cuts(self.blank, f"{self.side} {self.part}", self.tooth.reach(self.side)))
        return run

    def _solve(self, cone: NDArray, target: NDArray, by_height: bool) -> tuple[NDArray, NDArray]:
        """Points of given cone distance and v, or height over the pitch cone instead of v.

        Led from the middle of the profile to the target in steps, since an envelope may not exist at one height
        of the profile where it does at another.
        """
        u, v = np.interp(cone, self._run.cone, self._run.u), np.full(cone.shape, self._middle)
        u, v, moved = self._settle(u, v, cone, target, by_height, _WALK)
        if not moved.max(initial=0.0) < _FOUND:
            bad = int(np.argmax(~(moved < _FOUND)))
            height = "over the pitch cone" if by_height else "along the profile"
            raise InputError(
                f"the generated {self.name} does not reach cone distance {cone[bad]:.4g} mm at "
                f"{target[bad]:.4g} mm {height}: the head leaves the slot, or the motion has no envelope there; "
                f"{self.tooth.reach(self.side)}"
            )
        return u, v

    def _settle(
        self, u: NDArray, v: NDArray, cone: NDArray, target: NDArray, by_height: bool, walk: int
    ) -> tuple[NDArray, NDArray, NDArray]:
        """Newton's method from (u, v), the target reached in ``walk`` steps.

        Returns u, v and how far [mm] the last step moved the points: nan or much where there are none.
        """
        first = self.blank.cone_height(self.jet(u, v).r)[1] if by_height else v
        for i in range(_STEPS):
            share = min(1.0, (i + 1) / walk)
            du, dv, moved = self._step(u, v, cone, first + share * (target - first), by_height)
            u, v = u + du, v + dv
            if share == 1.0 and not (moved >= _SETTLED * self.blank.cone_distance).any():
                break
        return u, v, moved

    def _step(
        self, u: NDArray, v: NDArray, cone: NDArray, target: NDArray, by_height: bool
    ) -> tuple[NDArray, NDArray, NDArray]:
        """One step of Newton's method, and how far [mm] it moves the points, each of shape (n,)."""
        at = self.jet(u, v)
        generator, normal = self.blank.cone_directions(at.r)
        found, above = self.blank.cone_height(at.r)
        if by_height:
            du, dv = _solve2(generator, normal, at, cone - found, target - above)
        else:
            dv = target - v
            du = (cone - found - _dot(generator, at.rv) * dv) / _dot(generator, at.ru)
        return du, dv, np.abs(du) * np.linalg.norm(at.ru, axis=1) + np.abs(dv)


def _solve2(first: NDArray, second: NDArray, at: GeneratedJet, e: NDArray, f: NDArray) -> tuple[NDArray, NDArray]:
    """Steps of u and v that move points by e along the first and by f along the second direction, to first order."""
    a, b, c, d = (_dot(p, q) for p in (first, second) for q in (at.ru, at.rv))
    return (e * d - b * f) / (a * d - b * c), (a * f - c * e) / (a * d - b * c)


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("ij,ij->i", a, b)
