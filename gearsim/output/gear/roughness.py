"""Roughness traces: the primary profile with its waviness, and the roughness profile, with the cutoff stated."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from gearsim.metrology.roughness import Roughness
from gearsim.output.gear.style import LIMIT, MEAN, NOISE_UM, TRACE, Unit, plain, unit_for
from gearsim.output.panels import Room, page
from gearsim.output.saving import Save

_EVALUATED = "0.93"


def draw_roughness(traces: Mapping[str, Roughness], title: str, save: Save) -> None:
    """One row a trace, by its name: before the filter at the left, after it at the right, with the numbers.

    Traces that are flat are told.
    """
    cutoff = next(iter(traces.values())).cutoff_mm
    heading = f"{title}   (Gaussian filter, cutoff λc = {cutoff:g} mm)"
    drawn = {name: trace for name, trace in traces.items() if not _flat(trace)}
    flat = "; ".join(name for name in traces if name not in drawn)
    room = Room(top=1.2 if flat else 0.95)
    figure, axes = page(max(len(drawn), 1), 2, (5.5, 1.5 if drawn else 0.1), room, heading)
    for row, (name, trace) in zip(axes, drawn.items(), strict=bool(drawn)):
        _before(row[0], name, trace)
        _after(row[1], trace)
    for axis in axes[-1]:
        axis.set_xlabel("along the surface [mm]", fontsize=9)
        if not drawn:
            axis.remove()
    if flat:
        told = f"flat to {1e3 * NOISE_UM:g} nm, not drawn: {flat}"
        figure.text(0.5, 1.0 - 0.6 / figure.get_size_inches()[1], told, fontsize=10, ha="center")
    save(figure, "roughness.png", 130)


def _flat(trace: Roughness) -> bool:
    return bool(np.isfinite(trace.primary_um).all()) and float(np.ptp(trace.primary_um)) < NOISE_UM


def _before(axis: Any, name: str, trace: Roughness) -> None:
    unit = unit_for(trace.primary_um)
    axis.plot(trace.position, unit.per_um * trace.primary_um, color=TRACE, lw=0.9, label="form removed")
    axis.plot(trace.position, unit.per_um * trace.waviness_um, color=MEAN, lw=1.3, label="waviness")
    axis.set_title(name, fontsize=10, loc="left", weight="bold", y=1.02)
    axis.legend(fontsize=8, loc="upper right", ncols=2, frameon=False, bbox_to_anchor=(1.0, 1.16))
    _dress(axis, trace, unit)


def _after(axis: Any, trace: Roughness) -> None:
    """The roughness profile; the evaluation length shaded, its sections divided."""
    unit = unit_for(trace.roughness_um)
    if trace.sections:
        axis.axvspan(trace.first, trace.last, color=_EVALUATED, lw=0)
        for edge in np.linspace(trace.first, trace.last, trace.sections + 1):
            axis.axvline(edge, color=LIMIT, lw=0.6, ls=":")
    axis.plot(trace.position, unit.per_um * trace.roughness_um, color=TRACE, lw=0.9)
    axis.set_title(_numbers(trace), fontsize=9.5, loc="left", y=1.02)
    if trace.status:
        low, high = axis.get_ylim()
        axis.set_ylim(low - 0.15 * (high - low), high)
        axis.text(0.5, 0.03, trace.status, transform=axis.transAxes, ha="center", fontsize=8, color=MEAN)
    _dress(axis, trace, unit)


def _numbers(trace: Roughness) -> str:
    values = {"Ra": trace.ra_um, "Rq": trace.rq_um, "Rz": trace.rz_um, "Rz ten-point": trace.ten_point_um}
    unit = unit_for(list(values.values()))
    return ",  ".join(f"{name} {unit.text(um)}" for name, um in values.items()) + f"  [{unit.name}]"


def _dress(axis: Any, trace: Roughness, unit: Unit) -> None:
    axis.axhline(0.0, color="0.4", lw=0.6)
    low, high = axis.get_ylim()
    least = unit.per_um * NOISE_UM
    axis.set_ylim(min(low, -least), max(high, least))
    axis.set_xlim(trace.position[0], trace.position[-1])
    axis.set_ylabel(f"height [{unit.name}]", fontsize=9)
    plain(axis)
