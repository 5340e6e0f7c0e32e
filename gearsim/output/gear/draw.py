"""gear.png; runs in the drawing process."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from gearsim.output.draw import STEEL, plotter_with
from gearsim.output.draw_swept import tool_skin
from gearsim.output.gear.style import NOISE_UM, unit_for

_LEVELS = 25
_LIFT = 0.03  # mm out of the tri-dexel's surface, so that the measured flanks are not drawn inside it
_TOOL = "#d8b26e"
_LIGHT = {"ambient": 0.35, "diffuse": 0.65, "smooth_shading": True, "split_sharp_edges": True}
_BAR = {"color": "black", "fmt": "%.3g", "title_font_size": 20, "label_font_size": 18, "width": 0.7, "position_x": 0.15}


def draw_gear(data: dict[str, NDArray], surfaces: dict[str, Any], file: Path) -> None:
    """The whole gear with the tool in space 0 at the left; space 0 with its measured flanks at the right."""
    plotter = plotter_with(views=2)
    plotter.window_size = [1800, 900]
    plotter.subplot(0, 0)
    plotter.add_mesh(_gear_body(data), color=STEEL, **_LIGHT)
    plotter.add_mesh(tool_skin(data["gear:profile"], data["gear:tip"], data["gear:axis"]), color=_TOOL, **_LIGHT)
    way = "helix" if data["gear:twist"] else "axis"
    plotter.add_text(f"the section as cut, carried along the {way}, and the tool", color="black", font_size=10)
    size = float(np.ptp(data["section:x"]))
    _look(plotter, np.array([0.0, 0.0, -0.5 * float(data["gear:facewidth"])]), data, 2.0 * size)
    plotter.subplot(0, 1)
    _add_space(plotter, data, surfaces)
    plotter.screenshot(str(file))


def _add_space(plotter: Any, data: dict[str, NDArray], surfaces: dict[str, Any]) -> None:
    """Space 0 as its tri-dexel shows it, the measured flanks laid on it and coloured by their deviation."""
    import pyvista as pv

    shape, step = data["body:field"].shape, data["body:step"]
    grid = pv.ImageData(dimensions=shape, spacing=tuple(step), origin=tuple(data["body:origin"]))
    grid["inside"] = data["body:field"].ravel(order="F")
    body = grid.contour([0.0], scalars="inside", method="flying_edges")
    for z, way in ((-float(data["gear:facewidth"]), 1.0), (0.0, -1.0)):
        body = body.clip_closed_surface(normal=(0.0, 0.0, way), origin=(0.0, 0.0, z))
    plotter.add_mesh(body, color=STEEL, **_LIGHT)
    um = np.concatenate([data[key].ravel() for key in data if key.endswith(":deviation_um")])
    unit = unit_for(um)
    limit = unit.per_um * max(float(np.nanmax(np.abs(um), initial=0.0)), NOISE_UM)
    for mesh in surfaces.values():
        lifted = mesh.copy()
        lifted.points = mesh.points + _LIFT * mesh["intended_normal"]
        lifted["shown"] = unit.per_um * mesh["deviation_um"]
        plotter.add_mesh(
            lifted, scalars="shown", cmap="RdBu_r", clim=(-limit, limit), ambient=0.4, diffuse=0.6,
            nan_color="black", scalar_bar_args=_BAR | {"title": unit.name.replace("µ", "u")},
        )  # fmt: skip
    text = "space 1 (tri-dexel) and its measured flanks: + material left, - overcut"
    plotter.add_text(text, color="black", font_size=10)
    middle, extent = np.asarray(body.center), np.array(body.bounds).reshape(3, 2)
    _look(plotter, middle, data, 2.1 * float(np.linalg.norm(np.ptp(extent, axis=1))))


def _look(plotter: Any, centre: NDArray, data: dict[str, NDArray], distance: float) -> None:
    """Look at space 0 from above and from where it opens, a little from the side."""
    way = np.array([0.62 * float(data["gear:sign"]), -0.35, 0.7])
    plotter.camera_position = [tuple(centre + distance * way), tuple(centre), (0.0, 0.0, 1.0)]


def _gear_body(data: dict[str, NDArray]) -> Any:
    """The section between the faces, turned along the helix: both faces and the skin between them."""
    import pyvista as pv

    face = _face(data)
    edge = face.extract_feature_edges(
        boundary_edges=True, non_manifold_edges=False, feature_edges=False, manifold_edges=False
    )
    lines = edge.lines.reshape(-1, 3)[:, 1:]
    levels = np.linspace(0.0, -float(data["gear:facewidth"]), _LEVELS)
    rings = np.stack([_at(edge.points, z, data) for z in levels])
    n = len(edge.points)
    upper = (np.arange(_LEVELS - 1)[:, None, None] * n + lines).reshape(-1, 2)
    strips = np.column_stack([np.full(len(upper), 4), upper, upper[:, ::-1] + n])
    skin = pv.PolyData(rings.reshape(-1, 3), strips.ravel())
    ends = [pv.PolyData(_at(face.points, z, data), face.faces) for z in levels[[0, -1]]]
    return pv.merge([skin, *ends], merge_points=False).extract_surface(algorithm=None)


def _face(data: dict[str, NDArray]) -> Any:
    """The section as a flat mesh: where the share of material, smoothed by a cell, is over a half."""
    import pyvista as pv

    share = gaussian_filter(data["section:share"], 0.8)
    grid = pv.StructuredGrid(*np.meshgrid(data["section:x"], data["section:y"], [0.0], indexing="ij"))
    grid["share"] = share.T.ravel(order="F")
    return grid.clip_scalar(scalars="share", value=0.5, invert=False).extract_surface(algorithm=None).triangulate()


def _at(points: NDArray, z: float, data: dict[str, NDArray]) -> NDArray:
    """The section's points carried along the helix to height z."""
    turn = float(data["gear:twist"]) * (z - float(data["section:z"]))
    x, y = points[:, 0], points[:, 1]
    cos, sin = np.cos(turn), np.sin(turn)
    return np.column_stack([cos * x - sin * y, sin * x + cos * y, np.full(len(points), z)])
