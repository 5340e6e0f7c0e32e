"""Random and exact cases in batches: cut by the removal road, judged by the oracle, counted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.geometry.rays import RayBundle, join_rays
from gearsim.motion.segments import SegmentTable
from gearsim.simulation.removal import Job, Removal, cut_jobs
from gearsim.verify.torture import motions, rays, tools
from gearsim.verify.torture.judge import HIT, UNDECIDED, Claim, Judgement, judge

_SIZES = (1e-3, 0.0625, 0.1, 1.0, 1.0, 2.0, 8.0, 10.0, 16.0, 100.0, 1000.0)


@dataclass(frozen=True)
class Case:
    """A cutter, a motion and rays, with the names of their kinds: one ``ray_kind`` a ray. ``seed`` makes it again."""

    seed: tuple[int, ...]
    tool: str
    motion: str
    ray_kind: NDArray[np.str_]
    rays: RayBundle
    table: SegmentTable
    cutter: Profile


@dataclass(frozen=True)
class Tried:
    """A case with what was removed and what the oracle says of it."""

    case: Case
    removal: Removal
    judgement: Judgement

    @property
    def trusted(self) -> NDArray[np.bool_]:
        """Rays whose status is OK."""
        return self.removal.ray_status == 0

    @property
    def lost(self) -> NDArray[np.bool_]:
        return self.trusted & (self.judgement.lost == HIT)

    @property
    def spanned(self) -> NDArray[np.bool_]:
        return self.trusted & (self.judgement.spanned == HIT)

    @property
    def undecided(self) -> NDArray[np.bool_]:
        """Rays of which the oracle could neither say nor refute that all is well."""
        said = self.lost | self.spanned
        return self.trusted & ~said & ((self.judgement.lost == UNDECIDED) | (self.judgement.spanned == UNDECIDED))


def case(seed: tuple[int, ...], tool: str, motion: str, ray_kinds: Sequence[str], n: int) -> Case:
    """A random case of a tool and a motion, n rays of each ray kind; the same for the same seed."""
    rng = np.random.default_rng(seed)
    round_numbers = bool(rng.random() < 0.6) or motion == "grid"
    size = float(rng.choice(_SIZES)) if round_numbers else float(10.0 ** rng.uniform(-3.0, 3.0))
    cutter = tools.draw(tool, rng, size, round_numbers)
    table = motions.rows(motion, rng, size, cutter.reach)
    scene = rays.Scene(rng, cutter, table, size)
    bundles = [rays.bundle(scene, kind, n) for kind in ray_kinds]
    return Case(seed, tool, motion, np.repeat(ray_kinds, n), join_rays(bundles), table, cutter)


def try_cases(cases: Sequence[Case], tolerance: float, device: str = "cpu") -> list[Tried]:
    """Cut the cases by the removal road to ``tolerance`` [mm] and have the oracle judge what came out."""
    jobs = [Job(c.rays, c.table, c.cutter) for c in cases]
    removals = cut_jobs(jobs, device=device, tolerance=tolerance, slots=64)
    claims = [Claim(c.rays, c.table, c.cutter, r.removed) for c, r in zip(cases, removals, strict=True)]
    return [Tried(*t) for t in zip(cases, removals, judge(claims, tolerance), strict=True)]
