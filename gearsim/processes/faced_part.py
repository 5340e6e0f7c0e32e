"""A part bounded by NURBS faces: operations in sequence on a blank, every face held along normals and by whole rays."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.geometry.solid import Solid
from gearsim.metrology.grid import GridInspection
from gearsim.metrology.inspection import Inspection
from gearsim.metrology.job import Job
from gearsim.motion.sources import CLMotion
from gearsim.processes.blanks import given_blank
from gearsim.processes.settings import settings
from gearsim.processes.solid_part import PROGRAM, in_order, straight_moves, whole_inspections
from gearsim.programs.cldata import RAPID, CLPath, assemble
from gearsim.scene import FacedScene, scene_table
from gearsim.scene.faced_part import AnyOperation, LayersTable, PassesTable, unit
from gearsim.simulation.operation import Operation, Variant, operation
from gearsim.surfaces.faced_solid import FacedPart
from gearsim.surfaces.part import Intended, Part
from gearsim.toolpaths.layers import layers
from gearsim.toolpaths.links import clear_rapids
from gearsim.toolpaths.over_face import over_face

FRAME = "part frame: the frame of the file of [surface]"
OWN, LAST = "own passes", "last operation"


class Way(NamedTuple):
    """A motion of a tool, its feed [mm/min], None by rapid, and the face that it finishes, if it is a pass over one."""

    motion: CLMotion
    feed: float | None
    face: str = ""


def plan(scene: FacedScene, folder: Path) -> Job:
    """Load the part, a file of ``folder`` or a shipped one, and lay the operations' paths."""
    given, intended = given_blank(scene.stock, folder), scene.part(folder)
    ways = [list(_ways(operation, intended, given.solid, scene)) for operation in scene.operations]
    made = tuple(in_order(_operation(scene, k, found) for k, found in enumerate(ways)))
    own = tuple(_own_passes(scene, made, ways))
    faces = {face.name: face for face in intended.body.faces}
    machined = [face.name for face in scene.surface.faces]
    return Job(
        name=scene.name,
        part=Part(FRAME, None, {name: Intended(faces[name], intended.tolerances[name]) for name in machined}),
        variants=(Variant(PROGRAM, "all operations in sequence", made), *own),
        main=PROGRAM,
        inspections=(*_along_normals(scene, own), *whole_inspections(scene, given, intended)),
        settings=settings(scene),
        notes=given.told,
        scene=scene_table(scene),
        conventions={"grids": "rows along v of a face, columns along its u"},
    )


def _own_passes(scene: FacedScene, made: Sequence[Operation], ways: Sequence[list[Way]]) -> Iterator[Variant]:
    """Of every face the passes of the last operation over it, alone: what both roads are asked of."""
    for face in scene.surface.faces:
        mine = [np.flatnonzero([way.face == face.name for way in found]) for found in ways]
        last = max((k for k, motions in enumerate(mine) if len(motions)), default=None)
        if last is not None:
            rows = np.isin(made[last].table.path, mine[last])
            yield Variant(OWN, "the finishing passes over the face, alone", (made[last].part(rows),), (face.name,))


def _along_normals(scene: FacedScene, own: Sequence[Variant]) -> Iterator[Inspection]:
    m, finished = scene.metrology, {name for variant in own for name in variant.surfaces}
    for face in scene.surface.faces:
        passes = (OWN,) if face.name in finished else ()
        yield GridInspection(
            face.name, (PROGRAM, *passes), passes, m.rows, m.columns, m.margin, judged=(PROGRAM,),
            last="" if passes else LAST,
        )  # fmt: skip


def _operation(scene: FacedScene, k: int, ways: list[Way]) -> Operation:
    table = scene.operations[k]
    return operation(
        table.name, scene.cutters()[table.tool], [way.motion for way in ways], scene.simulation.compile_tolerance_mm,
        rapid=[way.feed is None for way in ways], holder=scene.holders().get(table.tool),
        seconds=[_seconds(way) for way in ways],
    )  # fmt: skip


def _ways(table: AnyOperation, part: FacedPart, blank: Solid, scene: FacedScene) -> Iterator[Way]:
    cutter, axis = scene.cutters()[table.tool], np.array([0.0, 0.0, 1.0])
    if isinstance(table, PassesTable):
        yield from _passes(table, part, blank, cutter)
        return
    if isinstance(table, LayersTable):
        axis = unit(table.direction)
        moves = layers(
            part.body, blank, cutter, axis, table.depth_mm, table.stepover_mm, table.allowance_mm, table.clear_mm
        )  # fmt: skip
    else:
        moves = straight_moves(table, float(blank.box[1][2]))
    for move in moves:
        yield Way(CLMotion(move.tips, np.tile(axis, (len(move.tips), 1))), None if move.rapid else table.feed_mm_min)


def _passes(table: PassesTable, part: FacedPart, blank: Solid, cutter: Profile) -> Iterator[Way]:
    """Over every face with every allowance, rapids between them clear of the blank."""
    faces = {face.name: face for face in part.body.faces}
    found: dict[str, list[CLMotion]] = {}
    finishing: dict[str, str] = {}
    for k, (allowance, name) in enumerate(itertools.product(table.allowances_mm, table.faces)):
        axis, way = table.axis.build(faces, name), f"{k}"
        found[way] = over_face(
            faces[name], cutter, axis, table.stepover_mm, along=table.along, allowance=allowance,
            tolerance=1e-3 * table.chord_um, points=table.points,
        )  # fmt: skip
        if k >= (len(table.allowances_mm) - 1) * len(table.faces):
            finishing[way] = name
    whole = [CLPath(name, *_joined(motions), feed=table.feed_mm_min) for name, motions in found.items()]
    linked = clear_rapids(assemble(whole, table.retract_mm, cutter), cutter, blank, table.retract_mm)
    for path in linked.paths:
        for motion in found.get(path.name, [CLMotion(path.tips, path.axes)]):
            yield Way(motion, None if path.name == RAPID else path.feed, finishing.get(path.name, ""))


def _joined(motions: list[CLMotion]) -> tuple[NDArray, NDArray]:
    """Tips and axes of motions that each begin where the last one ends."""
    tips, axes = ([getattr(m, name)[:-1] for m in motions] for name in ("tips", "axes"))
    return np.concatenate([*tips, motions[-1].tips[-1:]]), np.concatenate([*axes, motions[-1].axes[-1:]])


def _seconds(way: Way) -> list[float]:
    """On the way to each of its points; nan by rapid."""
    length = np.linalg.norm(np.diff(way.motion.tips, axis=0), axis=1)
    return [np.nan, *(np.full(len(length), np.nan) if way.feed is None else 60.0 * length / way.feed)]
