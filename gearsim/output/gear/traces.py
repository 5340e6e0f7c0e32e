"""Profile and helix traces as on an inspection sheet: left flanks left, right flanks right, one line a trace.

Traces stand upright: the tip (the datum face) is up. Extra material goes outward, to the left on left flanks and to the
right on right flanks, as if one looked at a tooth.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.gear_traces import GearTraces, TraceDeviations
from gearsim.output.colours import BAND, OUT
from gearsim.output.gear.style import (
    LIMIT,
    MEAN,
    MICROMETRES,
    NOISE_UM,
    SYMBOLS,
    TRACE,
    Unit,
    evenly,
    round_text,
    unit_for,
)
from gearsim.output.gear.trace_labels import ROW, above, axis_labels, below
from gearsim.output.panels import pyplot
from gearsim.output.rounding import round_below
from gearsim.output.saving import Save
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear, Side

TEETH = 4
_HALF = 0.43
_GAP = 0.5
_BAND_LIMIT = 3.0
_LETTER = {"profile": "alpha", "helix": "beta"}


@dataclass(frozen=True)
class TraceScale:
    """``um`` that half a column's width stands for; ``band``: whether the tolerance band fits into a column."""

    um: float
    unit: Unit
    mean_unit: Unit
    band: bool


def draw_traces(
    traces: Mapping[Side, GearTraces],
    gear: CylindricalGear,
    tolerances_um: Mapping[str, float],
    title: str,
    name: str,
    save: Save,
) -> None:
    """One page of profile or of helix traces, both sides, with their numbers and the tolerance band."""
    plt = pyplot()
    columns = max(min(len(t.teeth), TEETH) * len(t.stations) for t in traces.values())
    width = float(np.clip(2.6 + columns, 9.0, 15.0))
    panel = 0.5 * (width - 2.6)
    figure = plt.figure(figsize=(width, 7.4))
    figure.text(0.5, 0.965, title, ha="center", va="center", fontsize=13, weight="bold")
    axes = [figure.add_axes((x / width, 0.17, panel / width, 0.66)) for x in (1.0, 1.65 + panel)]
    draw_trace_panels(axes, traces, gear, tolerances_um, 8.5)
    save(figure, name, 130)


def draw_trace_panels(
    axes: Sequence[Any], traces: Mapping[Side, GearTraces], gear: CylindricalGear,
    tolerances_um: Mapping[str, float], font: float,
) -> None:  # fmt: skip
    """The left and the right panel, to one scale; needs room for 3 lines above each and 5 below."""
    scale = _scale(traces.values(), tolerances_um)
    for axis, side in zip(axes, SIDES, strict=True):
        _panel(axis, traces[side], tolerances_um, scale, font)
        axis_labels(axis, traces[side], gear, font)


def _scale(traces: Any, tolerances_um: Mapping[str, float]) -> TraceScale:
    """One scale for all drawn traces; the band is drawn unless it would make the traces flat.

    Traces that are perfect stand in the band, in micrometres: noise is not magnified.
    """
    size, values, means, band = NOISE_UM, [], [], 0.0
    for t in traces:
        found = t.evaluated()
        shown = evenly(len(t.teeth), TEETH)
        rest = _centred(t, found)[shown][..., _evaluated(t)]
        size = max(size, _largest(rest), 0.5 * _largest(found.slope_um[shown]))
        values += [found.slope_um[shown].ravel(), found.total_um[shown].ravel()]
        means += [_mean(found)[shown].ravel()]
        band = 0.5 * tolerances_um[f"F_{_LETTER[t.kind]}"]
    perfect = size <= NOISE_UM
    fits = perfect or band <= _BAND_LIMIT * size
    unit, mean = MICROMETRES if perfect else unit_for(np.concatenate(values)), unit_for(np.concatenate(means))
    mean = replace(mean, decimals=max(mean.decimals - 1, 0))
    return TraceScale(1.05 * (max(size, band) if fits else size), unit, mean, fits)


