"""The largest mill of a catalogue for a surface, point by point and for all of it; and one contact to be drawn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from gearsim.gouging.check import where_met
from gearsim.gouging.fitting import contacts_of, largest_for_all, size_map
from gearsim.gouging.khan.sizes import SideBySide
from gearsim.gouging.lines import face_lines, longest_line
from gearsim.gouging.looked import look
from gearsim.gouging.prediction import Prediction, predict
from gearsim.metrology.inspection import Reading, Steps
from gearsim.metrology.samples import SampleGrid
from gearsim.surfaces.face import Face
from gearsim.surfaces.nurbs import NurbsSurface

if TYPE_CHECKING:
    from gearsim.metrology.job import Job

AXIS = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class SizeChoice:
    """The largest mill of a catalogue (R, r) at every point of a grid [mm], nan: none; one mill for all (None: no
    contact), limited at ``place`` [mm].
    """

    grid: SampleGrid
    shank: NDArray
    corner: NDArray
    mills: NDArray
    whole: SideBySide | None
    place: tuple[float, ...]


@dataclass(frozen=True)
class MillMeasurement:
    """The largest mills of a surface; ``variant`` is the tool that was looked with."""

    surface: str
    variant: str
    sizes: SizeChoice
    inspection: str = "largest mill"


@dataclass(frozen=True)
class MillInspection:
    """As ``gearsim gouge`` has it: the largest of ``mills`` (R, r), shape (m, 2), at every point, and for all."""

    surface: str
    variant: str
    mills: NDArray
    margin: float
    lines: int
    name: str = "largest mill"

    def steps(self, job: Job) -> Steps[Reading]:
        yield []
        surface = cast(NurbsSurface, job.part.patch(self.surface))
        face = Face(surface.name, surface)
        lines = face_lines(face, longest_line(face) / max(self.lines - 1, 1), self.lines, self.margin)
        seen = look(face, lines, job.variant(self.variant).cutter, AXIS, "cpu")
        contacts = contacts_of([seen], where_met([face], [lines], self.margin), AXIS)
        both, choice, shape = largest_for_all(contacts, self.mills), size_map(seen, self.mills), seen.grid.shape
        place = tuple(float(x) for x in contacts.place(both.best.limiting)) if both else (np.nan,) * 3
        sizes = SizeChoice(
            seen.grid, choice.shank.reshape(shape), choice.corner.reshape(shape), self.mills, both, place
        )  # fmt: skip
        return Reading((MillMeasurement(self.surface, self.variant, sizes),))


@dataclass(frozen=True)
class PlotPoint:
    """A contact at (u, v), ``point`` [mm], with the prediction of every tool by name."""

    u: float
    v: float
    point: NDArray
    tools: dict[str, Prediction]


@dataclass(frozen=True)
class ContactMeasurement:
    """One contact with the prediction of every tool; ``variant`` is the first of them."""

    surface: str
    variant: str
    plotted: PlotPoint
    inspection: str = "contact"


@dataclass(frozen=True)
class ContactInspection:
    """The contact at ``u``, ``v`` (shares of the domain) under the tools of some variants."""

    surface: str
    variants: tuple[str, ...]
    u: float
    v: float
    name: str = "contact"

    def steps(self, job: Job) -> Steps[Reading]:
        yield []
        surface = cast(NurbsSurface, job.part.patch(self.surface))
        u, v = surface.locate([self.u], [self.v])
        tools = {name: predict(surface, job.variant(name).cutter, u, v) for name in self.variants}
        point = PlotPoint(float(u[0]), float(v[0]), surface.jet(u, v).r[0], tools)
        return Reading((ContactMeasurement(self.surface, self.variants[0], point),))
