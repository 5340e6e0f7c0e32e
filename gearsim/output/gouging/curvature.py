"""Normal curvature of tool and part over the direction, polar and Cartesian, gouging directions shaded."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.output.colours import GOUGE
from gearsim.output.gear.style import plain
from gearsim.output.panels import pyplot
from gearsim.output.saving import Save

TOOL, PART, OTHER = "#1b3a5c", "#c8791b", "#5b8e7d"
_ALPHA = np.radians(np.linspace(0.0, 360.0, 721))
_SPOKES = np.radians(np.arange(0.0, 360.0, 45.0))
_COLUMNS = 3
_WIDE, _HIGH = 4.6, 8.4  # inches of a contact
_HEAD = 0.55
_ZERO: dict[str, Any] = {"color": "0.35", "lw": 0.9, "ls": "--"}  # no curvature
_BACK = {"fc": "w", "lw": 0, "alpha": 0.7, "pad": 0.4}  # behind numbers
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

    def place(middle: float, bottom: float, size: tuple[float, float]) -> Any:
        box = (middle - 0.5 * size[0]) / width, bottom / height, size[0] / width, size[1] / height
        return figure.add_axes(box)

    for k, (plot, (low, high)) in enumerate(zip(plots, ranges(plots), strict=True)):
        band, column = divmod(k, columns)
        middle, bottom = width * (column + 0.5) / columns, height - _HEAD - _HIGH * (band + 1)
        _polar(place(middle, bottom + 3.75, (3.9, 3.9)), plot, low, high)
        _cartesian(place(middle + 0.2, bottom + 1.05, (3.55, 2.3)), plot, low, high, zero)
    figure.suptitle(heading, fontsize=13, weight="bold", y=1.0 - 0.2 / height, va="top")
    save(figure, name, 110)


def _curves(plot: CurvaturePlot) -> list[tuple[str, NDArray, str, float]]:
    """Name, values, colour and line width of the curves to be drawn; the part's is seen beside one that hides it."""
    colours = (PART, OTHER)
    parts = [(p.name, p.values(), colours[i % 2], 3.6) for i, p in enumerate(plot.parts)]
    return parts if plot.rim is not None else [*parts, ("tool", plot.tool(_ALPHA), TOOL, 1.6)]


def ranges(plots: Sequence[CurvaturePlot]) -> list[tuple[float, float]]:
    """From where to where curvatures are drawn: alike for all contacts of the same part."""
    own = [_range(plot) for plot in plots]
    parts = [np.concatenate([p.values() for p in plot.parts]) for plot in plots]
    if not all(p.shape == parts[0].shape and np.allclose(p, parts[0], equal_nan=True) for p in parts):
        return own
    return [(min(low for low, _ in own), max(high for _, high in own))] * len(own)


def _range(plot: CurvaturePlot) -> tuple[float, float]:
    values = [c[1] for c in _curves(plot)] + ([np.array([plot.rim])] if plot.rim is not None else [])
    low, high = min(0.0, *(float(np.nanmin(v)) for v in values)), max(float(np.nanmax(v)) for v in values)
    room = 0.12 * max(high - low, 1e-6)
    return low - (room if low < 0.0 else 0.0), high + room


def _polar(axis: Any, plot: CurvaturePlot, low: float, high: float) -> None:
    """Radius: curvature; the centre lies below the least of it, the dashed circle is 0.

    On plain axes: those of polar plots take several times as long.
    """
    from matplotlib.collections import LineCollection, PolyCollection

    floor = low - 0.25 * (high - low)

    def at(angle: NDArray, curvature: ArrayLike) -> NDArray:
        return ((np.asarray(curvature) - floor) / (high - floor) * np.stack([np.cos(angle), np.sin(angle)])).T

    turns = [np.radians(np.linspace(start, end, 91)) for start, end in plot.arcs]
    wedges = [np.vstack([[0.0, 0.0], at(turn, high)]) for turn in turns]
    axis.add_collection(PolyCollection(wedges, facecolors=GOUGE, alpha=0.2, linewidths=0))
    steps = _round_steps(low, high)
    thin = [*(at(_ALPHA, value) for value in steps), *(at(np.full(2, a), [floor, high]) for a in _SPOKES)]
    axis.add_collection(LineCollection(thin, colors="0.88", linewidths=0.6))
    axis.plot(*at(_ALPHA, high).T, color="0.7", lw=0.9)
    for _, values, colour, width in _curves(plot):
        axis.plot(*at(_ALPHA, values).T, color=colour, lw=width)
    if plot.rim is not None:
        axis.plot(*at(np.radians([90.0, 270.0]), plot.rim).T, "o", color=TOOL, ms=6)
    if low < 0.0:
        axis.plot(*at(_ALPHA, 0.0).T, **_ZERO)
    for border in plot.borders:
        axis.plot(*at(np.full(2, border), [floor, high]).T, color="k", lw=1.1)
    _polar_numbers(
        axis, 1.11 * at(_SPOKES, high), at(np.full(len(steps), _free_angle(plot, floor, high)), steps), steps
    )
    axis.set(xlim=(-1.18, 1.18), ylim=(-1.18, 1.18))
    axis.set_axis_off()
    axis.set_title(f"{plot.title}\n{plot.decision}", fontsize=10, y=1.02)


