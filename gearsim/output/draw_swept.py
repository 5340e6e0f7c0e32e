"""Surfaces with the curves in which a tool grazes them, and the tool; runs in the drawing process."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.canvas import Canvas, add_mesh
from gearsim.output.colours import DARK, STEEL
from gearsim.output.draw import COLOURS, into_slot
from gearsim.output.meshes import points_of, quads, segments
from gearsim.output.slot import place
from gearsim.output.view import Look, add_legend, add_name, aim_alike

_NAMED = {**COLOURS, "left": COLOURS["convex"], "right": COLOURS["concave"]}
_TURNS = 97  # places about a tool
_DWARFS, _ABOUT = 3.0, 0.75  # times the size of what is cut: a tool larger than the one is shown within the other
_TINTS = ("#8cb369", "#f4a259", "#7b6d8d", "#5b8e7d", "#c9ada7")


def draw_swept(data: dict[str, NDArray], surfaces: dict[str, Any], canvas: Canvas) -> None:
    """The surfaces with their grazing curves, alone and with the tool at the ends of its motion."""
    colours = {name: _NAMED.get(name, _TINTS[k % len(_TINTS)]) for k, name in enumerate(surfaces)}
    tools = [
        tool_skin(data["tool:profile"], tip, axis)
        for tip, axis in zip(data["tool:tip"][[0, -1]], data["tool:axis"][[0, -1]], strict=True)
    ]
    near = np.concatenate([points_of(shape) for shape in surfaces.values()])
    tools = [_close_to(near, tool) for tool in tools]
    texts = ("surfaces and grazing curves", "with the tool at the ends of its motion")
    looks, shown = [], np.concatenate([near, *map(points_of, tools)])
    for view, text, more in zip(canvas.views(2), texts, ([], tools), strict=True):
        for name, shape in surfaces.items():
            add_mesh(view, shape, colours[name], smooth=True, opacity=0.9, ambient=0.35, diffuse=0.65)
            add_mesh(view, _curves(data[f"grazing:{name}"]), DARK, width=2.0)
            if name in _NAMED:
                add_name(view, place(data, name), name)
        for tool in more:
            add_mesh(view, tool, STEEL, opacity=0.35)
        foot = add_legend(view, {**colours, "grazing curves": DARK, **({"the tool": STEEL} if more else {})})
        looks.append(Look(view, shown, *_ways(data), text, foot))
    aim_alike(looks)


def _close_to(near: NDArray, tool: Any) -> Any:
    """Of a tool that dwarfs what it cuts, the part about it."""
    middle = 0.5 * (near.min(axis=0) + near.max(axis=0))
    size = float(np.linalg.norm(np.ptp(near, axis=0)))
    points = points_of(tool)
    if np.linalg.norm(np.ptp(points, axis=0)) < _DWARFS * size:
        return tool
    grid = points.reshape(-1, _TURNS, 3)
    kept = np.linalg.norm(grid - middle, axis=-1).min(axis=0) < _ABOUT * size
    first = int(np.argmin(kept)) if kept.any() and not kept.all() else 0
    order = np.roll(np.arange(_TURNS), -first)
    return quads(grid[:, order[kept[order]]])


def _curves(points: NDArray) -> Any:
    """The stretches of curves, shape (curves, points, 3), that exist."""
    starts, ends = points[:, :-1].reshape(-1, 3), points[:, 1:].reshape(-1, 3)
    exists = np.isfinite(starts[:, 0]) & np.isfinite(ends[:, 0])
    return segments(starts[exists], ends[exists])


def tool_skin(outline: NDArray, tip: NDArray, axis: NDArray) -> Any:
    """A tool's meridian (r, z) turned about its axis."""
    angles = np.linspace(0.0, 2.0 * np.pi, _TURNS)
    x = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    x /= np.linalg.norm(x)
    radial = np.cos(angles)[:, None] * x + np.sin(angles)[:, None] * np.cross(axis, x)
    points = tip + outline[:, 1, None, None] * axis + outline[:, 0, None, None] * radial
    return quads(points)


def _ways(data: dict[str, NDArray]) -> tuple[NDArray, NDArray]:
    """The way to the eye, and up: into a slot, or from the shank's side, a little from ahead and from the left."""
    if "view:up" in data:
        return into_slot(data)
    up = data["tool:axis"][1]
    ahead = data["tool:tip"][-1] - data["tool:tip"][0]
    ahead -= (ahead @ up) * up
    ahead /= max(float(np.linalg.norm(ahead)), 1e-12)
    return 0.62 * up + 0.62 * ahead - 0.48 * np.cross(ahead, up), up
