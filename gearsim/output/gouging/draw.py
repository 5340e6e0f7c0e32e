"""The machined surface in 3D, in the drawing process."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.draw import STEEL, plotter_with

_SHOWN = 2


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
            mesh, scalars="deviation_um", cmap="RdBu_r", clim=(-limit, limit), nan_color=STEEL, smooth_shading=True,
            ambient=0.4, diffuse=0.6,
            scalar_bar_args={"title": "um" + " " * view, "color": "black", "fmt": "%.0f" if limit >= 100.0 else "%.3g",
                             "title_font_size": 20, "label_font_size": 18, "width": 0.8, "position_x": 0.1},
        )  # fmt: skip
        tip = data[f"gouge:{name}:tip"]
        if np.isfinite(tip).all():
            _add_tool(plotter, data[f"gouge:{name}:profile"], tip, float(np.max(np.asarray(mesh.points)[:, 2])))
        plotter.add_text(f"{data[f'gouge:{name}:label']}\n+ material left, - overcut", color="black", font_size=11)
        _look(plotter, data[f"patch:{name}:normal"])
    plotter.screenshot(str(file))


def _add_tool(plotter: Any, profile: NDArray, tip: NDArray, top: float) -> None:
    """The tool at its contact as meridians and level circles, up to a height."""
    import pyvista as pv

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
    for line in lines:
        plotter.add_mesh(pv.lines_from_points(line), color="#3d4752", line_width=1.4, opacity=0.6)


def _look(plotter: Any, normal: NDArray) -> None:
    """At the surface and the tool, whole, from the tool's side, a little from above and across."""
    low, high = np.reshape(plotter.renderer.bounds, (3, 2)).T
    out = np.nanmean(normal.reshape(-1, 3), axis=0) * [1.0, 1.0, 0.0]
    out = out / np.linalg.norm(out) if np.linalg.norm(out) > 1e-6 else np.array([1.0, 0.0, 0.0])
    side, centre = np.cross([0.0, 0.0, 1.0], out), 0.5 * (low + high)
    eye = centre + 2.7 * float(np.linalg.norm(high - low)) * (0.7 * out + 0.5 * side + 0.5 * np.array([0.0, 0.0, 1.0]))
    plotter.camera_position = [tuple(eye), tuple(centre), (0.0, 0.0, 1.0)]
