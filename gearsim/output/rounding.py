"""Round numbers for scales."""

from __future__ import annotations

from math import floor, log10


def round_below(value: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above a value."""
    power = 10.0 ** floor(log10(value) + 1e-9)
    return max(k * power for k in (1.0, 2.0, 5.0) if k * power <= value * (1.0 + 1e-9))
