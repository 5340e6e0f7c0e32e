"""The machined surface in 3D, in the drawing process."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.canvas import Canvas, add_map, add_mesh
from gearsim.output.colours import STEEL
from gearsim.output.meshes import points_of, segments, values_of
from gearsim.output.view import DEVIATION, Look, add_colours, aim_alike

_SHOWN = 2
_TOOL = "#3d4752"


def draw_surfaces(data: dict[str, NDArray], surfaces: dict[str, Any], canvas: Canvas) -> None:
    """The surface under the first tools side by side, coloured by deviation, with the tool at the plotted contact.

    Colours span the deviations, or the tolerance where these are smaller.
    """
    names, looks = list(surfaces)[:_SHOWN], []
    for view, name in zip(canvas.views(len(names)), names, strict=True):
        um = values_of(surfaces[name], "deviation_um")
        limit = max(float(np.nanmax(np.abs(um), initial=1e-3)), float(data[f"gouge:{name}:tolerance_um"]))
        add_map(view, surfaces[name], "deviation_um", limit, missing=STEEL, smooth=True, ambient=0.55, diffuse=0.5)
        add_colours(view, limit, DEVIATION)
        shown, tip = [points_of(surfaces[name])], data[f"gouge:{name}:tip"]
        if np.isfinite(tip).all():
            shown.append(_add_tool(view, data[f"gouge:{name}:profile"], tip, float(np.max(shown[0][:, 2]))))
        way = _way(data[f"patch:{name}:normal"])
        text = f"{data[f'gouge:{name}:label']}, at the plotted contact"
        looks.append(Look(view, np.concatenate(shown), way, (0.0, 0.0, 1.0), text))
    aim_alike(looks)


def _add_tool(view: Any, profile: NDArray, tip: NDArray, top: float) -> NDArray:
    """The tool at its contact as meridians and level circles, up to a height; its points."""
    side = profile[: int(np.argmax(profile[:, 0] >= profile[:, 0].max() - 1e-9)) + 1]
    side = np.vstack([side, [side[-1, 0], max(top - tip[2], side[-1, 1])]])
    turn = np.linspace(0.0, 2.0 * np.pi, 121)

    def turned(r: NDArray, angle: NDArray, z: NDArray) -> NDArray:
        return tip + np.column_stack([r * np.cos(angle), r * np.sin(angle), z + 0.0 * angle])

    lines = [turned(side[:, 0], np.full(len(side), a), side[:, 1]) for a in turn[:-1:5]]
    levels = np.unique(np.round(np.linspace(0, len(side) - 1, 8)).astype(int))
    lines += [
        turned(np.full(len(turn), side[k, 0]), turn, np.full(len(turn), side[k, 1])) for k in levels if side[k, 0]
    ]
    wire = segments(np.concatenate([line[:-1] for line in lines]), np.concatenate([line[1:] for line in lines]))
    add_mesh(view, wire, _TOOL, width=1.4, opacity=0.6)
    return points_of(wire)


def _way(normal: NDArray) -> NDArray:
    """The way to the eye: the tool's side, a little from above and across."""
    out = np.nanmean(normal.reshape(-1, 3), axis=0) * [1.0, 1.0, 0.0]
    out = out / np.linalg.norm(out) if np.linalg.norm(out) > 1e-6 else np.array([1.0, 0.0, 0.0])
    up = np.array([0.0, 0.0, 1.0])
    return np.asarray(0.7 * out + 0.5 * np.cross(up, out) + 0.5 * up)
