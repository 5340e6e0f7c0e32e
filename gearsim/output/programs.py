"""Programs: what each operation takes and how fast it runs, beside printed times."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from gearsim.metrology.program_times import ProgramMeasurement
from gearsim.output.markdown import table
from gearsim.output.summary import number
from gearsim.result import Result


def figures(m: ProgramMeasurement) -> dict[str, Any]:
    return {
        "lines": m.lines,
        "blocks": m.blocks,
        "operations": [
            {
                "name": name,
                "cutting_s": number(seconds),
                "largest_speed_mm_per_min": number(m.speeds[name][0]),
                "feed_mm_per_min": number(m.speeds[name][1]),
            }
            for name, seconds in m.cutting_s.items()
        ],
        "cutting_s": number(sum(m.cutting_s.values())),
    }


def sections(result: Result, found: Sequence[ProgramMeasurement]) -> dict[str, str]:
    program = figures(found[0])
    rows = [
        [
            op["name"].lower(), duration(op["cutting_s"]), _speed(op["largest_speed_mm_per_min"]),
            _speed(op["feed_mm_per_min"]),
        ]
        for op in program["operations"]
    ]  # fmt: skip
    rows.append(["together", duration(program["cutting_s"]), "", ""])
    text = (
        f"## The program\n\n{program['lines']:,} lines, {program['blocks']:,} blocks. Read back and cut "
        "as it stands. Speeds are those of the tool's axis on the part [mm/min].\n\n"
        + table(["Operation", "time in feed", "largest speed", "feed asked for"], rows)
        + _hours(result, program)
    )
    return {"details": text}


def duration(seconds: float | None) -> str:
    """A time as h:mm:ss."""
    if seconds is None:
        return "–"
    whole = round(seconds)
    return f"{whole // 3600}:{whole // 60 % 60:02d}:{whole % 60:02d}"


def _hours(result: Result, program: dict[str, Any]) -> str:
    hours = (result.scene.get("reference") or {}).get("hours")
    if not hours:
        return ""
    return (
        f"\nCutting time: {hours[0]:g} to {hours[1]:g} h printed; ours **{duration(program['cutting_s'])}** in feed, "
        "rapids and tool changes not counted.\n"
    )


def _speed(value: float | None) -> str:
    return "–" if value is None else f"{value:.1f}"
