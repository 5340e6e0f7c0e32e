"""What a run leaves behind: arrays, statuses, timings and provenance, ready to be written."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from gearsim.cutters.profile import Profile
from gearsim.metrology.bevel import FlankResult, PatchResult
from gearsim.metrology.dexel_check import DexelResult
from gearsim.metrology.findings import Finding
from gearsim.motion.sources import MotionSource
from gearsim.surfaces.ruled_bevel import RuledBevelTooth, Side

Verdict = Literal["pass", "fail", "unchecked"]


@dataclass(frozen=True)
class Result:
    """A finished run.

    ``theory`` holds the planner's continuous motions (empty where the path came from a file),
    ``own_sources`` the CL motions that finish each flank; ``timings_s`` and ``counts`` have the keys of
    report.json.
    """

    scene: dict[str, Any]
    device: str
    tooth: RuledBevelTooth
    cutter: Profile
    cl_text: str
    flanks: dict[Side, FlankResult]
    patches: dict[str, PatchResult]
    dexels: DexelResult
    theory: dict[Side, MotionSource]
    own_sources: dict[Side, list[MotionSource]]
    findings: tuple[Finding, ...]
    verdict: Verdict
    status: str
    counts: dict[str, int]
    timings_s: dict[str, float]
    versions: dict[str, str]

    @property
    def exit_code(self) -> int:
        """0 within tolerance, 1 out of it, 3 where a numerical status forbids trust."""
        return {"pass": 0, "fail": 1, "unchecked": 3}[self.verdict]
