"""The machined surface in 3D, in the drawing process."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.draw import STEEL, plotter_with
from gearsim.output.generating.draw import tool_skin

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
            ambient=0.35, diffuse=0.65,
            scalar_bar_args={"title": "um" + " " * view, "color": "black", "fmt": "%.3g", "title_font_size": 20,
                             "label_font_size": 18, "width": 0.8, "position_x": 0.1},
        )  # fmt: skip
        tip = data[f"gouge:{name}:tip"]
        if np.isfinite(tip).all():
            skin = tool_skin(data[f"gouge:{name}:profile"], tip, np.array([0.0, 0.0, 1.0]))
            top = float(np.max(np.asarray(mesh.points)[:, 2])) + 0.1 * float(mesh.length)
            skin = skin.extract_surface(algorithm=None).clip((0.0, 0.0, 1.0), (0.0, 0.0, top))
            plotter.add_mesh(skin, color="#9aa5b1", opacity=0.28, smooth_shading=True)
        plotter.add_text(f"{data[f'gouge:{name}:label']}\n+ material left, - overcut", color="black", font_size=11)
        _look(plotter, mesh, data[f"patch:{name}:normal"], tip)
    plotter.screenshot(str(file))


def _look(plotter: Any, mesh: Any, normal: NDArray, tip: NDArray) -> None:
    """From the tool's side of the surface, a little from above and across."""
    centre = np.asarray(mesh.center)
    out = np.nanmean(normal.reshape(-1, 3), axis=0) * [1.0, 1.0, 0.0]
    out = out / np.linalg.norm(out) if np.linalg.norm(out) > 1e-6 else np.array([1.0, 0.0, 0.0])
    side = np.cross([0.0, 0.0, 1.0], out)
    size = float(np.linalg.norm(np.ptp(np.asarray(mesh.points), axis=0)))
    if np.isfinite(tip).all():
        centre = 0.75 * centre + 0.25 * tip
    eye = centre + 2.3 * size * (0.5 * out + 0.7 * side + 0.5 * np.array([0.0, 0.0, 1.0]))
    plotter.camera_position = [tuple(eye), tuple(centre), (0.0, 0.0, 1.0)]
