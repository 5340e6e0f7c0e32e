"""The table of suite `stock`: its columns, and rows in which what a section does not measure is blank."""

from __future__ import annotations

from typing import Any

COLUMNS = ("case", "method", "seconds", "MB", "error mm", "from", "figure", "unit", "goal", "met")
_BLANK = "-"


def stock_row(case: str, method: str, **figures: Any) -> dict[str, Any]:
    """A row; further keys than the table's columns go to the report alone."""
    return {**dict.fromkeys(COLUMNS, _BLANK), "case": case, "method": method, **figures}


def against(figure: float, unit: str, goal: float) -> dict[str, Any]:
    """The columns of a figure that must reach its goal."""
    return {"figure": figure, "unit": unit, "goal": goal, "met": "yes" if figure >= goal else "no"}
