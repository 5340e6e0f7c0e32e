"""Maps over a surface's parameters: deviation and cause of overcut of every tool; the rule for flat end mills."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.gouging.attribution import Cause
from gearsim.gouging.inspection import ToolCut
from gearsim.metrology.samples import SampleGrid
from gearsim.output.colours import GOUGE
from gearsim.output.gouging.curvature import TOOL
from gearsim.output.heat import paint, span
from gearsim.output.panels import Room, page, pyplot
from gearsim.output.saving import Save

CAUSES = {
    Cause.NONE: ("#eef0f2", "not overcut"),
    Cause.LOCAL: (GOUGE, "local gouging, as predicted"),
    Cause.TIE: ("#edae49", "tie of second order"),
    Cause.GLOBAL: ("#1b9e77", "global gouging, from a contact elsewhere"),
    Cause.UNPREDICTED: ("#000000", "not predicted"),
    Cause.UNKNOWN: ("#6b7280", "cut through the window"),
}
_NOISE_UM = 1e-3
_TIE = 1e-9  # 1/mm


def draw_cuts(
    title: str, cuts: Mapping[str, ToolCut], labels: Mapping[str, str], tolerance: float, save: Save
) -> None:  # fmt: skip
    """gouging.png: one row a tool; left the deviation, right what made the overcut."""
    heading = f"{title}: machined minus intended (+ material left, − overcut)"
    room = Room(bottom=1.0, top=1.1, across=1.5, up=1.7)
    figure, axes = page(len(cuts), 2, (4.8, 3.8), room, heading)
    for row, (name, cut) in enumerate(cuts.items()):
        _deviation(axes[row, 0], cut.grid, cut, labels[name])
        _causes(axes[row, 1], cut.grid, cut, tolerance)
    save(figure, "gouging.png")


def _axes(axis: Any, grid: SampleGrid) -> tuple[NDArray, NDArray]:
    axis.set_xlabel("u [share of the domain]")
    axis.set_ylabel("v [share of the domain]")
    return grid.length, grid.height


def _deviation(axis: Any, grid: SampleGrid, cut: ToolCut, label: str) -> None:
    um = 1e3 * cut.deviation.value
    limit = max(float(np.nanmax(np.abs(um), initial=0.0)), _NOISE_UM)
    if float(np.nanmax(np.abs(um), initial=0.0)) < _NOISE_UM and np.isfinite(um).all():
        axis.set_axis_off()
        axis.text(0.0, 0.5, f"{label}\nas intended to 1 nm", fontsize=11)
        return
    x, y = _axes(axis, grid)
    paint(axis, x, y, um, limit)
    _predicted(axis, grid, cut)
    axis.set_title(f"{label}\n{span(um[np.isfinite(um)])}", fontsize=11)


def _causes(axis: Any, grid: SampleGrid, cut: ToolCut, tolerance_um: float) -> None:
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    if cut.made.count(Cause.NONE) == cut.made.cause.size and not _predicts(cut):
        axis.set_axis_off()
        nothing = f"nothing is overcut beyond {tolerance_um:g} µm,\nand nothing was predicted to be"
        axis.text(0.0, 0.5, f"{nothing}\n{_counted(cut)}", fontsize=11)
        return
    x, y = _axes(axis, grid)
    colours = ListedColormap([c for c, _ in CAUSES.values()])
    norm = BoundaryNorm(np.arange(-0.5, len(CAUSES)), len(CAUSES))
    axis.pcolormesh(x, y, cut.made.cause, cmap=colours, norm=norm, shading="nearest", rasterized=True)
    drawn = _predicted(axis, grid, cut)
    there = [c for c in CAUSES if cut.made.count(c)]
    marks: list[Any] = [Patch(color=CAUSES[c][0], label=CAUSES[c][1]) for c in there]
    if drawn:
        marks.append(Line2D([], [], color="k", lw=1.4, ls="--", label="border of the contacts predicted to gouge"))
    axis.legend(handles=marks, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2, frameon=False)
    axis.set_title(f"what made the overcut beyond {tolerance_um:g} µm\n{_counted(cut)}", fontsize=11)


def _counted(cut: ToolCut) -> str:
    q = cut.rings
    gouge, against = int(q.gouging.sum()), int(q.disagree.sum())
    return f"{len(q.contact):,} contacts cut alone: {gouge:,} gouge, {against} against prediction"


def _predicted(axis: Any, grid: SampleGrid, cut: ToolCut) -> bool:
    """The border between points where the tool would gouge and where not; False where there is none."""
    least = _least(cut)
    bordered = _predicts(cut) and bool(np.nanmax(least) > _TIE)
    if bordered:
        axis.contour(grid.length, grid.height, least, levels=[-_TIE], colors="k", linewidths=1.4, linestyles="--")
    return bordered


def _predicts(cut: ToolCut) -> bool:
    """Whether the tool is predicted to gouge anywhere."""
    return bool(np.nanmin(_least(cut), initial=0.0) < -_TIE)


def _least(cut: ToolCut) -> NDArray:
    return np.where(cut.samples.touches, cut.samples.comparison.least, np.nan).reshape(cut.grid.shape)


def draw_flat_rule(save: Save) -> None:
    """flat-end-mill.png: the largest flat end mill in a bowl over the contact angle, by Khan's (6.24) and rightly."""
    plt = pyplot()
    eta = np.linspace(0.0, 90.0, 181)
    figure, axis = plt.subplots(figsize=(8.0, 5.2), constrained_layout=True)
    axis.plot(
        eta, 20.0 * np.sin(np.radians(eta)), color=TOOL, lw=2, label=r"$k = k_n / \sin\,\eta$: the bowl's level section"
    )
    axis.plot(
        eta, 20.0 * np.cos(np.radians(eta)), color=GOUGE, lw=2, ls="--", label=r"as printed: $k = k_n / \cos\,\eta$"
    )
    for value, colour in ((10.0, TOOL), (17.3, GOUGE)):
        axis.plot([30.0], [value], "o", color=colour)
        axis.annotate(f"{value:g} mm", (30.0, value), xytext=(8, -4), textcoords="offset points", fontsize=10)
    axis.set_xlabel("η, angle of the normal from the axis [deg]")
    axis.set_ylabel("largest R of a flat end mill [mm]")
    axis.set_title("Khan 6.3: a flat end mill in a bowl of radius 20 mm", fontsize=12)
    axis.legend(frameon=False)
    axis.grid(alpha=0.25)
    axis.spines[["top", "right"]].set_visible(False)
    save(figure, "flat-end-mill.png", 110)
