"""What a study's figures are held against: tolerances of surfaces and of ISO 1328-1, as one of its jobs has them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf

from gearsim.errors import GearsimError
from gearsim.metrology.gear_inspection import gear_size
from gearsim.metrology.gear_iso import GearProbing
from gearsim.metrology.iso1328 import tolerances_um
from gearsim.processes.run import plan
from gearsim.scene.loading import scene_of
from gearsim.studies.chunk import tables_of
from gearsim.studies.records import Study
from gearsim.surfaces.part import Tolerance
from gearsim.surfaces.patch import Way

_SHARES = (Way("first edge to last [share]"), Way("first edge to last [share]"))


@dataclass(frozen=True)
class Frame:
    """Tolerances by surface, the ways along and up each, and tolerances [um] by parameter of ISO 1328-1."""

    tolerances: Mapping[str, Tolerance] = field(default_factory=dict)
    ways: Mapping[str, tuple[Way, Way]] = field(default_factory=dict)
    iso_um: Mapping[str, float] = field(default_factory=dict)
    iso_class: int | None = None

    def ways_of(self, surface: str) -> tuple[Way, Way]:
        return self.ways.get(surface, _SHARES)

    def limits(self, figure: str) -> tuple[float, float]:
        """Between which values [um] a figure is tolerated; infinite where nothing limits it."""
        if figure.startswith("iso."):
            limit = self.iso_um.get(figure.split(".")[1], inf)
            return -limit, limit
        surface, _, what = figure.rpartition(".")
        tolerance = self.tolerances.get(surface)
        if tolerance is None or what not in ("min_um", "max_um"):
            return -inf, inf
        return -tolerance.overcut_um, tolerance.excess_um


def frame_of(study: Study, job: int) -> Frame:
    """What a job of the study tolerates, as it is planned; nothing where it cannot be."""
    try:
        planned = plan(scene_of(tables_of(study, job), study.name), study.folder)
    except GearsimError:
        return Frame()
    surfaces = planned.part.surfaces
    probings = [i for i in planned.inspections if isinstance(i, GearProbing)]
    return Frame(
        {name: s.tolerance for name, s in surfaces.items() if s.tolerance is not None},
        {name: s.patch.ways for name, s in surfaces.items()},
        tolerances_um(gear_size(probings[0].probed.gear), probings[0].gear_class) if probings else {},
        probings[0].gear_class if probings else None,
    )
