"""Flank topography: whiskers on a grid with a scale bar, and a heat map with contours, left and right flank."""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.gear_inspection import FlankMap
from gearsim.output.colours import EXCESS, OVERCUT
from gearsim.output.contours import draw_contours
from gearsim.output.gear.style import NOISE_UM, TRACE, Unit, plain, round_text, unit_for
from gearsim.output.heat import averaged, paint
from gearsim.output.panels import Room, page
from gearsim.output.rounding import round_below
from gearsim.output.saving import Save
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear, Side

_ROWS, _COLUMNS = 9, 13


def draw_topography(maps: Mapping[Side, FlankMap], gear: CylindricalGear, title: str, save: Save) -> None:
    """One page: whiskers above, heat maps below, both sides to one scale."""
    heading = f"{title}   (red: material left, blue: overcut)"
    figure, axes = page(2, 2, (5.1, 3.7), Room(left=0.65, right=0.85, top=0.8, across=1.35), heading)
    unit = unit_for(np.concatenate([maps[s].deviation_um.ravel() for s in SIDES]))
    largest = max(float(np.nanmax(np.abs(maps[s].deviation_um), initial=NOISE_UM)) for s in SIDES)
    for (above, below), side in zip(axes.T, SIDES, strict=True):
        whiskers(above, maps[side], gear, unit, largest)
        _heat(below, maps[side], gear, unit, largest)
    save(figure, "topography.png", 130)


def whiskers(axis: Any, flank: FlankMap, gear: CylindricalGear, unit: Unit, largest: float) -> None:
    """A stroke a grid point, up for material left, as long as the scale bar says."""
    from matplotlib.collections import LineCollection

    rows = _chosen(len(flank.position), _ROWS)
    columns = _chosen(len(flank.z), _COLUMNS)
    um = flank.deviation_um[np.ix_(rows, columns)]
    x, level = np.meshgrid(flank.z[columns], np.arange(len(rows), dtype=float))
    tips = level + 0.8 * um / largest
    for lines, colour, width in (
        ([*np.stack([x, level], -1)], "0.75", 0.8),
        ([*np.stack([x.T, level.T], -1)], "0.88", 0.6),
        ([*np.stack([x, tips], -1)], TRACE, 1.1),
    ):
        axis.add_collection(LineCollection(lines, colors=colour, linewidths=width))
    colours = np.where(um.ravel() < 0.0, OVERCUT, EXCESS)
    axis.vlines(x.ravel(), level.ravel(), tips.ravel(), colors=list(colours), lw=2.2)
    bar = round_below(largest)
    right = flank.z.max() + 0.05 * np.ptp(flank.z)
    axis.plot([right, right], [0.0, 0.8 * bar / largest], color="k", lw=1.6, marker="_", ms=8)
    axis.text(right, 0.8 * bar / largest + 0.12, round_text(unit, bar), ha="center", va="bottom", fontsize=9)
    angles = [f"{degrees(p / gear.base_radius):.1f}" for p in flank.position[rows]]
    axis.set_yticks(level[:, 0], angles)
    axis.set(xlim=(flank.z.min() - 0.03 * np.ptp(flank.z), right + 0.05 * np.ptp(flank.z)), ylim=(-1.0, len(rows)))
    _labels(axis, flank, unit)


def _heat(axis: Any, flank: FlankMap, gear: CylindricalGear, unit: Unit, largest: float) -> None:
    """The whole map, with contours of the map averaged (feed marks would fill it)."""
    angle = np.degrees(flank.position / gear.base_radius)
    shown = unit.per_um * flank.deviation_um
    limit = unit.per_um * largest
    paint(axis, flank.z, angle, shown, limit, unit.name)
    smooth = averaged(shown)
    known = smooth[np.isfinite(smooth)]
    if known.size and np.ptp(known) > 0.2 * limit:
        draw_contours(axis, flank.z, angle, smooth)
    _labels(axis, flank, unit)


def _labels(axis: Any, flank: FlankMap, unit: Unit) -> None:
    um = flank.deviation_um
    missing = int(np.isnan(um).sum())
    known = um[np.isfinite(um)]
    span = f"{unit.text(known.min(), True)} to {unit.text(known.max(), True)} {unit.name}" if known.size else "none"
    axis.set_title(
        f"{flank.side} flank, space {flank.space + 1}: {span}" + (f", {missing} points missing" if missing else ""),
        fontsize=10, loc="left", y=1.02,
    )  # fmt: skip
    axis.set_xlabel("z [mm], datum face at the right", fontsize=9)
    axis.set_ylabel("roll angle [°], tip up", fontsize=9)
    plain(axis)


def _chosen(count: int, most: int) -> NDArray:
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int))
