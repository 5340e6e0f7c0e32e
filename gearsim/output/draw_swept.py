"""Surfaces with the curves in which a tool grazes them, and the tool; runs in the drawing process."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.draw import COLOURS, STEEL, look_into_slot, plotter_with

_NAMED = {**COLOURS, "left": COLOURS["convex"], "right": COLOURS["concave"]}
_TINTS = ("#8cb369", "#f4a259", "#7b6d8d", "#5b8e7d", "#c9ada7")


def draw_swept(data: dict[str, NDArray], surfaces: dict[str, Any], file: Path) -> None:
    """The surfaces with their grazing curves, alone and with the tool at the ends of its motion."""
    plotter = plotter_with(views=2)
    for view, text in enumerate(("surfaces and grazing curves", "with the tool at the ends of its motion")):
        plotter.subplot(0, view)
        for number, (name, mesh) in enumerate(surfaces.items()):
            colour = _NAMED.get(name, _TINTS[number % len(_TINTS)])
            plotter.add_mesh(mesh.copy(), color=colour, smooth_shading=True, opacity=0.9, ambient=0.35)
            for curve in data[f"grazing:{name}"]:
                _add_curve(plotter, curve)
        if view:
            _add_tools(plotter, data)
        plotter.add_text(text, color="black", font_size=11)
        if "view:up" in data:
            size = float(np.linalg.norm(data["view:along"]))
            look_into_slot(plotter, data["view:centre"], data, size * (4.6 if view else 2.6))
        else:
            _look_from_ahead(plotter, surfaces, data)
    plotter.screenshot(str(file))


def _add_curve(plotter: Any, points: NDArray) -> None:
    """The stretches of a curve that exist."""
    import pyvista as pv

    exists = np.isfinite(points[:, 0])
    starts = np.flatnonzero(exists & ~np.append(False, exists[:-1]))
    ends = np.flatnonzero(exists & ~np.append(exists[1:], False))
    for start, end in zip(starts, ends, strict=True):
        if end > start:
            plotter.add_mesh(pv.lines_from_points(points[start : end + 1]), color="black", line_width=2)


def _add_tools(plotter: Any, data: dict[str, NDArray]) -> None:
    for tip, axis in zip(data["tool:tip"][[0, -1]], data["tool:axis"][[0, -1]], strict=True):
        plotter.add_mesh(tool_skin(data["tool:profile"], tip, axis), color=STEEL, opacity=0.35, smooth_shading=False)


def tool_skin(outline: NDArray, tip: NDArray, axis: NDArray) -> Any:
    """A tool's meridian (r, z) turned about its axis."""
    import pyvista as pv

    angles = np.linspace(0.0, 2.0 * np.pi, 97)
    x = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    x /= np.linalg.norm(x)
    radial = np.cos(angles)[:, None] * x + np.sin(angles)[:, None] * np.cross(axis, x)
    points = tip + outline[:, 1, None, None] * axis + outline[:, 0, None, None] * radial
    return pv.StructuredGrid(*(points[..., None, k] for k in range(3)))


def _look_from_ahead(plotter: Any, surfaces: dict[str, Any], data: dict[str, NDArray]) -> None:
    """From the shank's side, a little from ahead and from the left of the feed."""
    import pyvista as pv

    bounds = np.array(pv.merge([s.copy() for s in surfaces.values()], merge_points=False).bounds).reshape(3, 2)
    centre, size = bounds.mean(axis=1), float(np.linalg.norm(np.ptp(bounds, axis=1)))
    up = data["tool:axis"][1]
    ahead = data["tool:tip"][-1] - data["tool:tip"][0]
    ahead -= (ahead @ up) * up
    ahead /= max(float(np.linalg.norm(ahead)), 1e-12)
    eye = centre + 2.4 * size * (0.62 * up + 0.62 * ahead - 0.48 * np.cross(ahead, up))
    plotter.camera_position = [tuple(eye), tuple(centre), tuple(up)]
