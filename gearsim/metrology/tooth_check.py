"""A generated tooth held against its blank: what no comparison with its own generating motion can say.

Surfaces that are the envelope of their own motion deviate from it by nothing, whatever the settings. Whether they are
the part's is judged by what the part demands: the bottom land at the root cone all along the face, flanks that meet it,
and at the mean cone distance, on the pitch cone, spiral angle, hand and the tooth's thickness where these are demanded.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from math import degrees, inf
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.findings import Finding, off_the_blank
from gearsim.metrology.inspection import Reading, Steps
from gearsim.surfaces.face_milled import FaceMilledTooth
from gearsim.surfaces.hypoid import HypoidPinion
from gearsim.surfaces.patch import SIDES, Side
from gearsim.surfaces.slot_checks import slot_and_pitch, spiral_angle
from gearsim.surfaces.slot_patch import GeneratedPatch
from gearsim.surfaces.tooth_demand import ToothDemand

if TYPE_CHECKING:
    from gearsim.metrology.job import Job

_ALONG, _ACROSS = 65, 9
_PLACES = 4
_UM = {"um": 1.0, "mm": 1e3}


@dataclass(frozen=True)
class ToothFigure:
    """One figure of a tooth: its least and greatest value along the face, in ``unit``, and what is ``wanted``.

    ``place`` [mm] is where it is farthest off; ``tolerance`` in the unit of the value, inf where nothing is wanted.
    ``hand``: that of a spiral angle, beside the ``wanted_hand``; empty: it has none, none is wanted.
    """

    name: str
    surface: str
    unit: str
    least: float
    most: float
    wanted: float | None
    tolerance: float
    place: NDArray
    hand: str = ""
    wanted_hand: str = ""

    @property
    def worst(self) -> float:
        """The value farthest from what is wanted."""
        return max(self.least, self.most, key=lambda value: abs(value - (self.wanted or 0.0)))

    @property
    def fails(self) -> bool:
        off = self.wanted is not None and not abs(self.worst - self.wanted) <= self.tolerance
        return off or self.wanted_hand not in ("", self.hand)

    @property
    def measured(self) -> str:
        """The value in words."""
        least, most = (f"{round(value, _PLACES):.4g}" for value in (self.least, self.most))
        value = f"{least if least == most else f'{least} to {most}'} {self.unit}"
        return f"{value}, {self.hand} hand" if self.hand else value

    @property
    def demanded(self) -> str:
        """What is wanted in words."""
        wanted = [] if self.wanted is None else [f"{self.wanted:g} ± {self.tolerance:g}"]
        wanted += [f"{self.wanted_hand} hand"] if self.wanted_hand else []
        return f"{', '.join(wanted) or 'none'} demanded"

    @property
    def depth_um(self) -> float | None:
        """How far too much material is left, where the figure is a length."""
        if self.wanted is None or self.unit not in _UM:
            return None
        return (self.worst - self.wanted) * _UM[self.unit]


@dataclass(frozen=True)
class ToothMeasurement:
    """The figures of a tooth beside its blank, as intended; what is machined is measured against that."""

    variant: str
    figures: tuple[ToothFigure, ...]
    surface: str = ""
    inspection: str = "tooth in its blank"


@dataclass(frozen=True)
class ToothInspection:
    """A generated tooth's intended surfaces held against their blank and a demand; nothing is cut for it."""

    variant: str
    tooth: FaceMilledTooth | HypoidPinion
    demand: ToothDemand
    name: str = "tooth in its blank"

    def steps(self, _: Job) -> Steps[Reading]:
        yield []
        figures = tuple(_Figures(self.tooth, self.demand).all())
        told = ", ".join(f"{f.name} {f.measured} ({f.demanded})" for f in figures if not f.fails)
        findings = tuple(self._finding(f) for f in figures if f.fails)
        return Reading(
            (ToothMeasurement(self.variant, figures),), findings, remarks=(f"the tooth in its blank: {told}",)
        )

    def _finding(self, figure: ToothFigure) -> Finding:
        text = f"the tooth does not sit in its blank: {figure.name} {figure.measured}, {figure.demanded}"
        return off_the_blank(figure.surface, self.tooth.blank, figure.place, figure.depth_um, text)


