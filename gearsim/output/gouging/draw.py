"""The machined surface in 3D, in the drawing process."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.colours import DIVERGING
from gearsim.output.view import DEVIATION, STEEL, add_colours, aim, plotter_with, segments

_SHOWN = 2
_TOOL = "#3d4752"


def draw_surfaces(data: dict[str, NDArray], surfaces: dict[str, Any], file: Path) -> None:
    """The surface under the first tools side by side, coloured by deviation, with the tool at the plotted contact."""
    names = list(surfaces)[:_SHOWN]
    plotter = plotter_with(views=len(names))
    for view, name in enumerate(names):
        plotter.subplot(0, view)
        mesh = surfaces[name].copy()
        um = np.asarray(mesh["deviation_um"])
        limit = max(float(np.nanmax(np.abs(um), initial=0.0)), 1e-3)
        plotter.add_mesh(
            mesh, scalars="deviation_um", cmap=DIVERGING, clim=(-limit, limit), nan_color=STEEL, smooth_shading=True,
            ambient=0.4, diffuse=0.6,
            show_scalar_bar=False,
        )  # fmt: skip
        add_colours(plotter, limit, DEVIATION)
        tip = data[f"gouge:{name}:tip"]
        if np.isfinite(tip).all():
            _add_tool(plotter, data[f"gouge:{name}:profile"], tip, float(np.max(np.asarray(mesh.points)[:, 2])))
        low, high = np.reshape(plotter.renderer.bounds, (3, 2)).T
        corners = np.stack(np.meshgrid(*np.stack([low, high], axis=1), indexing="ij"), axis=-1)
        aim(plotter, corners, _way(data[f"patch:{name}:normal"]), (0.0, 0.0, 1.0), str(data[f"gouge:{name}:label"]))
    plotter.screenshot(str(file))


def _add_tool(plotter: Any, profile: NDArray, tip: NDArray, top: float) -> None:
    """The tool at its contact as meridians and level circles, up to a height."""
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
    mesh = segments(np.concatenate([line[:-1] for line in lines]), np.concatenate([line[1:] for line in lines]))
    plotter.add_mesh(mesh, color=_TOOL, line_width=1.4, opacity=0.6)


def _way(normal: NDArray) -> NDArray:
    """The way to the eye: the tool's side, a little from above and across."""
    out = np.nanmean(normal.reshape(-1, 3), axis=0) * [1.0, 1.0, 0.0]
    out = out / np.linalg.norm(out) if np.linalg.norm(out) > 1e-6 else np.array([1.0, 0.0, 0.0])
    up = np.array([0.0, 0.0, 1.0])
    return np.asarray(0.7 * out + 0.5 * np.cross(up, out) + 0.5 * up)
