"""What a verdict must rest on: judged surfaces that something cut, samples that were compared; and what it must say."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from typing import TYPE_CHECKING, Literal

from gearsim.metrology.deviation import Crossing, Deviation
from gearsim.metrology.roads import LIMIT_UM, RoadGap
from gearsim.surfaces.part import Part

if TYPE_CHECKING:
    from gearsim.metrology.inspection import Reading

Verdict = Literal["pass", "fail", "unchecked"]
NOT_COMPARED = "the two roads were compared at no sample of"
_NAMED = 4


def untouched(surface: str, deviation: Deviation) -> list[str]:
    """Why nothing can be said of a judged surface: no ray of it meets a cut. Empty: at least one does."""
    cut = (deviation.crossing == Crossing.MEASURED) | (deviation.crossing == Crossing.THROUGH)
    return [] if cut.any() else [f"no operation touches {surface}: nothing of it was judged"]


def not_compared(surface: str, gaps: Iterable[RoadGap]) -> list[str]:
    """Why nothing confirms a judged surface: the two roads were compared at no sample of it. Empty: they were."""
    if sum(gap.valid for gap in gaps):
        return []
    return [f"{NOT_COMPARED} {surface}"]


def partly(surface: str, whole: int, judged: int, gaps: Iterable[RoadGap]) -> list[str]:
    """What of a judged surface of ``whole`` samples was not judged, or not compared by the two roads."""
    left = [f"{whole - judged} of {whole} samples of {surface} do not lie on the machined surface"] * (judged < whole)
    compared = max((gap.valid for gap in gaps), default=judged)
    if 0 < compared < judged:
        left.append(f"the two roads were compared at {compared} of {judged} samples of {surface}")
    return left


def no_agreement(what: str, gap: RoadGap | None) -> list[str]:
    """Why the roads' comparison forbids trust: they differ, or one cuts samples that the other does not."""
    if gap is None or gap.trusted:
        return []
    return [
        f"the two roads differ by {gap.max_um:.3g} um on {what} (limit {LIMIT_UM:g}); {gap.disagree} samples are cut "
        "by only one of them"
    ]


def spaces_left(count: int, measured: Collection[int], cut: Collection[int]) -> tuple[list[str], list[str]]:
    """What forbids trust, and what must be said, of a gear's spaces that no inspection measures by both roads.

    Of ``count`` some are ``measured`` and others ``cut``, numbered from 0. What is judged in one space is judged in all
    that the job cuts. Where it cuts one alone, the others are left to the same program and an indexing that is not
    the job's: that is said. Where it cuts several and leaves others uncut, it cannot be told what was meant.
    """
    left = [k + 1 for k in range(count) if k not in measured and k not in cut]
    told = ", ".join(map(str, left[:_NAMED])) + f" and {len(left) - _NAMED} more" * (len(left) > _NAMED)
    doubts, remarks = [], []
    if left and len(measured) + len(cut) == 1:
        remarks.append(f"1 of {count} spaces is cut and judged: what indexing to the others adds is not in it")
    elif left:
        doubts.append(f"nothing cuts {len(left)} of {count} spaces ({told}), though others are cut: not judged")
    if cut:
        remarks.append(f"{len(cut)} of {count} spaces were measured by one road only")
    return doubts, remarks


def no_witness(checked: int, check_um: float) -> list[str]:
    """Why the tri-dexel forbids trust: none of its ``checked`` cut ends lies near a surface, or they differ."""
    if not checked:
        return [
            "no cut end of the tri-dexel lies near a judged surface; a finer simulation.dexel_pitch_mm may find some"
        ]
    if check_um > LIMIT_UM:
        return [f"the tri-dexel differs from the rays by {check_um:.3g} um (limit {LIMIT_UM:g})"]
    return []


def verdict(part: Part, readings: Sequence[Reading]) -> tuple[Verdict, str]:
    """Pass or fail by the findings; unchecked where nothing was judged or anything forbids trust, with the reasons."""
    doubts = [doubt for reading in readings for doubt in reading.doubts]
    judged = {surface for reading in readings for surface in reading.judged}
    if not judged:
        doubts.append("nothing was judged: no surface is held against a tolerance (see metrology.judged)")
    else:
        wanted = (name for name, surface in part.surfaces.items() if surface.tolerance is not None)
        doubts += [f"{name} was not measured: nothing of it was judged" for name in wanted if name not in judged]
        free = (name for name, surface in part.surfaces.items() if surface.tolerance is None and name in judged)
        doubts += [f"{name} has no tolerance to be judged by" for name in free]
    if doubts:
        return "unchecked", "; ".join(dict.fromkeys(doubts))
    fails = any(finding.fails for reading in readings for finding in reading.findings)
    return ("fail" if fails else "pass"), "OK"


def headline(judged: Verdict, status: str, readings: Sequence[Reading], cut: bool = True) -> str:
    """What stands behind the verdict's word: the reason, then all that is known of what is left, cut or not judged.

    ``cut``: whether the job cuts anything.
    """
    findings = [finding for reading in readings for finding in reading.findings]
    failing = [finding.told for finding in findings if finding.fails]
    beside = [finding.told for finding in findings if not finding.fails]
    said = {
        "pass": ["every judged deviation is within tolerance" if cut else "nothing is cut, the comparison ran"],
        "fail": failing,
        "unchecked": [status, *failing],
    }[judged]
    if beside:
        said.append(f"known beside: {'; '.join(dict.fromkeys(beside))}")
    said += [remark for reading in readings for remark in reading.remarks]
    return "; ".join(dict.fromkeys(said))
