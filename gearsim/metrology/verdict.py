"""What a verdict must rest on: judged surfaces that something cut, and samples that were compared."""

from __future__ import annotations

from collections.abc import Iterable

from gearsim.metrology.deviation import Crossing, Deviation
from gearsim.metrology.dexel_check import DexelResult
from gearsim.metrology.roads import RoadGap


def untouched(surface: str, deviation: Deviation) -> list[str]:
    """Why nothing can be said of a judged surface: no ray of it meets a cut. Empty: at least one does."""
    cut = (deviation.crossing == Crossing.MEASURED) | (deviation.crossing == Crossing.THROUGH)
    return [] if cut.any() else [f"no operation touches {surface}: nothing of it was judged"]


def not_compared(surface: str, gaps: Iterable[RoadGap]) -> list[str]:
    """Why nothing confirms a judged surface: the two roads were compared at no sample of it. Empty: they were."""
    if sum(gap.valid for gap in gaps):
        return []
    return [f"the two roads were compared at no sample of {surface}"]


def no_witness(dexels: DexelResult) -> list[str]:
    """Why the tri-dexel confirms nothing: none of its cut ends lies near a judged surface."""
    if dexels.checked:
        return []
    return ["no cut end of the tri-dexel lies near a judged surface; a finer simulation.dexel_pitch_mm may find some"]
