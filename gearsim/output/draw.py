"""3D pictures: meshes of measured patches, blanks, toolpaths, envelopes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.canvas import Canvas, add_mesh
from gearsim.output.colours import DARK, STEEL
from gearsim.output.meshes import joined, mesh, points_of, quads, run, segments
from gearsim.output.slot import from_tip_to_tip, machined, place, seams
from gearsim.output.view import Look, add_legend, add_name, aim, aim_alike

COLOURS = {"convex": "#e09f3e", "concave": "#4f8f79"}  # of passes; not those of overcut and excess
_SIDES = (("convex", "concave"), ("concave", "convex"))
_MATE = "#d8b26e"
_ANGLES = 241  # of a blank: so many ends of its faces
_LIGHT: dict[str, Any] = {"ambient": 0.35, "diffuse": 0.65}
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
        out[name] = quads(machined(data, name), values)
    return out


def _turned(polygon: NDArray, start: float, end: float) -> Any:
    """A polygon (radius, z) turned about z from one angle to another [deg], with its end faces."""
    angles = np.radians(np.linspace(start, end, _ANGLES))
    ring = np.vstack([polygon, polygon[:1]])
    x, y = (np.outer(f(angles), ring[:, 0]) for f in (np.cos, np.sin))
    points = np.stack([x, y, np.tile(ring[:, 1], (len(angles), 1))], axis=-1)
    face = np.arange(len(polygon))[None]
    return joined([quads(points), *(mesh(points[i, :-1], [face]) for i in (0, -1))])


def draw_blanks(data: dict[str, NDArray], _: dict[str, Any], canvas: Canvas) -> None:
    """The part's blank and its mate's in mesh, a part of the first cut away."""
    (view,) = canvas.views()
    part = _turned(data["part:polygon"], -150.0, 150.0)
    mate = _turned(data["mate:polygon"], 0.0, 360.0)
    x, y, z = points_of(mate).T.copy()
    points_of(mate)[:] = np.column_stack([z, y, -x])  # its axis along x
    add_mesh(view, part, STEEL, smooth=True, sharp=True)
    add_mesh(view, mate, _MATE, smooth=True, sharp=True)
    add_legend(view, {"the part's blank": STEEL, "its mate's": _MATE})
    points = np.concatenate([points_of(part), points_of(mate)])
    aim(view, points, (-160.0, -200.0, -212.0), (0.0, 0.0, -1.0), "blanks in mesh, a part cut away")


def _add_slot(view: Any, data: dict[str, NDArray], surfaces: dict[str, Any], without: str = "") -> NDArray:
    """The slot in steel, with what lies between its patches; its points."""
    slot = joined(s for name, s in surfaces.items() if name != without)
    add_mesh(view, slot, STEEL, smooth=True, **_LIGHT)
    if "tooth:names" in data:
        patches = from_tip_to_tip([machined(data, str(name)) for name in data["tooth:names"] if name != without])
        add_mesh(view, joined(seams(patches)), STEEL, smooth=True, **_LIGHT)
    return points_of(slot)


def into_slot(data: dict[str, NDArray]) -> tuple[NDArray, NDArray]:
    """The way to an eye above the slot, a little from the heel and from the side; and up."""
    up = data["view:up"]
    along = data["view:along"] - (data["view:along"] @ up) * up
    along /= np.linalg.norm(along)
    return 0.85 * up + 0.75 * along + 0.25 * np.cross(up, along), up


def onto(data: dict[str, NDArray], flank: str, other: str) -> tuple[NDArray, NDArray]:
    """The way to an eye that looks onto a flank, from the heel, from above and from the other flank's side; and up."""
    up = data["view:up"]
    along = data["view:along"] - (data["view:along"] @ up) * up
    along = along / np.linalg.norm(along)
    across = place(data, other) - place(data, flank)
    across = across - (across @ up) * up - (across @ along) * along
    across = across / max(float(np.linalg.norm(across)), 1e-12)
    return 0.62 * up + 0.45 * along + 0.64 * across, up


def draw_toolpaths(data: dict[str, NDArray], surfaces: dict[str, Any], canvas: Canvas) -> None:
    """Tool axes and tip curves of both passes in the slot, side by side."""
    length, looks = 0.6 * float(data["cutter:height"]), []
    for view, (side, other) in zip(canvas.views(2), _SIDES, strict=True):
        slot = _add_slot(view, data, surfaces)
        tip, axis = data[f"path:{side}:tip"], data[f"path:{side}:axis"]
        add_mesh(view, segments(tip[:-1], tip[1:]), DARK, width=4.0)
        add_mesh(view, segments(tip, tip + length * axis), COLOURS[side], width=3.0)
        axes = f"{len(tip)} tool axes, {length:.3g} mm from the tip"
        add_legend(view, {axes: COLOURS[side], "path of the tool's tip": DARK, "machined slot": STEEL})
        _name_flank(view, data, side)
        points = np.concatenate([slot, tip, tip + length * axis])
        looks.append(Look(view, points, *onto(data, side, other), f"pass for the {side} flank"))
    aim_alike(looks)


def draw_envelopes(data: dict[str, NDArray], surfaces: dict[str, Any], canvas: Canvas) -> None:
    """Both branches of the cutter flank's untrimmed envelope, one view a pass."""
    looks = []
    for view, (side, other) in zip(canvas.views(2), _SIDES, strict=True):
        shown = [_add_slot(view, data, surfaces, without=side)]
        for branch in ("plus", "minus"):
            points = data[f"envelope:{side}:{branch}"]
            points = points[:, : max(2, int(_LOWER * points.shape[1]))]
            sheet = quads(points)
            add_mesh(view, sheet, COLOURS[side], opacity=0.6, smooth=True, ambient=0.3)
            add_mesh(view, _edges(sheet), DARK, width=2.0)
            shown.append(points.reshape(-1, 3))
        envelope = f"the envelope's lower {100.0 * _LOWER:.0f} %"
        add_legend(view, {envelope: COLOURS[side], "its border": DARK, "the slot's other surfaces": STEEL})
        _name_flank(view, data, side)
        text = f"envelope of the {side} flank's pass, both branches"
        looks.append(Look(view, np.concatenate(shown), *onto(data, side, other), text))
    aim_alike(looks)


def _name_flank(view: Any, data: dict[str, NDArray], name: str) -> None:
    """A flank's name on it, and its ends'."""
    for text, along in ((f"{name} flank", 0.5), ("toe", 0.06), ("heel", 0.94)):
        add_name(view, place(data, name, along), text)


def _edges(sheet: Any) -> Any:
    """A sheet's border, and where it folds."""
    from vtkmodules.vtkFiltersCore import vtkFeatureEdges

    edges = vtkFeatureEdges()
    edges.SetInputData(sheet)
    edges.SetFeatureAngle(60.0)
    edges.ColoringOff()
    return run(edges)
