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
from gearsim.output.gouging.curvature import PART, TOOL
from gearsim.output.heat import limit_of, paint, shared_limits, span
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
_PANEL, _ALONE, _NOTHING = (4.8, 3.8), (8.4, 3.8), (8.4, 0.1)  # inch
_TIE = 1e-9  # 1/mm


def draw_cuts(
    title: str, cuts: Mapping[str, ToolCut], labels: Mapping[str, str], tolerance: float, save: Save
) -> None:  # fmt: skip
    """gouging.png: every tool's deviation and, beside it, what made the overcut where there is more than one answer.

    What is as intended is told, not drawn.
    """
    heading = f"{title}: machined minus intended (+ material left, − overcut)"
    told = [f"{labels[name]}: as intended to 1 nm; {_counted(cut)}" for name, cut in cuts.items() if _perfect(cut)]
    rows = rows_of({name: _mixed(cut) for name, cut in cuts.items() if not _perfect(cut)})
    room = Room(right=0.9, bottom=1.0, top=1.35 + 0.2 * len(told), across=1.5, up=1.9)
    columns = max((len(row) for row in rows), default=1)
    size = _PANEL if columns > 1 else _ALONE if rows else _NOTHING
    figure, axes = page(max(len(rows), 1), columns, size, room, heading)
    height = figure.get_size_inches()[1]
    for k, line in enumerate(told):
        figure.text(0.5, 1.0 - (0.55 + 0.2 * k) / height, line, fontsize=10, ha="center")
    for panels, row in zip(axes, rows or [[]], strict=True):
        limits = shared_limits([limit_of(1e3 * cuts[name].deviation.value) for name, _ in row], [0] * len(row))
        for panel, (name, causes), limit in zip(panels, row, limits, strict=False):
            if causes:
                _causes(panel, cuts[name], tolerance)
            else:
                _deviation(panel, cuts[name], labels[name], limit, tolerance)
        for panel in panels[len(row) :]:
            panel.remove()
    save(figure, "gouging.png")


def rows_of(mixed: Mapping[str, bool]) -> list[list[tuple[str, bool]]]:
    """What stands in which row: a tool's map (False) with that of its causes (True) where they are ``mixed``, else
    two maps side by side.
    """
    rows: list[list[tuple[str, bool]]] = []
    for name, both in mixed.items():
        alone = next((row for row in rows if len(row) == 1), None)
        if both:
            rows.append([(name, False), (name, True)])
        elif alone is not None:
            alone.append((name, False))
        else:
            rows.append([(name, False)])
    return rows


def _perfect(cut: ToolCut) -> bool:
    um = 1e3 * cut.deviation.value
    return bool(np.isfinite(um).all()) and float(np.abs(um).max(initial=0.0)) < _NOISE_UM


def _mixed(cut: ToolCut) -> bool:
    """Whether the surface's overcut has more than one cause, none of them among these."""
    return bool((cut.made.cause != cut.made.cause.flat[0]).any())


def _axes(axis: Any, grid: SampleGrid) -> tuple[NDArray, NDArray]:
    axis.set_xlabel("u [share of the domain]")
    axis.set_ylabel("v [share of the domain]")
    return grid.length, grid.height


def _deviation(axis: Any, cut: ToolCut, label: str, limit: float, tolerance_um: float) -> None:
    um = 1e3 * cut.deviation.value
    x, y = _axes(axis, cut.grid)
    paint(axis, x, y, um, limit)
    drawn, lines = _predicted(axis, cut), [label, span(um[np.isfinite(um)])]
    if not _mixed(cut):
        cause = CAUSES[Cause(int(cut.made.cause.flat[0]))][1]
        everywhere = f"nothing overcut beyond {tolerance_um:g} µm" if cause == CAUSES[Cause.NONE][1] else f"all {cause}"
        lines = [label, f"{lines[1]}; {everywhere}", _counted(cut)]
        if drawn:
            _legend(axis, [_border_mark()])
    axis.set_title("\n".join(lines), fontsize=10)


def _causes(axis: Any, cut: ToolCut, tolerance_um: float) -> None:
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.patches import Patch

    x, y = _axes(axis, cut.grid)
    colours = ListedColormap([c for c, _ in CAUSES.values()])
    norm = BoundaryNorm(np.arange(-0.5, len(CAUSES)), len(CAUSES))
    axis.pcolormesh(x, y, cut.made.cause, cmap=colours, norm=norm, shading="nearest", rasterized=True)
    drawn = _predicted(axis, cut)
    marks: list[Any] = [Patch(color=CAUSES[c][0], label=CAUSES[c][1]) for c in CAUSES if cut.made.count(c)]
    _legend(axis, [*marks, _border_mark()] if drawn else marks)
    axis.set_title(f"what made the overcut beyond {tolerance_um:g} µm\n{_counted(cut)}", fontsize=10)


def _border_mark() -> Any:
    from matplotlib.lines import Line2D

    return Line2D([], [], color="k", lw=1.4, ls="--", label="border of the contacts predicted to gouge")


def _legend(axis: Any, marks: list[Any]) -> None:
    axis.legend(handles=marks, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2, frameon=False)


def _counted(cut: ToolCut) -> str:
    q = cut.rings
    gouge, against = int(q.gouging.sum()), int(q.disagree.sum())
    return f"{len(q.contact):,} contacts cut alone: {gouge:,} gouge, {against} against prediction"


def _predicted(axis: Any, cut: ToolCut) -> bool:
    """The border between points where the tool would gouge and where not; False where there is none."""
    least = np.where(cut.samples.touches, cut.samples.comparison.least, np.nan).reshape(cut.grid.shape)
    bordered = bool(np.nanmin(least, initial=0.0) < -_TIE and np.nanmax(least, initial=-_TIE) > _TIE)
    if bordered:
        axis.contour(
            cut.grid.length, cut.grid.height, least, levels=[-_TIE], colors="k", linewidths=1.4, linestyles="--"
        )
    return bordered


def draw_flat_rule(save: Save) -> None:
    """flat-end-mill.png: the largest flat end mill in a bowl over the contact angle, by Khan's (6.24) and rightly."""
    plt = pyplot()
    eta = np.linspace(0.0, 90.0, 181)
    figure, axis = plt.subplots(figsize=(8.0, 5.2), constrained_layout=True)
    axis.plot(
        eta, 20.0 * np.sin(np.radians(eta)), color=TOOL, lw=2, label=r"$k = k_n / \sin\,\eta$: the bowl's level section"
    )
    axis.plot(
        eta, 20.0 * np.cos(np.radians(eta)), color=PART, lw=2, ls="--", label=r"as printed: $k = k_n / \cos\,\eta$"
    )
    for value, colour in ((10.0, TOOL), (17.3, PART)):
        axis.plot([30.0], [value], "o", color=colour)
        axis.annotate(f"{value:g} mm", (30.0, value), xytext=(10, 3), textcoords="offset points", fontsize=10)
    axis.set_xlabel("η, angle of the normal from the axis [deg]")
    axis.set_ylabel("largest R of a flat end mill [mm]")
    axis.set_title("Khan 6.3: a flat end mill in a bowl of radius 20 mm", fontsize=12)
    axis.legend(frameon=False)
    axis.grid(alpha=0.25)
    axis.spines[["top", "right"]].set_visible(False)
    save(figure, "flat-end-mill.png", 110)
