"""The inspection sheet of a pair of flanks, as a measuring machine prints it: inspector's grid, dense map, extremes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import Any

import numpy as np

from gearsim.metrology.grid import GridMeasurement
from gearsim.output.colours import BAND, EXCESS, LINE, OUT, OVERCUT
from gearsim.output.heat import draw_heat, limit_of
from gearsim.output.saving import Save
from gearsim.surfaces.part import Tolerance

_WIDTH, _HEIGHT = 13.0, 10.2
_LEFT, _PANEL, _BETWEEN = 0.75, 5.35, 0.95
_MAP = 4.75  # wide, its scale beside it
_STEP_SHARE = 0.42  # of the rows' distance: a whisker as long as the tolerance
_CHARACTERS = 84
_ALIAS = 0.02  # of the tolerance: waves smaller than this do not mislead


@dataclass(frozen=True)
class Sheet:
    """What one flank's half of the page shows: the inspector's grid and the dense one under the same variant."""

    coarse: GridMeasurement
    dense: GridMeasurement


def draw_sheet(
    title: str, lines: Sequence[str], flanks: Sequence[Sheet], tolerance_um: float, name: str, save: Save
) -> None:  # fmt: skip
    """One page; lengths in inches from its lower left corner. ``lines`` stand under the title."""
    from gearsim.output.panels import pyplot

    figure = pyplot().figure(figsize=(_WIDTH, _HEIGHT))
    figure.text(0.35 / _WIDTH, 1.0 - 0.42 / _HEIGHT, title, fontsize=15, weight="bold")
    for i, line in enumerate(lines):
        figure.text(0.35 / _WIDTH, 1.0 - (0.64 + 0.17 * i) / _HEIGHT, line, fontsize=8.5, color=LINE)
    per_um = whisker_scale(flanks, tolerance_um)
    limit = max(limit_of(1e3 * f.dense.deviation.value) for f in flanks)
    for k, flank in enumerate(flanks):
        x = _LEFT + k * (_PANEL + _BETWEEN)
        _whiskers(_place(figure, x, 5.0, 3.9), flank.coarse, tolerance_um, per_um)
        _words(figure, x, 4.18, flank, tolerance_um)
        _map(_place(figure, x, 0.75, 2.75, _MAP), flank, limit, tolerance_um)
    save(figure, name)


def whisker_scale(flanks: Sequence[Sheet], tolerance_um: float) -> float:
    """Whisker [share of the rows' distance] for a micrometre, one for both flanks.

    So that the tolerance is seen, unless deviations beyond it need the room.
    """
    largest = max(float(np.nanmax(np.abs(1e3 * f.coarse.deviation.value), initial=0.0)) for f in flanks)
    return _STEP_SHARE / max(tolerance_um, min(largest, 20.0 * tolerance_um), 1e-9)


def _place(figure: Any, left: float, bottom: float, height: float, width: float = _PANEL) -> Any:
    return figure.add_axes((left / _WIDTH, bottom / _HEIGHT, width / _WIDTH, height / _HEIGHT))


def _whiskers(axis: Any, m: GridMeasurement, tolerance_um: float, per_um: float) -> None:
    """A stroke a point, up for material left, with its number [um]; the tolerance as a band about every row."""
    from matplotlib.collections import LineCollection

    um = 1e3 * m.deviation.value
    rows, columns = um.shape
    x, y = np.meshgrid(np.arange(columns, dtype=float), np.arange(rows, dtype=float))
    for i in range(rows):
        band = per_um * tolerance_um
        axis.fill_between([-0.4, columns - 0.35], i - band, i + band, color=BAND, lw=0, zorder=0)
    axis.add_collection(LineCollection([*np.stack([x, y], -1), *np.stack([x.T, y.T], -1)], colors="0.75", lw=0.7))
    length = np.clip(np.nan_to_num(um) * per_um, -0.95, 0.95)
    tips = np.stack([np.stack([x, y], -1), np.stack([x, y + length], -1)], axis=2).reshape(-1, 2, 2)
    colours = np.where(um.ravel() < 0.0, OVERCUT, EXCESS)
    axis.add_collection(LineCollection(list(tips), colors=list(colours), lw=2.4))
    axis.add_collection(LineCollection(list(np.stack([x, y + length], -1)), colors=LINE, lw=0.9))
    for i, j in np.ndindex(um.shape):
        said = "–" if not np.isfinite(um[i, j]) else number(float(um[i, j]))
        out = np.isfinite(um[i, j]) and abs(um[i, j]) > tolerance_um
        axis.text(j + 0.06, i - 0.07, said, fontsize=7, va="top", ha="left", color=OUT if out else "k")
    axis.set(xlim=(-0.55, columns - 0.35), ylim=(-0.7, rows - 0.35), xticks=[], yticks=[])
    for side in axis.spines.values():
        side.set_visible(False)
    axis.text(-0.5, -0.62, "toe", fontsize=9, weight="bold")
    axis.text(columns - 0.75, -0.62, "heel", fontsize=9, weight="bold", ha="right")
    axis.text(-0.52, 0.0, "root", fontsize=9, weight="bold", rotation=90, va="center")
    axis.text(-0.52, rows - 1.0, "tip", fontsize=9, weight="bold", rotation=90, va="center")
    axis.set_title(f"{m.surface} flank, {m.variant}, as cut [µm], + material left", fontsize=11, loc="left")


def number(um: float) -> str:
    """A deviation with the digits that matter beside others of a few micrometres."""
    text = f"{um:.0f}" if abs(um) >= 100.0 else f"{um:.1f}" if abs(um) >= 10.0 else f"{um:.2f}"
    return text.replace("-", "−")


def _words(figure: Any, x: float, y: float, flank: Sheet, tolerance_um: float) -> None:
    """Sum of squares and worst point of the inspector's grid; what it misses; whether it aliases."""
    told = [(line, warns) for text, warns in sheet_words(flank, tolerance_um) for line in wrap(text, _CHARACTERS)]
    for i, (line, warns) in enumerate(told):
        figure.text(x / _WIDTH, (y + 0.5 - 0.17 * i) / _HEIGHT, line, fontsize=8.5, color=OUT if warns else "k")


def sheet_words(flank: Sheet, tolerance_um: float) -> list[tuple[str, bool]]:
    """The lines under a flank, and whether each is a warning."""
    um = 1e3 * flank.coarse.deviation.value
    if not np.isfinite(um).any():
        return [("nothing of this flank was measured", True)]
    i, j = np.unravel_index(int(np.nanargmax(np.abs(um))), um.shape)
    worst = f"{number(float(um[i, j]))} µm at row {i + 1} from the root, column {j + 1} from the toe"
    text = f"sum of squares {np.nansum(um**2):.4g} µm², worst {worst}; band: tolerance ±{tolerance_um:g} µm"
    found = [(text, False)]
    missed = missed_extreme(flank, tolerance_um)
    if missed is not None:
        found.append((f"the grid misses {number(missed[0])} µm at {missed[1]:.0f} % of the face from the toe, "
                      f"{missed[2]:.0f} % of the height from the root", True))  # fmt: skip
    waves = aliasing_um(flank)
    if waves > max(_ALIAS * tolerance_um, 1e-3):
        text = (
            f"the columns fall on like places of the path's steps: waves of {number(waves)} µm do not show on the grid"
        )
        found.append((text, True))
    return found


def missed_extreme(flank: Sheet, tolerance_um: float) -> tuple[float, float, float] | None:
    """The dense map's worst value [um] and where [percent along, up], if it is well beyond the grid's; else None."""
    dense, coarse = 1e3 * flank.dense.deviation.value, 1e3 * flank.coarse.deviation.value
    if not np.isfinite(dense).any():
        return None
    i, j = np.unravel_index(int(np.nanargmax(np.abs(dense))), dense.shape)
    beyond = abs(dense[i, j]) - float(np.nanmax(np.abs(coarse), initial=0.0))
    if beyond < 0.1 * tolerance_um:
        return None
    grid = flank.dense.grid
    return float(dense[i, j]), 100.0 * float(grid.length[j]), 100.0 * float(grid.height[i])


def aliasing_um(flank: Sheet) -> float:
    """How much [um] of the waves along the face the inspector's columns do not see: they fall on like phases of them.

    The waves are the dense map's middle row less its trend; they are missed as far as the columns' own values less
    their trend vary less.
    """
    dense, coarse = flank.dense, flank.coarse
    row = 1e3 * dense.deviation.value[dense.grid.shape[0] // 2]
    if not np.isfinite(row).all() or len(row) < 16:
        return 0.0
    at = dense.grid.length
    waves = row - np.polynomial.Polynomial.fit(at, row, 4)(at)
    seen = np.interp(coarse.grid.length, at, waves)
    return max(0.0, float(np.ptp(waves)) - 2.0 * float(np.ptp(seen))) if np.ptp(waves) > 0.0 else 0.0


def _map(axis: Any, flank: Sheet, limit: float, tolerance_um: float) -> None:
    """The dense map with its extremes marked, and the inspector's points on it."""
    m, points = flank.dense, flank.coarse.grid
    um = 1e3 * m.deviation.value
    draw_heat(axis, m.grid, um, f"{m.surface} flank, dense", limit, Tolerance.both(tolerance_um))
    along, up = m.grid.patch.ways
    x, y = np.meshgrid(along.at(points.length), up.at(points.height))
    axis.plot(x.ravel(), y.ravel(), ".", ms=2.5, color="0.2")
    axis.text(
        1.0, -0.16, "▽ least   △ greatest   · the grid", transform=axis.transAxes, fontsize=8, ha="right", va="top"
    )
    if np.isfinite(um).any():
        for pick, mark in ((np.nanargmin, "v"), (np.nanargmax, "^")):
            i, j = np.unravel_index(int(pick(um)), um.shape)
            at = along.at(m.grid.length[j]), up.at(m.grid.height[i])
            axis.plot(*at, mark, mfc="none", mec="k", ms=8, mew=1.3, clip_on=False)
