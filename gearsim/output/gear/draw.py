"""gear.png; runs in the drawing process."""

from __future__ import annotations

from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from gearsim.output.colours import DIVERGING
from gearsim.output.draw_swept import tool_skin
from gearsim.output.gear.style import NOISE_UM, unit_for
from gearsim.output.view import DEVIATION, STEEL, add_colours, add_legend, aim, plotter_with

_TURN = np.radians(2.0)
_LIFT = 0.03  # mm out of the tri-dexel's surface, so that the measured flanks are not drawn inside it
_TOOL = "#d8b26e"
_LIGHT = {"ambient": 0.35, "diffuse": 0.65, "smooth_shading": True, "split_sharp_edges": True}


def draw_gear(data: dict[str, NDArray], surfaces: dict[str, Any], file: Path) -> None:
    """The whole gear with the tool in space 0 at the left; space 0 with its measured flanks at the right."""
    plotter = plotter_with(views=2, size=(1300, 700))
    plotter.subplot(0, 0)
    skin, ends = _gear_body(data)
    tool = tool_skin(data["gear:profile"], data["gear:tip"], data["gear:axis"])
    plotter.add_mesh(skin, color=STEEL, **_LIGHT)
    plotter.add_mesh(ends, color=STEEL, ambient=0.35, diffuse=0.65)
    plotter.add_mesh(tool, color=_TOOL, **_LIGHT)
    add_legend(plotter, {"the gear": STEEL, "the tool": _TOOL})
    carried = "helix" if data["gear:twist"] else "axis"
    text = f"the section as cut, carried along the {carried}, and the tool"
    aim(plotter, np.concatenate([skin.points, tool.points]), *_ways(data), text)
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
            lifted, scalars="shown", cmap=DIVERGING, clim=(-limit, limit), ambient=0.4, diffuse=0.6,
            nan_color="black", show_scalar_bar=False,
        )  # fmt: skip
    add_colours(plotter, limit, DEVIATION.replace("um", unit.name.replace("µ", "u")))
    aim(plotter, np.asarray(body.points), *_ways(data), "space 1 (tri-dexel) and its measured flanks")


def _ways(data: dict[str, NDArray]) -> tuple[NDArray, tuple[float, float, float]]:
    """The way to an eye above and where space 0 opens, a little from the side; and up."""
    return np.array([0.62 * float(data["gear:sign"]), -0.35, 0.7]), (0.0, 0.0, 1.0)


def _gear_body(data: dict[str, NDArray]) -> tuple[Any, Any]:
    """The section between the faces, turned along the helix: the skin and both faces."""
    import pyvista as pv

    face, edge = _face(data)
    lines = edge.lines.reshape(-1, 3)[:, 1:]
    levels = np.linspace(0.0, -float(data["gear:facewidth"]), _levels(data))
    rings = np.stack([_at(edge.points, z, data) for z in levels])
    n = len(edge.points)
    upper = (np.arange(len(levels) - 1)[:, None, None] * n + lines).reshape(-1, 2)
    strips = np.column_stack([np.full(len(upper), 4), upper, upper[:, ::-1] + n])
    skin = pv.PolyData(rings.reshape(-1, 3), strips.ravel())
    ends = [pv.PolyData(_at(face.points, z, data), face.faces) for z in levels[[0, -1]]]
    return skin, pv.merge(ends, merge_points=False)


def _levels(data: dict[str, NDArray]) -> int:
    """Rings of the skin: one for every few degrees that the helix turns."""
    turn = abs(float(data["gear:twist"]) * float(data["gear:facewidth"]))
    return 2 + ceil(turn / _TURN)


def _face(data: dict[str, NDArray]) -> tuple[Any, Any]:
    """The section as a flat mesh, where the share of material, smoothed by a cell, is over a half; and its edge.

    Cells that are whole are joined along their rows: a face has some thousands of polygons, not some hundred thousands.
    """
    import pyvista as pv

    x, y = data["section:x"], data["section:y"]
    share = gaussian_filter(data["section:share"], 0.8)
    grid = pv.StructuredGrid(*np.meshgrid(x, y, [0.0], indexing="ij"))
    grid["share"] = share.ravel()
    inside = share > 0.5
    corners = np.stack([inside[:-1, :-1], inside[1:, :-1], inside[1:, 1:], inside[:-1, 1:]])
    whole, cut = corners.all(axis=0), corners.any(axis=0) & ~corners.all(axis=0)
    border = grid.extract_cells(np.flatnonzero(cut.ravel())).clip_scalar(scalars="share", value=0.5, invert=False)
    steps = np.diff(np.pad(whole, ((0, 0), (1, 1))).astype(int), axis=1)
    (row, first), (_, last) = np.nonzero(steps == 1), np.nonzero(steps == -1)
    quads = np.stack([x[first], y[row], x[last], y[row], x[last], y[row + 1], x[first], y[row + 1]], axis=1)
    faces = np.column_stack([np.full(len(row), 4), np.arange(4 * len(row)).reshape(-1, 4)])
    runs = pv.PolyData(np.column_stack([quads.reshape(-1, 2), np.zeros(4 * len(row))]), faces.ravel())
    return pv.merge([runs, border.extract_surface(algorithm=None)], merge_points=False), grid.contour([0.5], "share")


def _at(points: NDArray, z: float, data: dict[str, NDArray]) -> NDArray:
    """The section's points carried along the helix to height z."""
    turn = float(data["gear:twist"]) * (z - float(data["section:z"]))
    x, y = points[:, 0], points[:, 1]
    cos, sin = np.cos(turn), np.sin(turn)
    return np.column_stack([cos * x - sin * y, sin * x + cos * y, np.full(len(points), z)])
