"""Sculptured surfaces cut in three axes, by the chosen tool and by others beside it, with gouging predicted."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from gearsim.cutters.profile import Profile
from gearsim.gouging.choice import ContactInspection, MillInspection
from gearsim.gouging.inspection import GougingInspection
from gearsim.gouging.khan.inspection import WorkedInspection
from gearsim.metrology.grid import GridInspection
from gearsim.metrology.holder_check import HolderInspection
from gearsim.metrology.inspection import Inspection
from gearsim.metrology.job import Job
from gearsim.metrology.study import Change
from gearsim.processes.frames import NET_FRAME
from gearsim.processes.settings import settings
from gearsim.processes.worked_examples import CONVENTIONS
from gearsim.scene import SculpturedScene, scene_table
from gearsim.simulation.operation import Variant, operation
from gearsim.surfaces.nurbs import NurbsSurface
from gearsim.surfaces.part import Intended, Part, Tolerance
from gearsim.toolpaths.drop_cutter import drop_path
from gearsim.toolpaths.sculptured import SculpturedPath, contact_path


def plan(scene: SculpturedScene, folder: Path) -> Job:
    """Load the surface, a file of ``folder`` or a shipped one, and lay the passes of every tool."""
    surface = scene.surface.build(folder, scene.metrology.window_mm)
    tools = {f"{name} tool": cutter for name, cutter in scene.tools().items()}
    paths = {name: _path(scene, surface, cutter) for name, cutter in tools.items()}
    tolerance = scene.simulation.compile_tolerance_mm
    variants = tuple(
        Variant(name, f"the {name}'s passes: {cutter.name}", (
            operation(name, cutter, paths[name].motions(), tolerance, holder=scene.held() if k == 0 else None),
        ))
        for k, (name, cutter) in enumerate(tools.items())
    )  # fmt: skip
    limit = Tolerance(scene.metrology.tolerance_um, float("inf"))
    return Job(
        name=scene.name,
        part=Part(NET_FRAME, None, {surface.name: Intended(surface, limit)}),
        variants=variants,
        main=variants[0].name,
        inspections=tuple(_inspections(scene, surface.name, paths)),
        settings=settings(scene),
        scene=scene_table(scene),
        conventions=CONVENTIONS,
    )


def _inspections(scene: SculpturedScene, surface: str, paths: dict[str, SculpturedPath]) -> Iterator[Inspection]:
    m, names = scene.metrology, tuple(paths)
    compared = tuple(Change(name, "", {names[0]: name}) for name in names[1:])
    yield GougingInspection(
        surface, names[0], paths, compared, m.rows, m.columns, m.margin, m.ring_mm, m.tolerance_um
    )  # fmt: skip
    if scene.held() is not None:
        grid = GridInspection(surface, names[:1], (), m.rows, m.columns, m.margin)
        yield HolderInspection(names[0], (grid,))
    mills, margin = scene.catalogue.build(), scene.catalogue.margin
    yield MillInspection(surface, names[0], mills, margin, max(m.rows, m.columns))
    yield ContactInspection(surface, names, scene.plot.u, scene.plot.v)
    if scene.reference:
        yield WorkedInspection(scene.reference.sections, scene.reference.names, alone=False)


def _path(scene: SculpturedScene, surface: NurbsSurface, cutter: Profile) -> SculpturedPath:
    t = scene.toolpath
    chord = 1e-3 * t.chord_um
    if t.along == "u" or t.along == "v":
        return contact_path(surface, cutter, t.stepover_mm, t.points, along=t.along, margin=t.margin, tolerance=chord)
    return drop_path(surface, cutter, t.stepover_mm, t.points, along=t.along, tolerance=chord)
