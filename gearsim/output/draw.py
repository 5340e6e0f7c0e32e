"""3D pictures with PyVista: meshes of measured patches, blanks, toolpaths, envelopes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.view import STEEL, add_legend, aim, plotter_with, segments

COLOURS = {"convex": "#e09f3e", "concave": "#4f8f79"}  # of passes; not those of overcut and excess
_MATE = "#d8b26e"
_LOWER = 0.45  # of the envelope, so that the slot is seen


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
    """The part's blank and its mate's in mesh, a part of the first cut away."""
    plotter = plotter_with()
    shade = {"smooth_shading": True, "split_sharp_edges": True}
    part = _turned(data["part:polygon"], -150.0, 150.0)
    mate = _turned(data["mate:polygon"], 0.0, 360.0).rotate_y(90.0, inplace=False)
    plotter.add_mesh(part, color=STEEL, **shade)
    plotter.add_mesh(mate, color=_MATE, **shade)
    add_legend(plotter, {"the part's blank": STEEL, "its mate's": _MATE})
    points = np.concatenate([part.points, mate.points])
    aim(plotter, points, (-160.0, -200.0, -212.0), (0.0, 0.0, -1.0), "blanks in mesh, a part cut away")
    plotter.screenshot(str(file))


def _add_slot(plotter: Any, surfaces: dict[str, Any], without: str = "") -> NDArray:
    """The slot in steel; its points."""
    import pyvista as pv

    slot = pv.merge([s for name, s in surfaces.items() if name != without], merge_points=False)
    plotter.add_mesh(slot, color=STEEL, smooth_shading=True, ambient=0.3)
    return np.asarray(slot.points)


def into_slot(data: dict[str, NDArray]) -> tuple[NDArray, NDArray]:
    """The way to an eye above the slot, a little from the heel and from the side; and up."""
    up = data["view:up"]
    along = data["view:along"] - (data["view:along"] @ up) * up
    along /= np.linalg.norm(along)
    return 0.85 * up + 0.75 * along + 0.25 * np.cross(up, along), up


def draw_toolpaths(data: dict[str, NDArray], surfaces: dict[str, Any], file: Path) -> None:
    """Tool axes and tip curves of both passes in the slot, side by side."""
    import pyvista as pv

    plotter = plotter_with(views=2)
    length = 0.6 * float(data["cutter:height"])
    for view, side in enumerate(("convex", "concave")):
        plotter.subplot(0, view)
        slot = _add_slot(plotter, surfaces)
        tip, axis = data[f"path:{side}:tip"], data[f"path:{side}:axis"]
        plotter.add_mesh(pv.lines_from_points(tip), color="black", line_width=4)
        plotter.add_mesh(segments(tip, tip + length * axis), color=COLOURS[side], line_width=3)
        axes = f"tool axes, {length:.3g} mm from the tip, {len(tip)} places"
        add_legend(plotter, {axes: COLOURS[side], "path of the tool's tip": "black", "machined slot": STEEL})
        points = np.concatenate([slot, tip, tip + length * axis])
        aim(plotter, points, *into_slot(data), f"pass for the {side} flank")
    plotter.screenshot(str(file))


def draw_envelopes(data: dict[str, NDArray], surfaces: dict[str, Any], file: Path) -> None:
    """Both branches of the cutter flank's untrimmed envelope, one view a pass."""
    plotter = plotter_with(views=2)
    for view, side in enumerate(("convex", "concave")):
        plotter.subplot(0, view)
        shown = [_add_slot(plotter, surfaces, without=side)]
        for branch in ("plus", "minus"):
            points = data[f"envelope:{side}:{branch}"]
            points = points[:, : max(2, int(_LOWER * points.shape[1]))]
            mesh = quads(points, {})
            plotter.add_mesh(mesh, color=COLOURS[side], opacity=0.6, smooth_shading=True, ambient=0.3)
            plotter.add_mesh(mesh.extract_feature_edges(60.0), color="black", line_width=2)
            shown.append(points.reshape(-1, 3))
        envelope = f"the envelope's lower {100.0 * _LOWER:.0f} %"
        add_legend(plotter, {envelope: COLOURS[side], "its border": "black", "the slot's other surfaces": STEEL})
        aim(plotter, np.concatenate(shown), *into_slot(data), f"envelope of the {side} flank's pass, both branches")
    plotter.screenshot(str(file))
