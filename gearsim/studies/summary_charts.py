"""Pictures of a study's summary: how figures are distributed, which parameter matters, how figures follow it."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.iso1328 import PARAMETERS
from gearsim.output.colours import BAND, EXCESS, FIRST, LINE, OUT, OVERCUT, SECOND
from gearsim.output.panels import Room, page
from gearsim.output.saving import Save
from gearsim.studies.importance import Effect, Importance
from gearsim.studies.summary_figures import Told, label, micro

_BINS = 30
_PLAIN = "#1b3a5c"
_PALE = "#a9bccf"
_DPI = 140
_LEVELS = 12  # different values of a parameter: with more, jobs are dots
_MOST_DOTS = 3_000
_MANY = 200  # dots: drawn small
_MOST_BARS = 12
_SMALL = 8.5


def draw_surfaces(told: Told, save: Save, name: str) -> None:
    """A row a surface: least (hollow) and greatest deviation on one axis, the tolerance behind them; and the RMS."""
    surfaces = told.surfaces
    figure, axes = page(len(surfaces), 2, (2.7, 1.5), Room(left=0.65, right=0.2, across=0.55, top=0.45, up=0.85))
    for row, surface in zip(axes, surfaces, strict=True):
        least, most = (_known(told[f"{surface}.{kind}"]) for kind in ("min_um", "max_um"))
        edges = _edges(np.concatenate([least, most]))
        _bars(row[0], most, edges, hollow=False)
        _bars(row[0], least, edges, hollow=True)
        _mark_limits(row[0], told.frame.limits(f"{surface}.min_um"))
        _dress(row[0], f"{surface} min, max", "deviation [µm]")
        rms = _known(told[f"{surface}.rms_um"])
        row[1].hist(rms, _edges(rms), color=_PLAIN)
        _dress(row[1], f"{surface} RMS", "µm")
        row[0].set_ylabel("jobs", fontsize=_SMALL)
    save(figure, name, _DPI)


def _bars(axis: Any, values: NDArray[Any], edges: NDArray[Any], hollow: bool) -> None:
    """A histogram in the colours of overcut and excess."""
    counts, _ = np.histogram(values, edges)
    colours = np.where(0.5 * (edges[1:] + edges[:-1]) < 0.0, OVERCUT, EXCESS)
    some = counts > 0
    face = "none" if hollow else colours[some]
    axis.bar(edges[:-1][some], counts[some], np.diff(edges)[some], align="edge", facecolor=face,
             edgecolor=colours[some], lw=1.3, alpha=1.0 if hollow else 0.75)  # fmt: skip


def draw_iso(told: Told, save: Save, name: str) -> None:
    """A panel a parameter of ISO 1328-1, both sides, the tolerance behind them."""
    found = [p for p in PARAMETERS if any(f.startswith(f"iso.{p}.") for f in told.figures)]
    figure, axes = page(ceil(len(found) / 2), 2, (2.7, 1.35), Room(left=0.65, right=0.2, across=0.55, top=0.45, up=0.8))
    for axis, parameter in zip(axes.flat, found, strict=False):
        sides = {f: _known(told[f]) for f in told.figures if f.startswith(f"iso.{parameter}.")}
        edges = _edges(np.concatenate(list(sides.values())))
        for (side, values), colour in zip(sides.items(), (FIRST, SECOND), strict=False):
            text = side.rpartition(".")[2].removesuffix("_um")
            axis.hist(values, edges, histtype="step", color=colour, lw=1.6, label=text)
        low, high = told.frame.limits(f"iso.{parameter}.left_um")
        _mark_limits(axis, (low if edges[0] < 0.0 else min(0.0, high), high))
        _dress(axis, parameter, "µm")
        axis.legend(fontsize=7.5, frameon=False, handlelength=1.0, borderpad=0.1)
    for axis in axes.flat[len(found) :]:
        axis.set_visible(False)
    save(figure, name, _DPI)


def draw_effects(found: Importance, save: Save, name: str) -> None:
    """Bars of shares, alone and in total, and standardised coefficients, with their intervals."""
    effects = found.effects[:_MOST_BARS][::-1]
    longest = max(len(e.name) for e in effects)
    room = Room(left=0.35 + 0.075 * longest, right=0.25, across=0.25, top=0.5, bottom=0.75)
    panels = [_draw_shares] * bool(found.shares_by) + [_draw_slopes] * any(
        np.isfinite(e.standardised.value) for e in effects
    )
    width = max(1.9, 5.2 - room.left) / len(panels)
    figure, axes = page(1, len(panels), (width, 0.3 * len(effects) + 0.15), room)
    for axis, draw in zip(axes[0], panels, strict=True):
        draw(axis, effects)
        axis.set(yticks=range(len(effects)), ylim=(-0.6, len(effects) - 0.4))
        axis.set_yticklabels([e.name for e in effects] if axis is axes[0, 0] else [], fontsize=_SMALL)
        axis.grid(axis="x", alpha=0.3)
    save(figure, name, _DPI)


def _draw_shares(axis: Any, effects: Sequence[Effect]) -> None:
    at = np.arange(len(effects))
    for values, colour, shift, text in (
        ([e.first for e in effects], _PLAIN, 0.18, "alone"),
        ([e.total for e in effects], _PALE, -0.18, "with others"),
    ):
        axis.barh(at + shift, [v.value for v in values], 0.34, color=colour, label=text)
        for y, v in zip(at + shift, values, strict=True):
            axis.plot([v.low, v.high], [y, y], color="k", lw=1.0)
    axis.set_xlim(0.0, 1.05)
    axis.set_xlabel("share of the variance", fontsize=_SMALL)
    axis.legend(fontsize=7.5, frameon=False, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderpad=0.0)
    axis.tick_params(labelsize=_SMALL)


def _draw_slopes(axis: Any, effects: Sequence[Effect]) -> None:
    for y, e in enumerate(effects):
        b = e.standardised
        axis.plot([b.low, b.high], [y, y], color="k", lw=1.0)
        axis.plot([b.value], [y], "o", color=_PLAIN, ms=4.5)
    axis.axvline(0.0, color=LINE, lw=0.8)
    reach = 1.1 * max(1.0, max(abs(x) for e in effects for x in e.standardised if np.isfinite(x)))
    axis.set_xlim(-reach, reach)
    axis.set_xlabel("standardised coefficient", fontsize=_SMALL)
    axis.tick_params(labelsize=_SMALL)


def draw_responses(told: Told, found: Importance, save: Save, name: str, most: int = 4) -> None:
    """The figure over the parameters that matter most: dots, or boxes where a parameter has few values."""
    keys = [e.name.split(" and ")[0] for e in found.effects[:most]]
    columns = min(2, len(keys))
    figure, axes = page(
        ceil(len(keys) / columns), columns, (2.55 if columns > 1 else 4.5, 1.9),
        Room(left=0.75, right=0.2, across=0.7, top=0.25, up=0.6, bottom=0.6),
    )  # fmt: skip
    units = {p.key: p.unit for p in told.study.parameters}
    for axis, key in zip(axes.flat, keys, strict=False):
        y = np.asarray(told[found.figure], dtype=float)
        good = np.isfinite(y)
        _draw_response(axis, told.parameters[key][good], y[good], told.beyond(found.figure)[good])
        low, high = told.frame.limits(found.figure)
        for limit in (low, high):
            if axis.get_ylim()[0] < limit < axis.get_ylim()[1]:
                axis.axhline(limit, color=OUT, lw=1.0, ls="--")
        axis.set_xlabel(f"{key}{_unit(key, units[key])}", fontsize=_SMALL)
        axis.tick_params(labelsize=_SMALL)
        axis.grid(alpha=0.3)
    for axis in axes[:, 0]:
        axis.set_ylabel(f"{label(found.figure)} [µm]", fontsize=_SMALL)
    for axis in axes.flat[len(keys) :]:
        axis.set_visible(False)
    save(figure, name, _DPI)


def _unit(key: str, unit: str) -> str:
    return "" if unit == "1" or key.endswith(f"_{unit}") else f" [{micro(unit)}]"


def _draw_response(axis: Any, x: NDArray[Any], y: NDArray[Any], beyond: NDArray[np.bool_]) -> None:
    values = np.unique(x)
    if len(values) > _LEVELS and x.dtype.kind in "iuf":
        step = ceil(len(y) / _MOST_DOTS)
        for mask, colour in ((~beyond, _PLAIN), (beyond, OUT)):
            axis.plot(
                x[mask][::step], y[mask][::step], ".", color=colour, ms=3.5 if len(y) > _MANY else 7.0, alpha=0.6, mew=0
            )
        axis.locator_params(axis="x", nbins=4)
        return
    values = values[:_LEVELS]
    groups = [y[x == v] for v in values]
    style = {"color": _PLAIN, "lw": 1.0}
    axis.boxplot(groups, whis=(0, 100), widths=0.55, boxprops=style, whiskerprops=style, capprops=style,
                 medianprops={"color": "k", "lw": 1.4})  # fmt: skip
    axis.set_xticks(range(1, len(values) + 1), [_short(v) for v in values], rotation=0 if len(values) < 8 else 60)


def _short(value: Any) -> str:
    return f"{value:.4g}".replace("-", "−") if isinstance(value, float | np.floating) else str(value)


def _edges(values: NDArray[Any]) -> NDArray[Any]:
    """Bins over what there is; about a single value one that is seen."""
    if not values.size:
        return np.array([0.0, 1.0])
    low, high = float(values.min()), float(values.max())
    room = max(0.0, 1e-3 - (high - low)) + 1e-9 * max(abs(low), abs(high))
    return np.linspace(low - 0.5 * room, high + 0.5 * room, min(_BINS, 5 + ceil(np.sqrt(values.size))) + 1)


def _known(values: NDArray[Any]) -> NDArray[Any]:
    values = np.asarray(values, dtype=float)
    return values[np.isfinite(values)]


def _mark_limits(axis: Any, limits: tuple[float, float]) -> None:
    """The tolerance as a band within what is drawn, or up to twice as far."""
    low, high = axis.get_xlim()
    reach = max(abs(low), abs(high))
    seen = [x for x in limits if np.isfinite(x) and abs(x) <= 2.0 * reach]
    if all(np.isfinite(limits)) and len(seen) == 2:
        axis.axvspan(*limits, color=BAND, zorder=0)
    for x in filter(None, seen):
        axis.axvline(x, color=OUT, lw=1.2, ls="--")
    axis.set_xlim(min([low, *seen]) - 0.03 * (high - low), max([high, *seen]) + 0.03 * (high - low))


def _dress(axis: Any, title: str, unit: str) -> None:
    from matplotlib.ticker import MaxNLocator

    axis.set_title(title, fontsize=9.5, loc="left", pad=4)
    axis.set_xlabel(unit, fontsize=_SMALL, labelpad=1)
    axis.tick_params(labelsize=_SMALL)
    axis.locator_params(axis="x", nbins=5)
    axis.yaxis.set_major_locator(MaxNLocator(3, integer=True))
