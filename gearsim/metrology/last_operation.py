"""Which operation made a surface last: its rows, to be asked again alone, by both roads."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.deviation import Deviation
from gearsim.simulation.operation import Operation, Variant


def made_last(name: str, whole: Variant, deviation: Deviation, heading: int | None = None) -> Variant | None:
    """The rows, from the first to the last that cut a surface under one heading, the program's last if none is given;
    one tool's.

    None where nothing under that heading cuts a sample. ``deviation`` is that under the ``whole`` program. Where a
    rapid made a sample, rapids count as feeds, or only one road would know of its cut.
    """
    segment = np.unique(deviation.segment[deviation.segment >= 0])
    last = max(int(o.section.max(initial=-1)) for o in whole.operations) if heading is None else heading
    first_row = np.cumsum([0, *map(len, whole.operations)])
    for operation, row in zip(whole.operations, first_row, strict=False):
        mine = segment[(segment >= row) & (segment < row + len(operation))] - row
        mine = mine[operation.section[mine] == last]
        if len(mine):
            if operation.rapid[mine].any():
                operation = replace(operation, rapid=np.zeros(len(operation), dtype=bool))
            return Variant(name, f"the blocks of the last operation that made the surface ({operation.name})",
                           (_between(operation, operation.step[mine]),))  # fmt: skip
    return None


def last_heading(whole: Variant, heading: int | None = None) -> str:
    """The name of a heading, or of that under which a program's last rows stand; empty where none is known."""
    last = max(whole.operations, key=lambda o: int(o.section.max(initial=-1)))
    number = int(last.section.max()) if heading is None else heading
    return last.headings[number] if last.headings else ""


def _between(operation: Operation, steps: NDArray[np.integer]) -> Operation:
    return operation.part((operation.step >= steps.min()) & (operation.step <= steps.max()))
