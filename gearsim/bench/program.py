"""Benchmark suite `program`: lines of G-code read in a second on one thread, and memory a line."""

from __future__ import annotations

import tracemalloc
from statistics import median
from time import process_time
from typing import Any

import numpy as np

from gearsim.machines.catalogue import table_table_bc
from gearsim.programs.gcode import read_program

LINES = {"small": (10_000, 100_000, 1_000_000), "large": (10_000, 100_000, 1_000_000, 4_000_000)}
MIXED_LINES = 20_000
_REPEATS = 3
_COLUMNS = ("program", "lines", "MB", "seconds", "spread", "lines/s", "MB/s", "B/line", "peak B/line")
_AT_ONCE = 100_000


def program(device: str, size: str) -> dict[str, Any]:
    """Five-axis programs of three decades, with and without tip control, and one that is mostly read line by line."""
    largest = LINES[size]
    rows = [_row("five axes, G93", five_axis(n)) for n in largest]
    rows.append(_row("five axes, G93, G43.4", five_axis(largest[1], "G43.4 H1")))
    rows.append(_row("a comment every other line", five_axis(MIXED_LINES, between="(PASS)\n")))
    return {"columns": list(_COLUMNS), "rows": rows, "notes": _NOTES}


def five_axis(lines: int, length: str = "G43 H1", between: str = "") -> str:
    """A program of so many cutting lines on a smooth path, as a post-processor writes it; ``between``: before each."""
    parts = [f"%\nO1 (BENCH)\nG21 G90 G94\nT1 M6\n{length}\nG93 G1\n"]
    for first in range(0, lines, _AT_ONCE):
        i = np.arange(first, min(first + _AT_ONCE, lines))
        turn = 1e-3 * i
        columns = [i % 1_000_000, 50 * np.cos(turn), 50 * np.sin(turn), -20 + 1e-5 * i, 20 * np.sin(0.1 * turn),
                   np.degrees(turn) % 360, 900 + 90 * np.cos(turn)]  # fmt: skip
        row = between + "N%d X%.4f Y%.4f Z%.4f B%.4f C%.4f F%.2f\n"
        parts += [row % cells for cells in zip(*(c.tolist() for c in columns), strict=True)]
    return "".join([*parts, "M30\n%\n"])


def _row(name: str, text: str) -> dict[str, Any]:
    lines, machine = text.count("\n"), table_table_bc()
    times = []
    for _ in range(_REPEATS):
        started = process_time()
        read_program(text, machine)
        times.append(process_time() - started)
    tracemalloc.start()
    read_program(text, machine)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    seconds = median(times)
    return {
        "program": name,
        "lines": lines,
        "MB": 1e-6 * len(text),
        "seconds": seconds,
        "spread": (max(times) - min(times)) / seconds,
        "lines/s": lines / seconds,
        "MB/s": 1e-6 * len(text) / seconds,
        "B/line": len(text) / lines,
        "peak B/line": peak / lines,
    }


_NOTES = [
    "CPU time from text to blocks (axis values, seconds, lines), median of 3, one thread. Peak: what is allocated at "
    "once while reading, the copy of the text included; a line of blocks holds 62 B. With a comment every other line "
    "each line goes through the interpreter alone.",
    "A published reader in Rust makes 0.9 to 1.1 million lines a second: its own figure, on its own machine.",
]
