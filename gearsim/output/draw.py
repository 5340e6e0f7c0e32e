"""3D pictures with PyVista: meshes of measured patches, a white scene, blanks, toolpaths, envelopes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

_SIZE = (1400, 1000)
STEEL = "#b8bec6"
COLOURS = {"convex": "#d1495b", "concave": "#2e6f95"}


def patch_meshes(data: dict[str, NDArray]) -> dict[str, Any]:
    """The machined patches (intended points moved by their deviation) with their measured values."""
    names = sorted({key.split(":", 1)[1].rsplit(":", 1)[0] for key in data if key.startswith("patch:")})
    out = {}
    for number, name in enumerate(names):
        point, normal = data[f"patch:{name}:point"], data[f"patch:{name}:normal"]
        deviation = data[f"patch:{name}:deviation_um"]
        values = {
            "deviation_um": deviation,
            "crossing": data[f"patch:{name}:crossing"],
            "segment": data[f"patch:{name}:segment"],
            "patch": np.full(deviation.shape, number),
            "intended_normal": normal,
            "intended_point_mm": point,
        }
        out[name] = quads(point + 1e-3 * np.nan_to_num(deviation)[..., None] * normal, values)
    return out


def quads(points: NDArray, values: dict[str, NDArray]) -> Any:
    """A mesh of quads between neighbours of a grid of points, (rows, columns, 3), that all exist."""
    import pyvista as pv

    rows, columns = points.shape[:2]
    index = np.arange(rows * columns).reshape(rows, columns)
    faces = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    flat = points.reshape(-1, 3)
    faces = faces[np.isfinite(flat[faces]).all(axis=(1, 2))]
    mesh = pv.PolyData(np.nan_to_num(flat), np.hstack([np.full((len(faces), 1), 4), faces]).ravel())
    for name, value in values.items():
        mesh[name] = value.reshape(rows * columns, *value.shape[2:])
    return mesh.clean()


def plotter_with(views: int = 1) -> Any:
    """A white off-screen scene with views side by side."""
    import pyvista as pv

    plotter = pv.Plotter(off_screen=True, window_size=list(_SIZE), shape=(1, views), border=False)
    plotter.set_background("white")
    return plotter


def look_into_slot(plotter: Any, centre: NDArray, data: dict[str, NDArray], distance: float) -> None:
    """Look into the slot from above, a little from the heel and from the side."""
    up = data["view:up"]
    along = data["view:along"] - (data["view:along"] @ up) * up
    along /= np.linalg.norm(along)
    eye = centre + distance * (0.85 * up + 0.75 * along + 0.25 * np.cross(up, along))
    plotter.camera_position = [tuple(eye), tuple(centre), tuple(up)]


def _turned(polygon: NDArray, start: float, end: float) -> Any:
    """A polygon (radius, z) turned about z from one angle to another [deg], with its end faces."""
    import pyvista as pv

    angles = np.radians(np.linspace(start, end, 241))
    ring = np.vstack([polygon, polygon[:1]])
    x, y = (np.outer(f(angles), ring[:, 0]) for f in (np.cos, np.sin))
    z = np.tile(ring[:, 1], (len(angles), 1))
    skin = pv.StructuredGrid(*(c[..., None] for c in (x, y, z))).extract_surface(algorithm=None)
    face = [len(polygon), *range(len(polygon))]
    ends = [pv.PolyData(np.column_stack([x[i, :-1], y[i, :-1], z[i, :-1]]), face) for i in (0, -1)]
    return pv.merge([skin, *ends], merge_points=False)


def draw_blanks(data: dict[str, NDArray], _: dict[str, Any], file: Path) -> None:
    """Gear and pinion blank in mesh, part of the gear cut away."""
    plotter = plotter_with()
    shade = {"smooth_shading": True, "split_sharp_edges": True}
    plotter.add_mesh(_turned(data["part:polygon"], -150.0, 150.0), color=STEEL, **shade)
    pinion = _turned(data["mate:polygon"], 0.0, 360.0).rotate_y(90.0, inplace=False)
    plotter.add_mesh(pinion, color="#d8b26e", **shade)
    plotter.camera_position = [(-160.0, -200.0, -190.0), (0.0, 0.0, 22.0), (0.0, 0.0, -1.0)]
    plotter.camera.zoom(1.0)
    plotter.screenshot(str(file))


def _add_slot(plotter: Any, surfaces: dict[str, Any], without: str = "") -> None:
    for name, surface in surfaces.items():
        if name != without:
            plotter.add_mesh(surface, color=STEEL, smooth_shading=True)


def draw_toolpaths(data: dict[str, NDArray], surfaces: dict[str, Any], file: Path) -> None:
    """Tool axes and tip curves of both passes in the slot, side by side."""
    import pyvista as pv

    plotter = plotter_with(views=2)
    length = 0.6 * float(data["cutter:height"])
    for view, side in enumerate(("convex", "concave")):
        plotter.subplot(0, view)
        _add_slot(plotter, surfaces)
        tip, axis = data[f"path:{side}:tip"], data[f"path:{side}:axis"]
        plotter.add_mesh(pv.lines_from_points(tip), color="black", line_width=4)
        for a, b in zip(tip, tip + length * axis, strict=True):
            plotter.add_mesh(pv.Line(a, b), color=COLOURS[side], line_width=3)
        plotter.add_text(f"pass for the {side} flank", color="black", font_size=12)
        look_into_slot(plotter, data["view:centre"], data, 108.0)
    plotter.screenshot(str(file))


def draw_envelopes(data: dict[str, NDArray], surfaces: dict[str, Any], file: Path) -> None:
    """Both branches of the cutter flank's untrimmed envelope, one view a pass."""
    plotter = plotter_with(views=2)
    for view, side in enumerate(("convex", "concave")):
        plotter.subplot(0, view)
        _add_slot(plotter, surfaces, without=side)
        for branch in ("plus", "minus"):
            points = data[f"envelope:{side}:{branch}"]
            points = points[:, : max(2, int(0.45 * points.shape[1]))]
            mesh = quads(points, {})
            plotter.add_mesh(mesh, color=COLOURS[side], opacity=0.6, smooth_shading=True)
            plotter.add_mesh(mesh.extract_feature_edges(60.0), color="black", line_width=2)
        plotter.add_text(f"envelope of the {side} flank's pass", color="black", font_size=12)
        look_into_slot(plotter, data["view:centre"], data, 88.0)
    plotter.screenshot(str(file))
