"""One line of the comparison with print: what is printed, what is ours, and the verdict."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

READING_DEG = 1.0  # whole angles in print are read from plots; those with decimals are held to 0.1 deg


class WorkedRow(NamedTuple):
    """``verdict`` is "reproduces" or "print is inconsistent: ...", in words for a report."""

    section: str
    quantity: str
    printed: str
    ours: str
    agrees: bool
    verdict: str


def number_row(section: str, quantity: str, printed: str, ours: float, remark: str = "") -> WorkedRow:
    """Compare a number to the digits printed; a number cut off instead of rounded agrees too."""
    digits = len(printed.partition(".")[2])
    shown = f"{ours:.{digits + 2}f}"
    if abs(float(printed) - ours) <= 0.5 * 10.0**-digits + 1e-12:
        return WorkedRow(section, quantity, printed, shown, True, "reproduces" + (f"; {remark}" if remark else ""))
    if float(printed) == np.trunc(ours * 10.0**digits) / 10.0**digits:
        return WorkedRow(section, quantity, printed, shown, True, "reproduces, cut off instead of rounded")
    return WorkedRow(section, quantity, printed, shown, False, f"print is inconsistent: {remark}")


def word_row(section: str, quantity: str, printed: str, ours: str, remark: str = "") -> WorkedRow:
    """Compare decisions, cases and sizes as words."""
    agrees = printed == ours
    verdict = "reproduces" + (f"; {remark}" if remark else "") if agrees else f"print is inconsistent: {remark}"
    return WorkedRow(section, quantity, printed, ours, agrees, verdict)


def arcs_row(section: str, quantity: str, printed: NDArray, ours: NDArray, remark: str = "") -> WorkedRow:
    """Compare arcs of directions [deg], each of shape (n, 2) in 0 to 360, to the accuracy of reading a plot."""
    reading = np.where(printed == np.round(printed), READING_DEG, 0.1)
    agrees = printed.shape == ours.shape and bool(np.all(np.abs(printed - ours) <= reading))
    verdict = "reproduces" + (f"; {remark}" if remark else "") if agrees else f"print is inconsistent: {remark}"
    return WorkedRow(section, quantity, arcs_text(printed), arcs_text(ours), agrees, verdict)


def arcs_text(arcs: NDArray) -> str:
    return ", ".join(f"{a:.4g}-{b:.4g}" for a, b in arcs) or "none"


def arcs_of(intervals: NDArray) -> NDArray:
    """Directions [rad] as sorted arcs in 0 to 360 deg, shape (n, 2); an arc over 0 deg becomes two, as in print."""
    arcs = []
    for start, end in np.degrees(np.reshape(intervals, (-1, 2))):
        first = start % 360.0
        last = first + end - start
        arcs += [(first, last)] if last <= 360.0 + 1e-9 else [(first, 360.0), (0.0, last - 360.0)]
    return np.array(sorted(arcs)).reshape(-1, 2)
