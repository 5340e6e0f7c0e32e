"""The measuring machine: rays cut by a motion and read as deviations, with running totals."""

from __future__ import annotations

from collections.abc import Callable

from gearsim.cutters.profile import Profile
from gearsim.geometry.rays import RayBundle, join_rays
from gearsim.metrology.deviation import Deviation, measure
from gearsim.motion.segments import SegmentTable
from gearsim.simulation.intervals import IntervalSet
from gearsim.simulation.removal import cut


class MeasuringMachine:
    """Measures rays under motions of one cutter on one device; refuses results it cannot trust.

    Owns the totals of a run: ``rays``, ``candidates``, ``pairs`` and ``kernel_s``.
    """

    def __init__(
        self, cutter: Profile, device: str, tolerance: float, slots: int,
        progress: Callable[[int], None] | None = None,
    ):  # fmt: skip
        self.cutter, self.device, self.tolerance, self.slots = cutter, device, tolerance, slots
        self.progress = progress or (lambda n: None)
        self.rays = self.candidates = self.pairs = 0
        self.kernel_s = 0.0

    def removed(self, rays: RayBundle, table: SegmentTable) -> IntervalSet:
        """What the motion removes from the rays. Raises NumericalError where a status forbids trust."""
        result = cut(
            rays, table, self.cutter, device=self.device, tolerance=self.tolerance, slots=self.slots,
            progress=self.progress,
        ).require_trust()  # fmt: skip
        self.rays += len(rays)
        self.candidates += result.candidates
        self.pairs += result.pairs
        self.kernel_s += result.kernel_s
        return result.removed

    def measure(self, bundles: list[RayBundle], table: SegmentTable) -> list[Deviation]:
        """Deviations along the rays of several bundles, cut in one launch."""
        rays = join_rays(bundles)
        return measure(rays, self.removed(rays, table)).split([len(b) for b in bundles])


MachineFor = Callable[[Profile], MeasuringMachine]
