"""The other spaces of a gear: what is judged in one exists in each, and is judged in all that the job cuts.

A few rays ask each space whether anything cuts it; those that are cut are measured on the grids of the first, turned by
whole pitches about the gear's axis, z, by one road.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import cos, pi, sin
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gearsim.geometry.rays import RayBundle, join_rays
from gearsim.geometry.rigid import Rigid
from gearsim.metrology.deviation import Deviation, measure
from gearsim.metrology.findings import Finding, cross_cut, out_of_tolerance, root_findings
from gearsim.metrology.grid import GridInspection, spread
from gearsim.metrology.inspection import Cut, Reading, Steps
from gearsim.metrology.samples import SampleGrid
from gearsim.metrology.verdict import spaces_left, untouched
from gearsim.surfaces.part import Tolerance

if TYPE_CHECKING:
    from gearsim.metrology.job import Job

_LOOKS = 3


class _There(NamedTuple):
    """A surface of the first space in another one: its grid turned there, and what was met."""

    inspection: GridInspection
    grid: SampleGrid
    deviation: Deviation


@dataclass(frozen=True)
class SpacesInspection:
    """The spaces of a gear of ``count`` that are not among those ``measured`` otherwise, numbered from 0.

    ``grids``: the judged surfaces of space 0, measured under ``variant``; ``roots``: those where material may stay.
    """

    variant: str
    count: int
    grids: tuple[GridInspection, ...]
    measured: tuple[int, ...] = (0,)
    roots: tuple[GridInspection, ...] = ()
    name: str = "other spaces"

    @property
    def all(self) -> tuple[GridInspection, ...]:
        return (*self.grids, *self.roots)

    def steps(self, job: Job) -> Steps[Reading]:
        others = tuple(k for k in range(self.count) if k not in self.measured)
        if not others:
            yield []
            return Reading()
        looks = [replace(grid, rows=_LOOKS, columns=_LOOKS).grid(job).rays() for grid in self.all]
        met = yield from self._ask(job, [_existing(rays) for rays in looks], others)
        touched = np.any([[_touched(one) for one in found] for found in met], axis=0)
        near = tuple(k for k, is_touched in zip(others, touched, strict=True) if is_touched)
        seen = (yield from self._measured(job, near)) if near else {}
        damage = {k: [f for one in there for f in self._overcut(job, k, one)] for k, there in seen.items()}
        hit = {k for k, there in seen.items() if damage[k] and not all(_touched(one.deviation) for one in there)}
        cut = {k: there for k, there in seen.items() if k not in hit}
        doubts, remarks = spaces_left(self.count, self.measured, cut)
        for k, there in cut.items():
            for one in there:
                doubts += untouched(f"{one.inspection.surface} in space {k + 1}", one.deviation)
        found = [f for k in hit for f in damage[k]]
        found += [f for k, there in cut.items() for one in there for f in self._beyond(job, k, one)]
        return Reading((), tuple(_worst(found)), tuple(doubts), (), tuple(remarks))

    def _measured(self, job: Job, spaces: Sequence[int]) -> Steps[dict[int, list[_There]]]:
        """The surfaces of the first space in others, measured on its grids."""
        grids = [inspection.grid(job) for inspection in self.all]
        measurable = [inspection.measurable(job, grid) for inspection, grid in zip(self.all, grids, strict=True)]
        bundles = [grid.rays().part(where.ravel()) for grid, where in zip(grids, measurable, strict=True)]
        met = yield from self._ask(job, bundles, spaces)
        out: dict[int, list[_There]] = {k: [] for k in spaces}
        for inspection, grid, where, found in zip(self.all, grids, measurable, met, strict=True):
            for k, one in zip(spaces, found, strict=True):
                turned = replace(grid, point=_turn(k, self.count).point(grid.point))
                out[k].append(_There(inspection, turned, spread(one, where)))
        return out

    def _ask(self, job: Job, bundles: Sequence[RayBundle], spaces: Sequence[int]) -> Steps[list[list[Deviation]]]:
        """Deviations along the rays of each surface, turned into each of some spaces."""
        turned = [join_rays([rays.moved(_turn(k, self.count)) for k in spaces]) for rays in bundles]
        variants = [job.variant(self.variant, grid.surface) for grid in self.all]
        removed = yield [Cut(rays, variant) for rays, variant in zip(turned, variants, strict=True)]
        return [
            measure(rays, cut).split([len(rays) // len(spaces)] * len(spaces))
            for rays, cut in zip(turned, removed, strict=True)
        ]

    def _overcut(self, job: Job, space: int, one: _There) -> Iterator[Finding]:
        """Where a space is cut deeper than it may be, as by a pass through its neighbour."""
        for finding in cross_cut(one.grid, one.deviation, self._tolerance(job, one)):
            if finding.fails:
                yield replace(finding, text=f"{finding.text} in space {space + 1}")

    def _beyond(self, job: Job, space: int, one: _There) -> Iterator[Finding]:
        """What is out of tolerance in a space that is cut."""
        tolerance, where = self._tolerance(job, one), f"in space {space + 1}"
        if one.inspection in self.roots:
            found = root_findings([(one.grid, one.deviation)], [tolerance])
            yield from (replace(finding, text=f"{finding.text}, {where}") for finding in found)
        else:
            yield from out_of_tolerance(one.grid, one.deviation, tolerance, f"under {self.variant} {where}")

    def _tolerance(self, job: Job, one: _There) -> Tolerance | None:
        return job.part.surfaces[one.inspection.surface].tolerance


def _turn(space: int, count: int) -> Rigid:
    """From the first space to another."""
    c, s = cos(2.0 * pi * space / count), sin(2.0 * pi * space / count)
    return Rigid(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), np.zeros(3))


def _existing(rays: RayBundle) -> RayBundle:
    """The rays of points that there are."""
    return rays.part(np.isfinite(rays.origin).all(axis=1))


def _touched(deviation: Deviation) -> bool:
    """Whether any ray meets a cut."""
    return not untouched("", deviation)


def _worst(found: Sequence[Finding]) -> Iterator[Finding]:
    """Of each kind of finding on a surface the largest, and in how many other spaces there is one."""
    kinds: dict[tuple[str, str], list[Finding]] = {}
    for finding in found:
        kinds.setdefault((finding.kind, finding.patch), []).append(finding)
    for alike in kinds.values():
        worst = max(alike, key=lambda finding: abs(finding.depth_um or 0.0))
        more = f" (and in {len(alike) - 1} other spaces)" if len(alike) > 1 else ""
        yield replace(worst, text=worst.text + more)
