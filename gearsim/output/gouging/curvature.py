"""Normal curvature of tool and part over the direction, polar and Cartesian, gouging directions shaded."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.colours import GOUGE
from gearsim.output.gear.style import plain
from gearsim.output.panels import pyplot
from gearsim.output.saving import Save

TOOL, PART, OTHER = "#1b3a5c", "#c8791b", "#5b8e7d"
_ALPHA = np.radians(np.linspace(0.0, 360.0, 721))
_COLUMNS = 3
_WIDE, _HIGH = 4.6, 8.4  # inches of a contact
_HEAD = 0.55
Curve = Callable[[NDArray], NDArray]


@dataclass(frozen=True)
class Piece:
    """A curve that holds from ``start`` to ``end`` [rad]: curvature [1/mm] over directions [rad]."""

    name: str
    curve: Curve
    start: float = 0.0
    end: float = 2.0 * np.pi

    def values(self) -> NDArray:
        """The curve at all directions, nan outside its sector."""
        inside = np.mod(_ALPHA - self.start, 2.0 * np.pi) <= self.end - self.start + 1e-9
        return np.where(inside, self.curve(_ALPHA), np.nan)


@dataclass(frozen=True)
class CurvaturePlot:
    """One contact: the tool's curve and the part's, gouging ``arcs`` [deg], and what is decided.

    ``rim`` [1/mm]: a sharp edge's curvature along itself; it has no other. ``borders`` [rad] part the sectors.
    """

    title: str
    tool: Curve
    parts: tuple[Piece, ...]
    arcs: NDArray
    decision: str
    rim: float | None = None
    borders: tuple[float, ...] = ()


def draw_curvatures(plots: Sequence[CurvaturePlot], heading: str, zero: str, name: str, save: Save) -> None:
    """One column a contact: polar above, Cartesian below. ``zero`` says which direction is 0 deg."""
    columns = 2 if len(plots) == 4 else min(len(plots), _COLUMNS)
    bands = ceil(len(plots) / columns)
    width, height = max(_WIDE * columns, 7.6), _HIGH * bands + _HEAD
    figure = pyplot().figure(figsize=(width, height))

    def place(middle: float, bottom: float, size: tuple[float, float], **options: Any) -> Any:
        box = (middle - 0.5 * size[0]) / width, bottom / height, size[0] / width, size[1] / height
        return figure.add_axes(box, **options)

    for k, plot in enumerate(plots):
        band, column = divmod(k, columns)
        middle, bottom = width * (column + 0.5) / columns, height - _HEAD - _HIGH * (band + 1)
        low, high = _range(plot)
        _polar(place(middle, bottom + 4.05, (3.3, 3.3), projection="polar"), plot, low, high)
        _cartesian(place(middle + 0.2, bottom + 1.05, (3.55, 2.3)), plot, low, high, zero)
    figure.suptitle(heading, fontsize=13, weight="bold", y=1.0 - 0.2 / height, va="top")
    save(figure, name, 110)


def _curves(plot: CurvaturePlot) -> list[tuple[str, NDArray, str, float]]:
    """Name, values, colour and line width of the curves to be drawn."""
    colours = (PART, OTHER)
    parts = [(p.name, p.values(), colours[i % 2], 2.0) for i, p in enumerate(plot.parts)]
    return parts if plot.rim is not None else [*parts, ("tool", plot.tool(_ALPHA), TOOL, 2.0)]


def _range(plot: CurvaturePlot) -> tuple[float, float]:
    values = [c[1] for c in _curves(plot)] + ([np.array([plot.rim])] if plot.rim is not None else [])
    low, high = min(0.0, *(float(np.nanmin(v)) for v in values)), max(float(np.nanmax(v)) for v in values)
    room = 0.12 * max(high - low, 1e-6)
    return low - (room if low < 0.0 else 0.0), high + room


def _polar(axis: Any, plot: CurvaturePlot, low: float, high: float) -> None:
    """Radius: curvature; the centre lies at the least of it, the dashed circle is 0."""
    floor = low - 0.25 * (high - low)
    for start, end in plot.arcs:
        turn = np.radians(np.linspace(start, end, max(2, int(end - start) + 2)))
        axis.fill_between(turn, floor, high, color=GOUGE, alpha=0.2, lw=0)
    for name, values, colour, width in _curves(plot):
        axis.plot(_ALPHA, values, color=colour, lw=width, label=name)
    if plot.rim is not None:
        axis.plot(np.radians([90.0, 270.0]), [plot.rim] * 2, "o", color=TOOL, ms=6, label="tool's rim")
    if low < 0.0:
        axis.plot(_ALPHA, 0.0 * _ALPHA, color="0.35", lw=0.9, ls="--")
    for border in plot.borders:
        axis.plot([border] * 2, [floor, high], color="k", lw=1.1)
    axis.set_ylim(floor, high)
    axis.set_thetagrids(range(0, 360, 45))
    axis.set_rgrids(_round_steps(low, high), angle=22.5, fontsize=7, color="0.3")
    axis.tick_params(labelsize=8, pad=1)
    axis.grid(color="0.88", lw=0.6)
    axis.spines["polar"].set_color("0.7")
    axis.set_title(f"{plot.title}\n{plot.decision}", fontsize=10, y=1.12)


def _cartesian(axis: Any, plot: CurvaturePlot, low: float, high: float, zero: str) -> None:
    for k, (start, end) in enumerate(plot.arcs):
        axis.axvspan(start, end, color=GOUGE, alpha=0.2, lw=0, label="tool gouges" if k == 0 else None)
    for name, values, colour, width in _curves(plot):
        axis.plot(np.degrees(_ALPHA), values, color=colour, lw=width, label=name)
    if plot.rim is not None:
        axis.plot([90.0, 270.0], [plot.rim] * 2, "o", color=TOOL, ms=6, label="tool's rim")
    for border in plot.borders:
        axis.axvline(np.degrees(border) % 360.0, color="k", lw=1.1)
    axis.axhline(0.0, color="0.35", lw=0.9, ls="--")
    axis.set_xlim(0.0, 360.0)
    axis.set_ylim(low if low < 0.0 else -0.04 * high, high)
    axis.set_xticks(range(0, 361, 45))
    axis.set_xlabel(f"direction α [deg] from {zero}", fontsize=9)
    axis.set_ylabel("normal curvature [1/mm]", fontsize=9)
    plain(axis)
    axis.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.22), frameon=False, ncols=4)


def _round_steps(low: float, high: float) -> NDArray:
    """Three or four round values from above ``low`` to ``high``."""
    rough = (high - low) / 3.0
    power = 10.0 ** np.floor(np.log10(rough))
    step = power * min((1.0, 2.0, 5.0, 10.0), key=lambda k: abs(np.log(k * power / rough)))
    values = step * np.arange(np.ceil(low / step), np.floor(high / step) + 1.0)
    return np.round(values, 12) + 0.0
