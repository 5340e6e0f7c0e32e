"""The root of a tooth slot after everything: the deepest cut and the most material left over all its surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gearsim.metrology.deviation import measure
from gearsim.metrology.findings import root_findings
from gearsim.metrology.grid import DENSE, GridMeasurement
from gearsim.metrology.inspection import Cut, Reading, Steps
from gearsim.metrology.samples import sample_grid
from gearsim.metrology.verdict import untouched

if TYPE_CHECKING:
    from gearsim.metrology.job import Job


@dataclass(frozen=True)
class RootInspection:
    """Fillets and bottom land together under one variant, each on a grid as of ``GridInspection``; one road only."""

    surfaces: tuple[str, ...]
    variant: str
    rows: int
    columns: int
    margin: float
    window: float = 1.0
    name: str = DENSE

    def steps(self, job: Job) -> Steps[Reading]:
        grids = [
            sample_grid(job.part.patch(s), self.rows, self.columns, self.margin, self.window) for s in self.surfaces
        ]
        bundles = [grid.rays() for grid in grids]
        removed = yield [
            Cut(rays, job.variant(self.variant, s)) for s, rays in zip(self.surfaces, bundles, strict=True)
        ]
        found = []
        for surface, grid, rays, cut in zip(self.surfaces, grids, bundles, removed, strict=True):
            nowhere = np.zeros(grid.shape, dtype=bool)
            deviation = measure(rays, cut).reshaped(grid.shape)
            found.append(
                GridMeasurement(
                    surface, job.variant(self.variant, surface), self.name, grid, nowhere, nowhere, deviation
                )
            )
        tolerances = [job.part.surfaces[s].tolerance for s in self.surfaces]
        findings = root_findings([(m.grid, m.deviation) for m in found], tolerances)
        doubts = tuple(reason for m in found for reason in untouched(f"the {m.surface}", m.deviation))
        remark = f"{', '.join(self.surfaces)}: by one road only, for passes of both flanks meet there"
        return Reading(tuple(found), tuple(findings), doubts, self.surfaces, (remark,))
