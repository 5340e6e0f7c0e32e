"""Machine axes: how far and how fast they go, beside their limits."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, isfinite
from typing import Any

from gearsim.metrology.axis_check import AxisFigures, AxisMeasurement
from gearsim.output.markdown import table
from gearsim.output.programs import duration
from gearsim.output.summary import number
from gearsim.result import Result


def figures(m: AxisMeasurement) -> dict[str, Any]:
    return {
        "axes": [_axis(a) for a in m.axes],
        "rapid_s": number(m.rapid_s),
        "unchecked": _unchecked(m),
    }


def _axis(a: AxisFigures) -> dict[str, Any]:
    unit, one = ("deg", degrees(1.0)) if a.joint.is_rotary else ("mm", 1.0)
    return {
        "name": a.joint.name,
        f"from_{unit}": number(one * a.least),
        f"to_{unit}": number(one * a.largest),
        f"lower_limit_{unit}": number(one * a.joint.lower),
        f"upper_limit_{unit}": number(one * a.joint.upper),
        f"fastest_{unit}_per_min": 60.0 * one * a.fastest,
        f"fastest_allowed_{unit}_per_min": number(60.0 * one * a.max_feed),
    }


def _unchecked(m: AxisMeasurement) -> list[str]:
    """What nothing is known to hold an axis against."""
    if not m.axes:
        return ["travel and speed of axes: no machine is named"]
    free = [a.joint.name for a in m.axes if not (isfinite(a.joint.lower) or isfinite(a.joint.upper))]
    fast = [a.joint.name for a in m.axes if not isfinite(a.max_feed)]
    told = [f"travel of {', '.join(free)}: machine.limits names none"] * bool(free)
    return told + [f"speed of {', '.join(fast)}: machine.max_feed names none"] * bool(fast)


def sections(_: Result, found: Sequence[AxisMeasurement]) -> dict[str, str]:
    return {"beside": "".join(map(_section, found))}


def _section(m: AxisMeasurement) -> str:
    text = "## Machine axes\n\n"
    if m.axes:
        rows = [[*(_plain(x) for x in _axis(a).values())] for a in m.axes]
        head = ["Axis", "from", "to", "lower limit", "upper limit", "fastest feed", "allowed"]
        text += (
            "As the program counts, in mm or degrees and by the minute; where all axes run linearly this is exact, in "
            "arcs and with tip control by cubics through 65 instants of a block.\n\n" + table(head, rows)
        )
        if isfinite(m.rapid_s):
            text += f"\nRapids take {duration(m.rapid_s)} at the axes' own rates.\n"
    told = "; ".join(_unchecked(m))
    return text + (f"\nUnchecked: {told}.\n\n" if told else "\n")


def _plain(x: Any) -> str:
    return "–" if x is None else f"{x:.6g}" if isinstance(x, float) else str(x)
