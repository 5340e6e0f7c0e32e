"""Benchmark suite `stock`: a whole part as tri-dexel, as voxels and as a mesh, and how fast it is cut."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from gearsim.bench.stock_positions import positions
from gearsim.bench.stock_rows import COLUMNS
from gearsim.bench.stock_same_part import same_part


class Section(NamedTuple):
    """Rows of the table and what must be said of them."""

    rows: list[dict[str, Any]]
    notes: list[str]


SECTIONS: tuple[Callable[[str, str], tuple[list[dict[str, Any]], list[str]]], ...] = (positions, same_part)


def stock(device: str, size: str) -> dict[str, Any]:
    """A block's tool positions a second, and one part at one error by three representations: time and memory."""
    done = [Section(*section(device, size)) for section in SECTIONS]
    rows, notes = [row for s in done for row in s.rows], [note for s in done for note in s.notes]
    return {"columns": list(COLUMNS), "rows": rows, "notes": notes}
