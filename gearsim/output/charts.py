"""Flat pictures with Matplotlib: deviation maps, whiskers, profiles."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from math import ceil
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.grid import GridMeasurement
from gearsim.metrology.mean_profile import ProfileMeasurement
from gearsim.motion.axes import AxisMotion
from gearsim.output.heat import draw_heat, is_perfect, limit_of, shared_limits
from gearsim.output.panels import Room, page, pyplot
from gearsim.output.presenters import collected
from gearsim.output.saving import Chart, Save
from gearsim.output.wanted import Wanted
from gearsim.result import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_OURS, _BESIDE = "#1b3a5c", "#c8791b"
_BESIDE_ONE = 2  # variants of a surface that is alone
_ACROSS = 3  # maps side by side, at most
_STYLES = (("-", 2.8), ("--", 1.9), (":", 1.9))  # of curves that may lie over one another
_PIXELS = 1400.0  # across a picture of few panels


def all_charts(result: Result) -> list[Chart]:
    """Every flat picture that can be drawn of a result."""
    return [chart for offered in collected(result, "charts") for chart in offered]


def chart_all(result: Result, folder: Path, wanted: Wanted, tell: Callable[[dict[str, str]], None]) -> None:
    """Draw every flat picture that is wanted; ``tell`` of their captions before drawing."""
    charts = [chart for chart in all_charts(result) if wanted.chart(chart.file)]
    tell({chart.file: chart.caption for chart in charts})
    for chart in charts:
        chart.draw(Save(folder, wanted))


def draw_grids(result: Result, dense: Sequence[GridMeasurement], save: Save) -> None:
    """deviation.png: one row a variant, one column a surface. What is as intended or alike is named, not drawn."""
    shown, told = sorted_out(dense)
    places, columns, rows = _panels(shown)
    width = max(4.7 * columns + 0.3, 9.7)
    pitch = (width - 0.3) / columns
    told += _tolerated(result, shown)
    lines = [line for sentence in told for line in wrap(sentence, int(13 * width))]
    head = 0.7 + 0.17 * len(lines)
    height = head + 2.75 * rows
    figure = pyplot().figure(figsize=(width, height))
    limits = shared_limits([limit_of(1e3 * m.deviation.value) for m in shown], [row for row, _ in places])
    for m, (row, column), limit in zip(shown, places, limits, strict=True):
        left, bottom = 0.65 + pitch * column, height - head - 2.2 - 2.75 * row
        axis = figure.add_axes((left / width, bottom / height, (pitch - 1.25) / width, 1.85 / height))
        what = f"{m.surface}, {m.variant}"
        draw_heat(axis, m.grid, 1e3 * m.deviation.value, what, limit, result.job.part.surfaces[m.surface].tolerance)
    title = f"{result.name}: deviation from the intended surfaces (+ material left, − overcut)"
    figure.text(0.6 / width, 1.0 - 0.35 / height, title, fontsize=12, weight="bold")
    figure.text(0.6 / width, 1.0 - 0.5 / height, "\n".join(lines), fontsize=9, va="top")
    save(figure, "deviation.png", round(max(80.0, _PIXELS / width)))


def _tolerated(result: Result, shown: Sequence[GridMeasurement]) -> list[str]:
    """What is tolerated of the surfaces shown, in a sentence; none where nothing is."""
    by_text: dict[str, dict[str, None]] = {}
    for m in shown:
        tolerance = result.job.part.surfaces[m.surface].tolerance
        if tolerance is not None:
            by_text.setdefault(tolerance.text, {})[m.surface] = None
    listed = "; ".join(f"{text} ({', '.join(names)})" for text, names in by_text.items())
    return [f"tolerance, marked on the scales that reach it: {listed}"] if listed else []


def sorted_out(dense: Sequence[GridMeasurement]) -> tuple[list[GridMeasurement], list[str]]:
    """What is worth a map, and sentences on what is not: surfaces as intended, or alike under an earlier variant."""
    shown: list[GridMeasurement] = []
    perfect, alike = [], []
    for m in dense:
        twin = next((s for s in shown if s.surface == m.surface and _alike(s, m)), None)
        if is_perfect(m):
            perfect.append(f"{m.surface} ({m.variant})")
        elif twin is not None:
            alike.append(f"{m.surface} under {m.variant} as under {twin.variant}")
        else:
            shown.append(m)
    holes = ["there is no machined surface, or it was not measured"] if any(_has_holes(m) for m in shown) else []
    told = (("as intended to 1 nm: ", perfect), ("the same to 1 nm, drawn once: ", alike), ("grey: ", holes))
    return shown, [f"{what}{', '.join(names)}" for what, names in told if names]


def _has_holes(m: GridMeasurement) -> bool:
    return not np.isfinite(m.deviation.value).all()


def _alike(a: GridMeasurement, b: GridMeasurement) -> bool:
    """Whether two measurements of a surface differ by less than the eye sees, and by no more than a nanometre."""
    one, other = a.deviation.value, b.deviation.value
    least = min(1e-6, 1e-3 * float(np.nanmax(np.abs(one), initial=0.0)))
    return one.shape == other.shape and np.allclose(one, other, rtol=0.0, atol=least, equal_nan=True)


def _panels(dense: Sequence[GridMeasurement]) -> tuple[list[tuple[int, int]], int, int]:
    """Row and column of every panel, and how many there are: surfaces under several variants side by side, a variant a
    row, or more rows where there are many surfaces; those under one alone in rows of their own. Of one surface alone
    variants stand side by side, too.
    """
    counts = Counter(m.surface for m in dense)
    if len(counts) == 1:
        return (
            [divmod(k, _BESIDE_ONE) for k in range(len(dense))],
            min(len(dense), _BESIDE_ONE),
            1 + (len(dense) - 1) // _BESIDE_ONE,
        )
    several = [name for name, count in counts.items() if count > 1]
    alone = [name for name, count in counts.items() if count == 1]
    variants = list(dict.fromkeys(m.variant for m in dense if m.surface in several))
    columns = max(len(several), min(_ACROSS, len(alone)), 1)
    places = []
    for m in dense:
        if m.surface in several:
            places.append((variants.index(m.variant), several.index(m.surface)))
        else:
            row, column = divmod(alone.index(m.surface), columns)
            places.append((len(variants) + row, column))
    bands, across = ceil(columns / _ACROSS), min(columns, _ACROSS)
    folded = [(row * bands + column // across, column % across) for row, column in places]
    return folded, across, 1 + max((row for row, _ in folded), default=0)


def draw_mean_profiles(result: Result, found: Sequence[ProfileMeasurement], save: Save) -> None:
    """mean-profile.png: deviation over the height above the contact path, printed values beside."""
    figure, axes = page(1, len(found), (5.6, 3.9), Room(left=0.95, across=1.15, right=0.4), result.name)
    for axis, m in zip(axes[0], found, strict=True):
        _profile(axis, m)
    save(figure, "mean-profile.png")


def draw_axes(title: str, motions: Mapping[str, AxisMotion], save: Save) -> None:
    """axes.png: the axis values of every machine motion over its blocks."""
    room = Room(top=0.95, right=0.7, across=1.5)
    figure, axes = page(len(motions), 2, (5.0, 3.1), room, f"{title}: values of the machine's axes")
    for row, (name, motion) in enumerate(motions.items()):
        drawn = [0, 0]
        for joint, values in zip(motion.machine.joints, np.asarray(motion.values).T, strict=True):
            shown, side = np.degrees(values) if joint.is_rotary else values, int(joint.is_rotary)
            dashes, thick = _STYLES[drawn[side] % len(_STYLES)]
            drawn[side] += 1
            dots = "." if len(shown) < 40 else ""
            axes[row, side].plot(shown, label=joint.name, marker=dots, ls=dashes, lw=thick)
        for side, unit in enumerate(("mm", "deg")):
            axes[row, side].set_title(f"{name}: {'rotary' if side else 'linear'} axes")
            axes[row, side].set_xlabel("block")
            axes[row, side].xaxis.get_major_locator().set_params(integer=True)
            axes[row, side].set_ylabel(unit)
            axes[row, side].legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
            axes[row, side].grid(alpha=0.3)
    save(figure, "axes.png", 90)


def _profile(axis: Axes, m: ProfileMeasurement) -> None:
    offsets = np.array(m.offsets_mm)
    order = np.argsort(offsets)
    normal, in_plane = (np.array(list(um.values())) for um in (m.normal_um, m.in_plane_um))
    axis.plot(offsets[order], normal[order], "o-", color=_OURS, label="ours, surface normal")
    axis.plot(offsets[order], in_plane[order], "x--", color=_BESIDE, label="ours, normal in the profile plane")
    for name, x, y in zip(m.normal_um, offsets, normal, strict=True):
        axis.annotate(name, (x, y), textcoords="offset points", xytext=(4, 6), fontsize=8)
    ours, scale = _largest(np.concatenate([normal, in_plane])), ""
    if m.published is not None:
        printed = np.array(m.published.um)
        axis.plot(offsets[order], printed[order], "s:", color="0.5", label=f"{m.published.source} (sign turned)")
        if _largest(printed) > 3.0 * ours:
            axis.set_yscale("symlog", linthresh=ours)
            axis.yaxis.set_major_formatter(lambda um, _: f"{um:g}".replace("-", "−"))
            scale = f" (logarithmic beyond {ours:.2g} µm)"
    axis.axhline(0.0, color="k", lw=0.6)
    axis.margins(y=0.15)
    axis.set_title(f"{m.surface} flank, mean profile, {m.variant}{scale}")
    axis.set_xlabel("height above the contact path [mm]")
    axis.set_ylabel("deviation [µm]")
    axis.legend(fontsize=8)


def _largest(deviation: NDArray) -> float:
    """Largest size of the values that exist, at least 1e-6."""
    return float(np.nanmax(np.abs(deviation), initial=1e-6))
