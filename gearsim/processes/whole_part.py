"""The whole part as stock: what a scene's [stock] adds to its job, whatever is cut."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from gearsim.errors import InputError
from gearsim.geometry.rigid import frame
from gearsim.geometry.solid import Solid
from gearsim.geometry.turned import Turned
from gearsim.geometry.wedge import Wedge
from gearsim.metrology.holder_check import HolderInspection
from gearsim.metrology.job import Job
from gearsim.metrology.other_spaces import SpacesInspection
from gearsim.metrology.stock_check import StockInspection
from gearsim.processes.blanks import Given, given_blank
from gearsim.scene.stock import StockTable
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.sequence import whole_box
from gearsim.surfaces.part import Part


def with_stock(job: Job, table: StockTable, folder: Path) -> Job:
    """The job with its whole blank cut by its main variant, too, if it is not; its file is looked up in ``folder``.

    Raises InputError where there is nothing to cut, no blank, or spaces that are not known or already in the program.
    """
    if any(isinstance(i, StockInspection) for i in job.inspections):
        return job
    if not job.variants:
        raise InputError(f"stock: scene {job.name} cuts no part; remove the table")
    if table.blank is None and job.part.stock is None:
        raise InputError('stock: this part has no blank of its own; give [stock.blank], for instance of kind = "block"')
    given = Given(job.part.stock) if table.blank is None and job.part.stock else given_blank(table, folder)
    blank: Solid = given.solid
    spaces = _spaces(job.part)
    if table.spaces != "one" and spaces == 1:
        raise InputError(
            f'stock.spaces = "{table.spaces}": only the program of one bevel gear\'s space is indexed; remove the key'
        )
    if table.spaces == "sector":
        blank, box = _sector(job.part, blank, spaces, table.pitch_mm)
    else:
        box = given.box(table.pitch_mm)
    turning = table.turning.build(job.part.stock) if table.turning else None
    copies = 1 if table.spaces == "one" else spaces
    asked = StockInspection(
        job.main, blank, box, copies, spaces, table.rapid_mm_min, job.part.whole, given.saved, turning
    )
    kept = [i for i in job.inspections if copies == 1 or not isinstance(i, SpacesInspection)]  # the stock sees them all
    turned = turning.kept if turning else None
    kept = [
        replace(i, stock=given.solid, copies=copies, turned=turned) if isinstance(i, HolderInspection) else i
        for i in kept
    ]
    return replace(job, inspections=(*kept, asked), notes=(*job.notes, *given.told))


def _spaces(part: Part) -> int:
    """How many spaces like the measured one there are, where one program of one space is known to cut each."""
    bevel = next((s.patch.blank for s in part.surfaces.values()), None)
    return 1 if bevel is None else bevel.teeth


def _sector(part: Part, blank: Solid, spaces: int, pitch: float | None) -> tuple[Wedge, DexelBox]:
    """One space's sector of a turned blank about the measured space's middle, and the box around it."""
    if not isinstance(blank, Turned):
        raise InputError('stock.spaces = "sector": a blank that is no body of revolution has no alike sectors')
    assert pitch is not None
    patches = [s.patch for s in part.surfaces.values()]
    middle = np.mean([p.jet(*p.locate(np.array([0.5]), np.array([0.5]))).r[0] for p in patches], axis=0)
    wedge = Wedge(blank, float(np.arctan2(middle[1], middle[0])), np.pi / spaces)
    along = np.array([np.cos(wedge.middle), np.sin(wedge.middle), 0.0])
    return wedge, whole_box(wedge, pitch, frame(np.zeros(3), along, np.array([0.0, 0.0, 1.0])))