def _panel(axis: Any, traces: GearTraces, tolerances_um: Mapping[str, float], scale: TraceScale, font: float) -> None:
    """Band, nominal line, trace and mean line of every column, with what belongs above and below."""
    found = traces.evaluated()
    tolerance = tolerances_um[f"F_{_LETTER[traces.kind]}"]
    shown = evenly(len(traces.teeth), TEETH)
    stations = len(traces.stations)
    places = np.array([[g * (stations + _GAP) + k for k in range(stations)] for g in range(len(shown))])
    if scale.band:
        _bands(axis, traces, found, shown, places, 0.5 * tolerance / scale.um * _HALF, scale)
    _lines(axis, traces, found, shown, places, scale.um)
    for (g, k), x in np.ndenumerate(places):
        _numbers(axis, x, traces, found, (shown[g], k), tolerances_um, scale, font)
        above(axis, x, _station(traces, k), 1, font)
    for g, tooth in enumerate(shown):
        above(axis, places[g].mean(), f"space {traces.teeth[tooth] + 1}", 2, font, weight="bold")
    for limit in (traces.span.first, traces.span.last):
        axis.axhline(limit, color=LIMIT, lw=0.7, ls=":")
    end = places.max() if scale.band else places.max() + 1.5
    if not scale.band:
        _all_in_band(axis, end, traces, found, shown, tolerance, font)
    _frame(axis, traces, scale, tolerance, (places.min() - 0.6, end + 0.6), font)
    _row_labels(axis, traces.kind, scale, font)


def _outward(traces: GearTraces) -> float:
    return -_HALF if traces.side == "left" else _HALF


def _bands(
    axis: Any, traces: GearTraces, found: TraceDeviations, shown: list[int], places: NDArray, half: float,
    scale: TraceScale,
) -> None:  # fmt: skip
    """The tolerance band of complete traces, about their middle; ``half`` is half its width."""
    span = traces.span
    part = _centred(traces, found)[shown][..., _evaluated(traces)] / scale.um
    middle = places + _outward(traces) * 0.5 * (part.min(axis=-1) + part.max(axis=-1))
    _add_bands(axis, middle[found.complete[shown]], half, (span.first, span.last))


def _add_bands(axis: Any, middles: NDArray, half: float, ends: tuple[float, float]) -> None:
    """Upright bands of the tolerance about their middles, in one piece: that is drawn faster."""
    from matplotlib.collections import PolyCollection

    low, high = middles - half, middles + half
    (first, last), one = ends, np.ones(len(middles))
    corners = [low, first * one, high, first * one, high, last * one, low, last * one]
    bands = np.stack(corners, axis=-1).reshape(-1, 4, 2)
    axis.add_collection(PolyCollection(list(bands), facecolors=BAND, linewidths=0), autolim=False)


def _lines(
    axis: Any, traces: GearTraces, found: TraceDeviations, shown: list[int], places: NDArray, um: float
) -> None:  # fmt: skip
    """Nominal lines, traces and mean lines at their places; ``um`` is half a column's width."""
    from matplotlib.collections import LineCollection

    ends = np.array([traces.span.start, traces.span.end])
    curve = _centred(traces, found)[shown] / um
    curve = places[..., None] + _outward(traces) * np.where(np.abs(curve) <= 1.12, curve, np.nan)
    mean = (found.line_um - _mean(found)[..., None])[shown] / um
    mean = places[..., None] + _outward(traces) * mean
    nominal = np.repeat(places[..., None], 2, axis=-1)
    lines: list[NDArray] = []
    for x, y in ((nominal, ends), (curve, traces.position), (mean, ends)):
        lines += list(np.stack([x, np.broadcast_to(y, x.shape)], axis=-1).reshape(-1, x.shape[-1], 2))
    each = len(lines) // 3
    style: dict[str, Any] = {
        "colors": np.repeat(["0.6", TRACE, MEAN], each), "linewidths": np.repeat([0.6, 1.1, 0.9], each),
        "linestyles": [*2 * each * ["-"], *each * [(0, (5, 2))]],
    }  # fmt: skip
    axis.add_collection(LineCollection(lines, **style), autolim=False)


def _all_in_band(
    axis: Any, place: float, traces: GearTraces, found: TraceDeviations, shown: list[int], tolerance: float, font: float
) -> None:  # fmt: skip
    """A column for all traces at a scale in which the tolerance band is seen."""
    span, half = traces.span, _HALF / 1.05
    _add_bands(axis, np.array([place]), half, (span.first, span.last))
    um = 0.5 * tolerance * 1.05
    _lines(axis, traces, found, shown, np.full((len(shown), len(traces.stations)), place), um)
    above(axis, place, f"{tolerance:g} µm", 1, font)
    above(axis, place, "all", 2, font, weight="bold")


def _centred(traces: GearTraces, found: TraceDeviations) -> NDArray:
    """Deviations from the design, each trace about the middle of its mean line."""
    own = traces.from_design_um
    known = np.nansum(own, axis=-1) / np.maximum(np.isfinite(own).sum(axis=-1), 1)
    return own - np.where(found.complete, _mean(found), known)[..., None]


def _largest(values: NDArray) -> float:
    return float(np.nanmax(np.abs(values), initial=0.0))


