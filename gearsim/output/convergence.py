"""Convergence with the number of points: figures and the report's table."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from gearsim.metrology.convergence import ConvergenceMeasurement
from gearsim.output.markdown import table
from gearsim.output.summary import number
from gearsim.result import Result


def figures(m: ConvergenceMeasurement) -> dict[str, Any]:
    orders = m.convergence.orders
    seen = [q for q in orders if np.isfinite(q)]
    return {
        "points": list(m.convergence.points),
        "worst_um": list(m.convergence.worst_um),
        "orders": [number(q) for q in orders],
        "order": number(float(np.median(seen))) if seen else None,
    }


def sections(_: Result, found: Sequence[ConvergenceMeasurement]) -> dict[str, str]:
    rows = []
    for m in found:
        worst, order = m.convergence.worst_um, figures(m)["order"]
        rows.append(
            [f"{m.surface}: {m.variant}", *(f"{w:.4g}" for w in worst), "–" if order is None else f"{order:.2f}"]
        )
    head = [
        "Largest change from the exact motion [µm], number of points:",
        *map(str, found[0].convergence.points),
        "order",
    ]
    return {"convergence": "## Convergence with the number of points\n\n" + table(head, rows)}
