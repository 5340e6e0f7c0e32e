"""Flat pictures of a run that generates surfaces: deviation maps and axis values."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gearsim.motion.axes import AxisMotion
from gearsim.output.charts import heat_map, pyplot
from gearsim.result import GeneratingResult


def draw_deviations(result: GeneratingResult, file: Path) -> None:
    """deviation.png: one row a motion, one column a surface."""
    plt = pyplot()
    motions, surfaces = list(result.texts), list(result.surfaces.values())
    size = (5.6 * len(surfaces) + 1.0, 3.6 * len(motions) + 0.8)
    figure, axes = plt.subplots(len(motions), len(surfaces), figsize=size, squeeze=False, constrained_layout=True)
    for row, motion in enumerate(motions):
        for column, surface in enumerate(surfaces):
            what = f"{surface.grid.patch.name}, {motion}"
            heat_map(figure, axes[row, column], surface.grid, surface.deviations[motion], what)
    figure.suptitle(f"{result.name}: deviation from the closed form (+ material left, - overcut)", fontsize=14)
    figure.savefig(file, dpi=90)
    plt.close(figure)


def draw_axes(result: GeneratingResult, file: Path) -> None:
    """axes.png: the axis values of every machine motion over its blocks; nothing where there is none."""
    motions = {n: s for cut in result.cuts for n, s in cut.sources.items() if isinstance(s, AxisMotion)}
    if not motions:
        return
    plt = pyplot()
    figure, axes = plt.subplots(
        len(motions), 2, figsize=(13, 4.2 * len(motions)), squeeze=False, constrained_layout=True
    )
    for row, (name, motion) in enumerate(motions.items()):
        for joint, values in zip(motion.machine.joints, np.asarray(motion.values).T, strict=True):
            shown = np.degrees(values) if joint.is_rotary else values
            axes[row, int(joint.is_rotary)].plot(shown, label=joint.name, marker="." if len(shown) < 40 else "")
        for side, unit in enumerate(("mm", "deg")):
            axes[row, side].set_title(f"{name}: {'rotary' if side else 'linear'} axes")
            axes[row, side].set_xlabel("block")
            axes[row, side].set_ylabel(unit)
            axes[row, side].legend(loc="best")
            axes[row, side].grid(alpha=0.3)
    figure.savefig(file, dpi=90)
    plt.close(figure)
