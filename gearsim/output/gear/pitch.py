"""Pitch deviations as bars and their sum as a line, left and right flanks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from gearsim.metrology.gear_pitch import PitchResult, Runout
from gearsim.output.colours import BAND, OUT
from gearsim.output.gear.style import LIMIT, MICROMETRES, NOISE_UM, SIDE_COLOURS, SYMBOLS, Unit, plain, unit_for
from gearsim.output.panels import page
from gearsim.output.saving import Save
from gearsim.surfaces.cylindrical_gear import SIDES, Side

_BAND_LIMIT = 3.0
_NUMBERED = 8  # spaces, at most


def draw_pitch(
    pitch: Mapping[Side, PitchResult], runout: Runout, tolerances_um: Mapping[str, float], title: str, save: Save
) -> None:
    """One page: single pitches as bars above, the cumulative pitch below, left flanks left."""
    unit = unit_for(runout.radial_um)
    heading = f"{title}   (runout Fr = {unit.text(runout.total)} {unit.name})"
    figure, axes = page(2, 2, (5.5, 2.6), title=heading)
    draw_pitch_panels(axes, pitch, tolerances_um, 9.0)
    save(figure, "pitch.png", 130)


def draw_pitch_panels(
    axes: Any, pitch: Mapping[Side, PitchResult], tolerances_um: Mapping[str, float], font: float
) -> None:
    """Four panels, shape (2, 2): single above cumulative, left beside right, each row to one scale.

    Pitches that are perfect stand in the tolerance band, in micrometres: noise is not magnified.
    """
    rows = (
        ("f_p", "single pitch", [pitch[s].single_um for s in SIDES], _bars),
        ("F_p", "cumulative pitch", [pitch[s].cumulative_um for s in SIDES], _line),
    )
    for row, (name, what, values, draw) in zip(axes, rows, strict=True):
        largest = float(np.nanmax(np.abs(np.concatenate(values)), initial=0.0))
        perfect = largest < NOISE_UM and bool(np.isfinite(np.concatenate(values)).any())
        unit = MICROMETRES if perfect else unit_for(np.concatenate(values))
        for axis, side, um in zip(row, SIDES, values, strict=True):
            if perfect:
                axis.axhspan(-tolerances_um[name], tolerances_um[name], color=BAND, lw=0)
            draw(axis, um, unit, side, tolerances_um[name])
            found = pitch[side].single if name == "f_p" else pitch[side].total
            _labels(axis, f"{side} flanks, {what}: {SYMBOLS[name]}", found, unit, tolerances_um[name], font)
        _same_scale(row, 1.2 * tolerances_um[name] if perfect else unit.per_um * NOISE_UM)
    for axis in axes[1]:
        axis.set_xlabel("space", fontsize=font)
        _number_spaces(axis, len(pitch["left"].single_um))


def _labels(axis: Any, what: str, found: float, unit: Unit, tolerance: float, font: float) -> None:
    out = bool(found > tolerance)
    value = f"{unit.text(found)} {unit.name}" if np.isfinite(found) else "not measured"
    axis.set_title(
        f"{what} = {value}  (tolerance {tolerance:g} µm)", fontsize=1.05 * font, loc="left", y=1.02,
        color=OUT if out else "k", weight="bold" if out else "normal",
    )  # fmt: skip
    axis.set_ylabel(f"[{unit.name}]", fontsize=font)
    axis.locator_params(axis="y", nbins=4)
    plain(axis, 0.9 * font)


def _bars(axis: Any, um: Any, unit: Unit, side: Side, tolerance: float) -> None:
    """A bar a flank; the tolerance as a band where it does not dwarf the bars."""
    y, limit = unit.per_um * um, unit.per_um * tolerance
    if limit <= _BAND_LIMIT * np.nanmax(np.abs(y), initial=0.0):
        axis.axhspan(-limit, limit, color=BAND, lw=0)
    from matplotlib.collections import PolyCollection

    x = np.arange(1.0, len(y) + 1.0)
    bars = np.stack([x - 0.35, 0.0 * y, x - 0.35, y, x + 0.35, y, x + 0.35, 0.0 * y], axis=1).reshape(-1, 4, 2)
    colours = np.where(np.abs(y) > limit, OUT, SIDE_COLOURS[side])
    axis.add_collection(PolyCollection(list(bars), facecolors=list(colours), linewidths=0))
    axis.autoscale_view()
    axis.axhline(0.0, color="0.3", lw=0.7)
    axis.set(xlim=(0.3, len(y) + 0.7), xticks=[])


def _line(axis: Any, um: Any, unit: Unit, side: Side, tolerance: float) -> None:
    """The cumulative pitch from flank to flank, with its lowest and highest value marked."""
    y, limit = unit.per_um * um, unit.per_um * tolerance
    if np.isfinite(y).all():
        low, high = y.min(), y.max()
        if limit <= _BAND_LIMIT * (high - low):
            axis.axhspan(0.5 * (low + high - limit), 0.5 * (low + high + limit), color=BAND, lw=0)
        for level in (low, high) if high - low > unit.per_um * NOISE_UM else ():
            axis.axhline(level, color=LIMIT, lw=0.7, ls=":")
    axis.plot(np.arange(1, len(y) + 1), y, "o-", color=SIDE_COLOURS[side], lw=1.2, ms=3.5)
    axis.axhline(0.0, color="0.3", lw=0.7)
    axis.set(xlim=(0.3, len(y) + 0.7), xticks=[])


def _number_spaces(axis: Any, count: int) -> None:
    step = next(s for s in (1, 2, 5, 10, 20, 50, 100) if count <= _NUMBERED * s)
    axis.set_xticks([1, *range(2 * step if step > 1 else 2, count + 1, step)])


def _same_scale(axes: Sequence[Any], least: float) -> None:
    """Give panels one range of values, with a little room, at least from -``least`` to ``least``."""
    low, high = min(-least, *(a.get_ylim()[0] for a in axes)), max(least, *(a.get_ylim()[1] for a in axes))
    for axis in axes:
        axis.set_ylim(low, high)
