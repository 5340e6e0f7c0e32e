"""The whole part as stock: what a scene's [stock] adds to its job, whatever is cut."""

from __future__ import annotations

from dataclasses import replace

from gearsim.errors import InputError
from gearsim.metrology.job import Job
from gearsim.metrology.other_spaces import SpacesInspection
from gearsim.metrology.rapid_check import RapidInspection
from gearsim.metrology.stock_check import StockInspection
from gearsim.scene.stock import StockTable
from gearsim.simulation.sequence import whole_box


def with_stock(job: Job, table: StockTable) -> Job:
    """The job with its whole blank cut by its main variant, too.

    Raises InputError where there is nothing to cut, no blank, or spaces that are not known or already in the program.
    """
    if not job.variants:
        raise InputError(f"stock: scene {job.name} cuts no part; remove the table")
    blank = job.part.stock if table.blank is None else table.blank.build()
    if blank is None:
        raise InputError('stock: this part has no blank of its own; give [stock.blank], for instance of kind = "block"')
    bevel = next((s.patch.blank for s in job.part.surfaces.values()), None)
    spaces = 1 if bevel is None else bevel.teeth
    if table.spaces == "all" and spaces == 1:
        raise InputError('stock.spaces = "all": only the program of one bevel gear\'s space is indexed; remove the key')
    told = any(isinstance(i, RapidInspection) and i.variant == job.main for i in job.inspections)
    copies = spaces if table.spaces == "all" else 1
    box = whole_box(blank, table.pitch_mm)
    asked = StockInspection(job.main, blank, box, copies, spaces, table.rapid_mm_min, told)
    kept = (i for i in job.inspections if copies == 1 or not isinstance(i, SpacesInspection))  # the stock sees them all
    return replace(job, inspections=(*kept, asked))
