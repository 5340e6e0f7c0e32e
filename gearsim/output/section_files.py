"""Plane sections as files: CSV, VTP and pictures."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError, written
from gearsim.output.colours import class_colours
from gearsim.output.exr import SIGN
from gearsim.output.meshes import mesh, write_vtp
from gearsim.output.plane_section import Cut, deviations
from gearsim.output.saving import draw_png

_MATERIAL, _OUTLINE = "#d9dde3", "#30363d"
_INCHES, _HEAD, _LINE = 7.5, 1.2, 0.2  # a page's width, what is above and below the plot, a line of the legend


def write_section(cut: Cut, file: Path) -> None:
    """Write a section in the format that the file's name ends in: .svg, .pdf, .png, .csv or .vtp.

    Raises InputError for another ending, and where it cannot be written.
    """
    require_section(file)
    with written(file, "section") as scratch:
        _WRITERS[file.suffix.lower()](cut, scratch)


def require_section(file: Path) -> None:
    """Raise InputError where a file's name ends in no format that a section is written in."""
    if file.suffix.lower() not in _WRITERS:
        raise InputError(f"{file}: the name of a section's file ends in {', '.join(_WRITERS)}")


def _write_csv(cut: Cut, file: Path) -> None:
    """A row a point: the plane, the curve's number from 1, what it is, where, how far the machined surface is off.

    Nothing above the names: what holds for all points stands in columns.
    """
    u, v, names = cut.plane.frame
    more = [] if names != "uv" else ["u_mm", "v_mm"]
    with file.open("w", newline="", encoding="utf-8") as out:
        rows = csv.writer(out)
        rows.writerow(["plane", "curve", "kind", "name", "closed", "x_mm", "y_mm", "z_mm", *more, "deviation_um"])
        for k, c in enumerate(cut.curves, 1):
            for p, d in zip(c.points, c.deviation, strict=True):
                place = [*p, *([p @ u, p @ v] if more else [])]
                um = "" if np.isnan(d) else repr(1e3 * float(d))
                rows.writerow([cut.plane.text, k, c.kind, c.name, int(c.closed), *(repr(float(x)) for x in place), um])


def _write_vtp(cut: Cut, file: Path) -> None:
    """Lines, each with its curve's number from 1 and whether it is intended; deviations at the points."""
    starts = np.cumsum([0, *(len(c.points) for c in cut.curves)])
    lines, number, intended = [], [], []
    for k, (c, first) in enumerate(zip(cut.curves, starts, strict=False), 1):
        index = first + np.arange(len(c.points))
        along = np.column_stack([index, np.roll(index, -1)])[: None if c.closed else -1]
        lines.append(along)
        number.append(np.full(len(along), k))
        intended.append(np.full(len(along), int(c.kind == "intended")))
    shape = mesh(
        np.concatenate([c.points for c in cut.curves]), lines=np.concatenate(lines),
        values={"deviation_um": 1e3 * np.concatenate([c.deviation for c in cut.curves])},
        cells={"curve": np.concatenate(number), "intended": np.concatenate(intended)},
    )  # fmt: skip
    write_vtp(shape, {"unit": "mm", "sign": SIGN, "plane": cut.plane.text}, file)


def _figure(cut: Cut) -> Any:
    """The material in grey, what is intended as thin lines over it; one scale both ways."""
    from matplotlib.figure import Figure

    u, v, names = cut.plane.frame
    points = np.concatenate([c.points for c in cut.curves])
    wide, high = (max(float(np.ptp(points @ way)), 1e-9) for way in (u, v))
    entries = 1 + len({c.name for c in cut.curves})
    height = float(np.clip(_INCHES * high / wide, 1.0, 1.5 * _INCHES)) + _HEAD + _LINE * entries
    figure = Figure(figsize=(_INCHES, height), layout="constrained")
    axis = figure.add_subplot(aspect="equal")
    _draw(axis, cut, u, v)
    axis.autoscale_view()
    for label, name, way in ((axis.set_xlabel, names[0], u), (axis.set_ylabel, names[1], v)):
        along = "" if names != "uv" else " along " + ", ".join(f"{x + 0.0:.3g}" for x in way)
        label(f"{name} [mm]{along}")
    axis.set_title(f"Section {cut.plane.text} mm, seen against its normal")
    figure.legend(loc="outside lower center", fontsize=8, frameon=False)
    return figure


def _draw(axis: Any, cut: Cut, u: NDArray, v: NDArray) -> None:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    loops = [np.column_stack([c.points @ u, c.points @ v]) for c in cut.curves if c.closed]
    if loops:
        outline = Outline.make_compound_path(*(Outline(np.concatenate([p, p[:1]]), closed=True) for p in loops))
        axis.add_patch(PathPatch(outline, fc=_MATERIAL, ec=_OUTLINE, lw=0.8, label=f"as cut, {cut.area:.6g} mm²"))
    names = list(dict.fromkeys(c.name for c in cut.curves if c.kind == "intended"))
    colours, told = class_colours(names), set()
    for c in (c for c in cut.curves if not c.closed):
        called, colour, width = "as machined", _OUTLINE, 2.4
        if c.kind == "intended":
            called = f"{c.name}, intended: {deviations(cut, c.name).replace('um', 'µm')}"
            colour, width = colours[names.index(c.name)], 1.2
        label = None if called in told else called
        axis.plot(c.points @ u, c.points @ v, color=colour, lw=width, label=label, zorder=5.0 - width)
        told.add(called)


def _write_png(cut: Cut, file: Path) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure = _figure(cut)
    FigureCanvasAgg(figure)
    draw_png(figure, file, 150.0)


def _write_vector(cut: Cut, file: Path, kind: str) -> None:
    _figure(cut).savefig(file, format=kind)


_WRITERS: dict[str, Callable[[Cut, Path], None]] = {
    ".svg": lambda cut, file: _write_vector(cut, file, "svg"),
    ".pdf": lambda cut, file: _write_vector(cut, file, "pdf"),
    ".png": _write_png,
    ".csv": _write_csv,
    ".vtp": _write_vtp,
}
