"""The mean profile of a bevel gear's flank: Zhou's points L0, L1, ... in the profile plane of the mean point."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.deviation import measure
from gearsim.metrology.inspection import Cut, Reading, Steps
from gearsim.metrology.samples import profile_rays
from gearsim.surfaces.patch import ToothSurface

if TYPE_CHECKING:
    from gearsim.metrology.job import Job

_SLACK_MM = 1e-6


@dataclass(frozen=True)
class Published:
    """Printed deviations [um] of one flank at the profile's points, in our sign, and where they stand."""

    source: str
    note: str
    overcut_is_positive: bool
    um: tuple[float, ...]


@dataclass(frozen=True)
class ProfileMeasurement:
    """Deviations [um] by L0, L1, ... at heights ``offsets_mm`` from the contact path: along the surface's normal and
    along the profile's in its plane; nan at heights where the flank has ended.
    """

    surface: str
    variant: str
    offsets_mm: tuple[float, ...]
    normal_um: dict[str, float]
    in_plane_um: dict[str, float]
    published: Published | None = None
    inspection: str = "mean profile"


@dataclass(frozen=True)
class ProfileInspection:
    """The mean profile of one flank under one variant, ``contact_height`` [mm] above the root cone."""

    surface: str
    variant: str
    offsets_mm: tuple[float, ...]
    contact_height: float
    published: Published | None = None
    name: str = "mean profile"

    def steps(self, job: Job) -> Steps[Reading]:
        patch = cast(ToothSurface, job.part.patch(self.surface))
        lines = profile_rays(patch, np.array(self.offsets_mm), self.contact_height)
        variant = job.variant(self.variant, self.surface)
        removed = yield [Cut(rays, variant) for rays in lines]
        there = _on_flank(patch, lines[0].origin)
        found_um = (1e3 * measure(rays, r).value for rays, r in zip(lines, removed, strict=True))
        normal, in_plane = (np.where(there, um, np.nan) for um in found_um)
        names = [f"L{i}" for i in range(len(self.offsets_mm))]
        along, across = (dict(zip(names, um.tolist(), strict=True)) for um in (normal, in_plane))
        found = ProfileMeasurement(self.surface, self.variant, self.offsets_mm, along, across, self.published)
        return Reading((found,))


def _on_flank(patch: ToothSurface, points: NDArray) -> NDArray:
    """Which points [mm] of a flank's continuation, shape (n, 3), lie between its own lower and upper edge."""
    cone, height = patch.blank.cone_height(points)
    share = np.nan_to_num((cone - patch.blank.toe) / patch.blank.face_width)
    edges = (patch.jet(*patch.locate(share, np.full(len(share), end))).r for end in (0.0, 1.0))
    lower, upper = (patch.blank.cone_height(edge)[1] for edge in edges)
    return np.asarray((height >= lower - _SLACK_MM) & (height <= upper + _SLACK_MM))
