"""Numbers of a gear report in words: sizes in the unit that fits, orders."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, log10

import numpy as np

from gearsim.output.gear.style import NOISE_UM


def size(um: float | None) -> str:
    """A deviation [um] with three digits, in nm below a micrometre; a dash where there is none."""
    if um is None or not np.isfinite(um):
        return "–"
    if abs(um) < NOISE_UM:
        return "0"
    value, unit = (1e3 * um, "nm") if abs(um) < 1.0 else (um, "µm")
    decimals = int(np.clip(2 - floor(log10(abs(value))), 0, 2))
    return f"{value:.{decimals}f} {unit}".replace("-", "−")


def exactly(um: float) -> str:
    """The same, but never a plain 0 for what is merely small."""
    return size(um) if abs(um) >= NOISE_UM or um == 0.0 else f"{1e3 * um:.1e} nm".replace("-", "−")


def order(steps: Sequence[float], values: Sequence[float]) -> float | None:
    """The power p of values ~ steps**p; None from less than two values that can be told from nothing."""
    pairs = [(h, abs(v)) for h, v in zip(steps, values, strict=True) if abs(v) > NOISE_UM]
    if len({h for h, _ in pairs}) < 2:
        return None
    h, v = np.log(np.array(pairs)).T
    return float(np.polyfit(h, v, 1)[0])