def _mean(found: TraceDeviations) -> NDArray:
    """Height [um] of the mean lines at the middle of the active flank."""
    return found.line_um.mean(axis=-1)


def _evaluated(traces: GearTraces) -> NDArray:
    share, (a, b) = traces.span.share(traces.position), traces.span.share([traces.span.first, traces.span.last])
    return (share >= a - 1e-9) & (share <= b + 1e-9)


def _station(traces: GearTraces, k: int) -> str:
    place = traces.stations[k]
    return f"{place:.{0 if abs(place) >= 100.0 else 1}f}".replace("-", "−")


def _numbers(
    axis: Any, x: float, traces: GearTraces, found: TraceDeviations, at: tuple[int, int],
    tolerances_um: Mapping[str, float], scale: TraceScale, font: float,
) -> None:  # fmt: skip
    """f_H, f_f, F and the mean under a column; what exceeds its tolerance in red."""
    letter = _LETTER[traces.kind]
    rows = ((f"f_H{letter}", found.slope_um), (f"f_f{letter}", found.form_um), (f"F_{letter}", found.total_um))
    texts = [scale.unit.text(values[at]) for _, values in rows]
    if any(abs(values[at]) > tolerances_um[name] for name, values in rows):
        for i, (text, (name, values)) in enumerate(zip(texts, rows, strict=True)):
            out = abs(values[at]) > tolerances_um[name]
            below(axis, x, text, i, font, **({"color": OUT, "weight": "bold"} if out else {}))
    else:
        below(axis, x, "\n".join(texts), 0, font)
    below(axis, x, scale.mean_unit.text(_mean(found)[at]), 3, font, color="0.45")


def _row_labels(axis: Any, kind: str, scale: TraceScale, font: float) -> None:
    letter = _LETTER[kind]
    left = axis.get_xlim()[0]
    names = (f"f_H{letter}", f"f_f{letter}", f"F_{letter}")
    below(axis, left, "\n".join(f"{SYMBOLS[name]} [{scale.unit.name}]" for name in names), 0, font, ha="right")
    below(axis, left, f"mean [{scale.mean_unit.name}]", 3, font, ha="right", color="0.45")
    above(axis, left, "z [mm]" if kind == "profile" else "d [mm]", 1, font, ha="right")


def _frame(
    axis: Any, traces: GearTraces, scale: TraceScale, tolerance: float, x: tuple[float, float], font: float
) -> None:  # fmt: skip
    """Limits, title and scale bar."""
    span = traces.span
    low, high = (span.start, span.end) if traces.kind == "profile" else (span.end, span.start)
    room = 0.035 * (high - low)
    axis.set(xlim=x, ylim=(low - room, high + room), xticks=[])
    axis.spines[["top", "bottom"]].set_color("0.8")
    axis.spines[["left", "right"]].set_color("0.8")
    axis.tick_params(labelsize=font, width=0.6, color="0.5")
    above(axis, 0.5 * sum(x), f"{traces.side} flanks", 3, 1.12 * font, weight="bold")
    if traces.side == "left":
        above(axis, x[0], "◀ extra material", 3, font, ha="left", color="0.35")
    else:
        above(axis, x[1], "extra material ▶", 3, font, ha="right", color="0.35")
    _scale_bar(axis, x[1] if traces.side == "left" else x[0], scale, font)
    symbol = SYMBOLS[f"F_{_LETTER[traces.kind]}"]
    shown = "band" if scale.band else "band at each side's last column, in its scale"
    text = f"tolerance {symbol} = {tolerance:g} µm ({shown});  dashed: mean line;  dotted: evaluated part"
    if traces.side == "left":
        below(axis, x[0], text, 4.3, 0.95 * font, ha="left", color="0.35")


def _scale_bar(axis: Any, end: float, scale: TraceScale, font: float) -> None:
    """A bar of round length beside the panel's title, at its inner end, with the length as text."""
    from matplotlib.transforms import offset_copy

    um = round_below(scale.um)
    length = _HALF * um / scale.um
    inward = -1.0 if end > axis.get_xlim()[0] + 1e-9 else 1.0
    raised = offset_copy(axis.get_xaxis_transform(), axis.figure, y=(3 * ROW - 0.55) * font, units="points")
    style = {"color": "k", "lw": 1.6, "marker": "|", "ms": 0.8 * font}
    axis.plot([end, end + inward * length], [1.0, 1.0], transform=raised, clip_on=False, **style)
    side = "right" if inward < 0.0 else "left"
    above(axis, end + inward * (length + 0.15), round_text(scale.unit, um), 3, font, ha=side)