@dataclass(frozen=True)
class _Figures:
    tooth: FaceMilledTooth | HypoidPinion
    demand: ToothDemand

    def all(self) -> Iterator[ToothFigure]:
        """Depth, joins, spiral angle, thickness, and the land that is left of the tooth's tip."""
        yield self._depth()
        yield self._joins()
        yield from self._at_mean()
        yield self._land()

    def _depth(self) -> ToothFigure:
        """Height [um] of the bottom lands over the root cone, along the pitch cone's normal."""
        length, across = np.meshgrid(self._length, np.linspace(0.0, 1.0, _ACROSS))
        points = np.concatenate([self._points(b, length.ravel(), across.ravel()) for b in self.tooth.bottoms])
        cone, above = self.tooth.blank.cone_height(points)
        over = 1e3 * (above + np.asarray(self.tooth.blank.dedendum_at(cone)))
        return self._along("bottom land over the root cone", "bottom", "um", over, points, 0.0, self.demand.depth_um)

    def _joins(self) -> ToothFigure:
        """How far [um] the neighbouring edges of flank, fillet and bottom land are apart at one cone distance."""
        gaps, places = [], []
        for side in SIDES:
            for lower, upper in pairwise(self._edges(side)):
                gaps.append(1e3 * np.linalg.norm(upper[0] - lower[1], axis=1))
                places.append(upper[0])
        gap, points = np.concatenate(gaps), np.concatenate(places)
        return self._along("gap between flank, fillet and bottom land", "bottom", "um", gap, points, 0.0,
                           self.demand.join_um)  # fmt: skip

    def _edges(self, side: Side) -> Iterator[tuple[NDArray, NDArray]]:
        """Lower and upper edges [mm] of what lies on one side of the slot, from the bottom land up."""
        cut = self.tooth.cut(side)
        near = np.full(_ALONG, 0.0 if side == "concave" else 1.0)
        land = self._points(cut.bottom, self._length, near)
        yield land, land
        walls = [cut.fillet(side)] if cut.generated or not cut.sharp else []
        for patch in (*walls, self.tooth.flank(side)):
            lower, upper = (self._points(patch, self._length, np.full(_ALONG, end)) for end in (0.0, 1.0))
            yield lower, upper

    def _at_mean(self) -> Iterator[ToothFigure]:
        """Spiral angle [deg], both flanks' mean, and thickness [mm] around the axis, on the pitch cone at mean."""
        blank, at = self.tooth.blank, (np.array([self.tooth.blank.mean]), np.zeros(1))
        concave, convex = (flank.jet(*flank.meet(*at)) for flank in self._flanks)
        place, demand = 0.5 * (concave.r[0] + convex.r[0]), self.demand
        spiral = degrees(abs(np.mean([spiral_angle(blank, jet)[0] for jet in (concave, convex)])))
        slot, pitch = (float(x[0]) for x in slot_and_pitch(blank, concave, convex))
        angle = _one("spiral angle at mean", "deg", spiral, demand.spiral, demand.spiral_tolerance, place)
        yield replace(angle, hand=self._hand(), wanted_hand=demand.hand or "")
        tolerance = 1e-3 * demand.thickness_um
        yield _one("tooth thickness at mean", "mm", pitch - slot, demand.thickness, tolerance, place)

    def _hand(self) -> str:
        """Right where the outer half turns clockwise, seen from the apex: also of Zerol teeth, whose angle is 0."""
        blank, turn = self.tooth.blank, 0.0
        for flank in self._flanks:
            x, y, _ = flank.jet(*flank.meet(np.array([blank.mean, blank.cone_distance]), np.zeros(2))).r.T
            inner, outer = x + 1j * y
            turn += float(np.angle(outer / inner))
        return "right" if turn > 0.0 else "left" if turn < 0.0 else ""

    def _land(self) -> ToothFigure:
        """Width [mm] of the tooth's tip around the axis; more than nothing, or the scene is refused."""
        tips = [flank.jet(*flank.locate(self._length, np.ones(_ALONG))) for flank in self._flanks]
        slot, pitch = slot_and_pitch(self.tooth.blank, tips[0], tips[1])
        return self._along("top land", "convex", "mm", pitch - slot, tips[1].r, None, inf)

    @cached_property
    def _flanks(self) -> list[GeneratedPatch]:
        return [self.tooth.flank(side) for side in SIDES]

    @cached_property
    def _length(self) -> NDArray:
        return np.linspace(0.0, 1.0, _ALONG)

    def _points(self, patch: GeneratedPatch, length: NDArray, height: NDArray) -> NDArray:
        return patch.jet(*patch.locate(length, height)).r

    def _along(
        self, name: str, surface: str, unit: str, values: NDArray, points: NDArray, wanted: float | None,
        tolerance: float,
    ) -> ToothFigure:  # fmt: skip
        i = int(np.argmax(np.abs(values - (wanted or 0.0))))
        return ToothFigure(
            name, surface, unit, float(values.min()), float(values.max()), wanted, tolerance, points[i]
        )  # fmt: skip


def _one(name: str, unit: str, value: float, wanted: float | None, tolerance: float, place: NDArray) -> ToothFigure:
    return ToothFigure(name, "flanks", unit, value, value, wanted, tolerance if wanted is not None else inf, place)
