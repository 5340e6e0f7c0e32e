"""What stands above, below and beside panels of traces."""

from __future__ import annotations

from math import degrees
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.gear_traces import GearTraces
from gearsim.output.rounding import round_below
from gearsim.surfaces.cylindrical_gear import CylindricalGear

ROW = 1.45  # of the page's font
_TEXT = 0.92
_SPACING = ROW / _TEXT / 1.109  # of lines of a text: the font's own line is 1.109 of its size


def below(axis: Any, x: float, text: str, row: float, font: float, ha: str = "center", **style: Any) -> None:
    """A text in a row below a panel, 0 the nearest."""
    _beside(axis, x, 0.0, text, -(0.7 + ROW * row) * font, font, ha=ha, va="top", **style)


def above(axis: Any, x: float, text: str, row: float, font: float, ha: str = "center", **style: Any) -> None:
    """A text in a row above a panel, 1 the nearest."""
    _beside(axis, x, 1.0, text, (ROW * row - 0.95) * font, font, ha=ha, va="bottom", **style)


def _beside(axis: Any, x: float, edge: float, text: str, points: float, font: float, **style: Any) -> None:
    """A text some points above the panel's lower (0) or upper (1) edge; plain texts: annotations are drawn slower."""
    from matplotlib.transforms import ScaledTranslation

    moved = axis.get_xaxis_transform() + ScaledTranslation(0.0, points / 72.0, axis.figure.dpi_scale_trans)
    axis.text(x, edge, text, transform=moved, fontsize=_TEXT * font, linespacing=_SPACING, **style)


def axis_labels(axis: Any, traces: GearTraces, gear: CylindricalGear, font: float) -> None:
    """Roll angle at the outer left and diameter at the outer right of profiles; z of helices at the left."""
    span, side = traces.span, traces.side
    if side == "right":
        axis.yaxis.tick_right()
        axis.yaxis.set_label_position("right")
    if traces.kind == "helix":
        axis.set_ylabel("z [mm], datum face up", fontsize=font)
        return
    if side == "left":
        low, high = sorted(degrees(p / gear.base_radius) for p in (span.start, span.end))
        ticks = _round_ticks(low, high)
        axis.set_yticks(np.radians(ticks) * gear.base_radius, [f"{t:g}" for t in ticks])
        axis.set_ylabel("roll angle [°], tip up", fontsize=font)
        return
    low, high = sorted(2.0 * gear.radius(np.array([span.start, span.end]) / gear.base_radius))
    ticks = _round_ticks(low, high)
    axis.set_yticks(gear.roll(0.5 * ticks) * gear.base_radius, [f"{t:g}" for t in ticks])
    axis.set_ylabel("diameter [mm], tip up", fontsize=font)


def _round_ticks(low: float, high: float) -> NDArray:
    step = round_below((high - low) / 4.0)
    return np.arange(np.ceil(low / step - 1e-9), high / step + 1e-9) * step + 0.0
