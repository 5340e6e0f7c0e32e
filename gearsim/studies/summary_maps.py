"""The worst jobs of a study drawn: maps of their surfaces, all on one scale."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil

from gearsim.output.heat import draw_map, limit_of
from gearsim.output.panels import Room, page
from gearsim.output.saving import Save
from gearsim.studies.records import SurfaceMap
from gearsim.studies.summary_frame import Frame

_DPI = 130
_MOST = 6  # surfaces


def scales(jobs: Mapping[int, Mapping[str, SurfaceMap]]) -> dict[str, float]:
    """Where the scale [um] of each surface ends, one for all jobs; the surfaces with the greatest deviations first."""
    found: dict[str, float] = {}
    for maps in jobs.values():
        for surface, one in maps.items():
            found[surface] = max(found.get(surface, 0.0), limit_of(one.deviation_um))
    return dict(sorted(found.items(), key=lambda item: -item[1])[:_MOST])


def draw_job(
    maps: Mapping[str, SurfaceMap], limits: Mapping[str, float], frame: Frame, save: Save, name: str
) -> None:  # fmt: skip
    """The maps of one job, two beside each other."""
    shown = [s for s in limits if s in maps]
    columns = min(2, len(shown))
    figure, axes = page(
        ceil(len(shown) / columns), columns, (2.75, 1.9), Room(left=0.6, right=0.75, across=1.25, top=0.4, up=0.85)
    )
    for axis, surface in zip(axes.flat, shown, strict=False):
        one = maps[surface]
        draw_map(axis, frame.ways_of(surface), (one.u, one.v), one.deviation_um, surface, limits[surface],
                 frame.tolerances.get(surface))  # fmt: skip
        axis.set_title(axis.get_title(), fontsize=9, y=1.03)
    for axis in axes.flat[len(shown) :]:
        axis.set_visible(False)
    save(figure, name, _DPI)
