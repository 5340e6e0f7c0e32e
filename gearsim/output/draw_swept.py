"""Surfaces with the curves in which a tool grazes them, and the tool; runs in the drawing process."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.draw import COLOURS, into_slot
from gearsim.output.view import STEEL, add_legend, aim, plotter_with, segments

_NAMED = {**COLOURS, "left": COLOURS["convex"], "right": COLOURS["concave"]}
_NEAR = 1.2
_TINTS = ("#8cb369", "#f4a259", "#7b6d8d", "#5b8e7d", "#c9ada7")


def draw_swept(data: dict[str, NDArray], surfaces: dict[str, Any], file: Path) -> None:
    """The surfaces with their grazing curves, alone and with the tool at the ends of its motion."""
    plotter = plotter_with(views=2)
    colours = {name: _NAMED.get(name, _TINTS[k % len(_TINTS)]) for k, name in enumerate(surfaces)}
    tools = [
        tool_skin(data["tool:profile"], tip, axis)
        for tip, axis in zip(data["tool:tip"][[0, -1]], data["tool:axis"][[0, -1]], strict=True)
    ]
    for view, text in enumerate(("surfaces and grazing curves", "with the tool at the ends of its motion")):
        plotter.subplot(0, view)
        for name, mesh in surfaces.items():
            plotter.add_mesh(mesh.copy(), color=colours[name], smooth_shading=True, opacity=0.9, ambient=0.35)
            plotter.add_mesh(_curves(data[f"grazing:{name}"]), color="black", line_width=2)
        shown = np.concatenate([np.asarray(mesh.points) for mesh in surfaces.values()])
        for tool in tools if view else ():
            plotter.add_mesh(tool, color=STEEL, opacity=0.35, smooth_shading=False)
            shown = np.concatenate([shown, _near(np.asarray(tool.points), shown)])
        foot = add_legend(plotter, {**colours, "grazing curves": "black", **({"the tool": STEEL} if view else {})})
        aim(plotter, shown, *_ways(data), text, foot)
    plotter.screenshot(str(file))


def _near(points: NDArray, shown: NDArray) -> NDArray:
    """Points of a tool that are near what it makes: a large cutter is not shown whole."""
    middle, size = np.mean(shown, axis=0), float(np.linalg.norm(np.ptp(shown, axis=0)))
    return points[np.linalg.norm(points - middle, axis=1) < _NEAR * size]


def _curves(points: NDArray) -> Any:
    """The stretches of curves, shape (curves, points, 3), that exist."""
    starts, ends = points[:, :-1].reshape(-1, 3), points[:, 1:].reshape(-1, 3)
    exists = np.isfinite(starts[:, 0]) & np.isfinite(ends[:, 0])
    return segments(starts[exists], ends[exists])


def tool_skin(outline: NDArray, tip: NDArray, axis: NDArray) -> Any:
    """A tool's meridian (r, z) turned about its axis."""
    import pyvista as pv

    angles = np.linspace(0.0, 2.0 * np.pi, 97)
    x = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    x /= np.linalg.norm(x)
    radial = np.cos(angles)[:, None] * x + np.sin(angles)[:, None] * np.cross(axis, x)
    points = tip + outline[:, 1, None, None] * axis + outline[:, 0, None, None] * radial
    return pv.StructuredGrid(*(points[..., None, k] for k in range(3)))


def _ways(data: dict[str, NDArray]) -> tuple[NDArray, NDArray]:
    """The way to the eye, and up: into a slot, or from the shank's side, a little from ahead and from the left."""
    if "view:up" in data:
        return into_slot(data)
    up = data["tool:axis"][1]
    ahead = data["tool:tip"][-1] - data["tool:tip"][0]
    ahead -= (ahead @ up) * up
    ahead /= max(float(np.linalg.norm(ahead)), 1e-12)
    return 0.62 * up + 0.62 * ahead - 0.48 * np.cross(ahead, up), up