def _polar_numbers(axis: Any, about: NDArray, on: NDArray, steps: NDArray) -> None:
    """Directions ``about`` the circle and curvatures ``on`` their rings, places of shape (n, 2)."""
    for angle, (x, y) in zip(np.degrees(_SPOKES), about, strict=True):
        axis.text(x, y, f"{angle:.0f}°", fontsize=8, ha="center", va="center")
    decimals = max(0, -int(np.floor(np.log10(steps[1] - steps[0]) + 1e-9))) if len(steps) > 1 else 2
    for value, (x, y) in zip(steps, on, strict=True):
        text = f"{value:.{decimals}f}".replace("-", "−")
        axis.text(x, y, text, fontsize=7, color="0.3", ha="center", va="center", bbox=_BACK)


def _free_angle(plot: CurvaturePlot, floor: float, high: float) -> float:
    """The direction [rad] in which curves, borders and spokes leave most room to the rings' numbers."""
    radii = _round_steps(floor + 0.2 * (high - floor), high)
    tries = np.radians(np.arange(4.5, 360.0, 9.0))
    room = np.full(len(tries), np.inf)
    for _, values, _, _ in _curves(plot):
        near = np.interp((tries[:, None] + np.radians([-4.0, 0.0, 4.0])) % (2.0 * np.pi), _ALPHA, values)
        apart = np.abs(near[..., None] - radii) / (high - floor)
        room = np.minimum(room, np.nanmin(apart, axis=(1, 2), initial=1.0))
    for line in (*plot.borders, *_SPOKES):
        off = np.abs((tries - line + np.pi) % (2.0 * np.pi) - np.pi)
        room = np.minimum(room, 0.5 * off)
    return float(tries[int(np.argmax(room))])


def _cartesian(axis: Any, plot: CurvaturePlot, low: float, high: float, zero: str) -> None:
    for k, (start, end) in enumerate(plot.arcs):
        axis.axvspan(start, end, color=GOUGE, alpha=0.2, lw=0, label="tool gouges" if k == 0 else None)
    for name, values, colour, width in _curves(plot):
        axis.plot(np.degrees(_ALPHA), values, color=colour, lw=width, label=name)
    if plot.rim is not None:
        axis.plot([90.0, 270.0], [plot.rim] * 2, "o", color=TOOL, ms=6, label="tool's rim")
    for k, border in enumerate(plot.borders):
        axis.axvline(np.degrees(border) % 360.0, color="k", lw=1.1, label=None if k else "border")
    axis.axhline(0.0, label="0" if low < 0.0 else None, **_ZERO)
    axis.set_xlim(0.0, 360.0)
    axis.set_ylim(low if low < 0.0 else -0.04 * high, high)
    axis.set_xticks(range(0, 361, 45))
    axis.set_xlabel(f"direction α [deg] from {zero}", fontsize=9)
    axis.set_ylabel("normal curvature [1/mm]", fontsize=9)
    plain(axis)
    axis.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.22), frameon=False, ncols=4, columnspacing=1.4)


def _round_steps(low: float, high: float) -> NDArray:
    """Three or four round values from above ``low`` to ``high``."""
    rough = (high - low) / 3.0
    power = 10.0 ** np.floor(np.log10(rough))
    step = power * min((1.0, 2.0, 5.0, 10.0), key=lambda k: abs(np.log(k * power / rough)))
    values = step * np.arange(np.ceil(low / step), np.floor(high / step) + 1.0)
    return np.round(values, 12) + 0.0
