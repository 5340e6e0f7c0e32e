"""Operations in sequence on a blank, held against a solid part."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from gearsim.metrology.holder_check import HolderInspection
from gearsim.metrology.inspection import Inspection
from gearsim.metrology.job import Job
from gearsim.metrology.stock_check import StockInspection
from gearsim.motion.sources import CLMotion
from gearsim.processes.blanks import Given, given_blank
from gearsim.processes.settings import settings
from gearsim.scene import scene_table
from gearsim.scene.solid_part import DrillTable, MillTable, SequenceScene, SolidScene
from gearsim.simulation.operation import Operation, Variant, operation
from gearsim.surfaces.faced_solid import FacedPart
from gearsim.surfaces.machined_solid import MachinedSolid
from gearsim.surfaces.part import Part
from gearsim.toolpaths.counts import check_count
from gearsim.toolpaths.straight import Move, drilled, from_above, milled

FRAME = "part frame: the frame of [surface], the tool axis is +z"
PROGRAM = "program"


def plan(scene: SolidScene, folder: Path) -> Job:
    """Lay the operations' paths; the tool comes by rapid from the top of the blank and goes back there."""
    given = given_blank(scene.stock, folder)
    return Job(
        name=scene.name,
        part=Part(FRAME, None, {}),
        variants=(Variant(PROGRAM, "all operations in sequence", tuple(in_order(_operations(scene, given.top)))),),
        main=PROGRAM,
        inspections=whole_inspections(scene, given, scene.part()),
        settings=settings(scene),
        scene=scene_table(scene),
        notes=given.told,
    )


def whole_inspections(
    scene: SequenceScene, given: Given, intended: MachinedSolid | FacedPart
) -> tuple[Inspection, ...]:  # fmt: skip
    """The whole stock against an intended solid, and what stands above the tools' flutes against the stock."""
    table = scene.stock
    turning = table.turning.build(None) if table.turning else None
    box = given.box(table.pitch_mm, others=[intended.body])
    asked = StockInspection(
        PROGRAM,
        given.solid,
        box,
        rapid_mm_min=table.rapid_mm_min,
        intended=intended,
        saved=given.saved,
        turning=turning,
    )
    turned = turning.kept if turning else None
    held = (HolderInspection(PROGRAM, (), box, given.solid, turned=turned),) if scene.holders() else ()
    return asked, *held


def _operations(scene: SolidScene, top: float) -> Iterator[Operation]:
    cutters, holders = scene.cutters(), scene.holders()
    for table in scene.operations:
        moves = straight_moves(table, top)
        sources = [CLMotion(m.tips, np.tile([0.0, 0.0, 1.0], (len(m.tips), 1))) for m in moves]
        yield operation(
            table.name, cutters[table.tool], sources, scene.simulation.compile_tolerance_mm,
            rapid=[m.rapid for m in moves], holder=holders.get(table.tool),
            seconds=[_seconds(m, table.feed_mm_min) for m in moves],
        )  # fmt: skip


def straight_moves(table: DrillTable | MillTable, top: float) -> list[Move]:
    """Moves of drilled holes or milled lines, from and to the ``top`` [mm] of the blank.

    Raises InputError for more pecks than there may be.
    """
    if isinstance(table, DrillTable):
        if table.peck_mm is not None:
            check_count(table.clear_mm - table.bottom_mm, table.peck_mm, what=f"{table.name}: peck_mm")
        moves = list(drilled(table.at_mm, table.clear_mm, table.bottom_mm, table.peck_mm))
    else:
        moves = list(milled(table.points_mm, table.clear_mm))
    return list(from_above(moves, top))


def in_order(operations: Iterable[Operation]) -> Iterator[Operation]:
    """Operations one after the other: their steps count on."""
    step = 0
    for made in operations:
        yield replace(made, step=made.step + step)
        step += len(made.sources)


def _seconds(move: Move, feed: float) -> list[float]:
    """On the way to each of its points; nan by rapid."""
    way = np.linalg.norm(np.diff(move.tips, axis=0), axis=1)
    return [np.nan, *(np.full(len(way), np.nan) if move.rapid else 60.0 * way / feed)]
