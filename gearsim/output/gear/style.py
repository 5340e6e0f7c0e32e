"""What all gear charts share: colours, units that fit the size of a deviation, round scale bars."""

from __future__ import annotations

from dataclasses import dataclass
from math import floor, log10
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from gearsim.output.colours import FIRST, SECOND

TRACE, MEAN, LIMIT = "#1b3a5c", "#c8791b", "#7a7f87"
SIDE_COLOURS = {"left": FIRST, "right": SECOND}
SYMBOLS = {  # as measuring machines print them; to set them as formulae takes longer than to draw a page
    "f_p": "fp", "F_p": "Fp", "f_Halpha": "fHα", "f_falpha": "ffα", "F_alpha": "Fα",
    "f_Hbeta": "fHβ", "f_fbeta": "ffβ", "F_beta": "Fβ",
}  # fmt: skip
NOISE_UM = 1e-4


@dataclass(frozen=True)
class Unit:
    """A unit and how many of it make a micrometre; ``decimals`` give the largest value three digits."""

    name: str
    per_um: float
    decimals: int

    def text(self, um: float, sign: bool = False) -> str:
        """A value [um] as a number in this unit, with a true minus; a dash where there is none."""
        if not np.isfinite(um):
            return "–"
        value = round(self.per_um * um, self.decimals) + 0.0
        return f"{value:{'+' if sign else ''}.{self.decimals}f}".replace("-", "−")


MICROMETRES = Unit("µm", 1.0, 2)


def unit_for(values_um: ArrayLike) -> Unit:
    """Nanometres where all values are below a micrometre, else micrometres."""
    largest = max(float(np.nanmax(np.abs(values_um), initial=0.0)), NOISE_UM)
    name, per_um = ("nm", 1e3) if largest < 1.0 else ("µm", 1.0)
    return Unit(name, per_um, int(np.clip(2 - floor(log10(largest * per_um)), 0, 2)))


def round_text(unit: Unit, um: float) -> str:
    """A round length as text with its unit, like 5 µm or 0.2 nm."""
    return f"{unit.per_um * um:g} {unit.name}"


def evenly(items: int, most: int) -> list[int]:
    """Indices of at most ``most`` items, spread from the first to near the last."""
    count = min(items, most)
    return [k * items // count for k in range(count)]


def plain(axis: Any, font: float = 8.0) -> None:
    """Take away the frame's top and right and make the rest thin; ``font`` of its numbers."""
    axis.spines[["top", "right"]].set_visible(False)
    axis.spines[["left", "bottom"]].set_linewidth(0.7)
    axis.tick_params(width=0.7, labelsize=font)
