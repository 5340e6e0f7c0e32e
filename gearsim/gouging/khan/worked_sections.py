"""Khan's worked examples by section: which rows belong to a scene."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from gearsim.gouging.khan.examples import gouging_rows
from gearsim.gouging.khan.examples_border import border_rows
from gearsim.gouging.khan.examples_sizes import size_examples, size_rows
from gearsim.gouging.khan.worked import WorkedRow

SECTIONS = (
    "6.1.1", "6.1.2", "6.1.3", "6.1.4", "6.1.5", "6.1.6", "6.2", "6.3", "7.1", "7.2", "7.3.1", "7.3.2",
    "9.1.1", "9.1.2", "9.2", "9.3.1", "9.3.2", "9.4", "9.5", "9.6", "9.6.1", "9.6.2",
)  # fmt: skip


def worked_rows(sections: Sequence[str], names: Sequence[str] = ()) -> list[WorkedRow]:
    """Printed numbers beside ours of the given sections; of quantities that begin with one of ``names``, if given."""
    return [r for r in _rows(tuple(sections)) if not names or r.quantity.startswith(tuple(names))]


@cache
def _rows(sections: tuple[str, ...]) -> tuple[WorkedRow, ...]:
    sizes = tuple(e for e in size_examples() if e.section in sections)  # they take the time
    rows = (*gouging_rows(), *size_rows(sizes), *border_rows())
    return tuple(r for r in rows if r.section in sections)
