"""The two roads held against each other: our own error, which must be nanometres."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.envelope import EnvelopeRoad, machined_along
from gearsim.metrology.deviation import Deviation
from gearsim.metrology.samples import SampleGrid
from gearsim.motion.sources import MotionSource

LIMIT_UM = 1e-3


@dataclass(frozen=True)
class RoadGap:
    """Envelope road against removal road along the same rays, under one motion.

    ``gap_um`` (of the rays' shape) is nan where ``road`` found no class in the window: those samples are
    ``excluded``. ``disagree`` counts samples that one road cuts and the other does not.
    """

    road: EnvelopeRoad
    gap_um: NDArray[np.floating]
    excluded: int
    disagree: int

    @property
    def max_um(self) -> float:
        return float(np.max(self.gap_um, initial=0.0, where=np.isfinite(self.gap_um)))

    @property
    def valid(self) -> int:
        return int(np.isfinite(self.gap_um).sum())

    @property
    def trusted(self) -> bool:
        """At or below 1 nm wherever there is a machined surface, and agreed on where there is none."""
        return self.max_um <= LIMIT_UM and self.disagree == 0


def compare_roads(grid: SampleGrid, cutter: Profile, sources: Sequence[MotionSource], removal: Deviation) -> RoadGap:
    """Solve the envelope road along a grid's normals and compare it with the removal road's deviation."""
    return road_gap(machined_along(grid.rays(), sources, cutter), removal)


def road_gap(road: EnvelopeRoad, removal: Deviation) -> RoadGap:
    """The envelope road against the removal road's deviations along the same rays."""
    gap = 1e3 * np.abs(road.deviation - removal.value.ravel())
    return RoadGap(
        road,
        gap.reshape(removal.value.shape),
        int(np.count_nonzero(~road.valid)),
        int(np.count_nonzero(road.valid != removal.measured.ravel())),
    )
