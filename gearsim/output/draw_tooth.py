"""A gear's slot between its teeth, as it was machined: measured surfaces, sharp edges, the neighbours in steel."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.canvas import Canvas, add_map, add_mesh
from gearsim.output.colours import STEEL
from gearsim.output.draw import onto
from gearsim.output.meshes import joined, points_of, quads
from gearsim.output.slot import from_tip_to_tip, machined, place, seams
from gearsim.output.view import DEVIATION, Look, add_colours, add_name, aim_alike

_NEIGHBOURS = 1
_COLUMNS = 33
_NEAR_END = 0.1  # of the face
_RIM = 0.3  # of the slot's depth: what is shown below it
_LIGHT: dict[str, Any] = {"ambient": 0.35, "diffuse": 0.65}
_PLAIN: dict[str, Any] = {"ambient": 0.55, "diffuse": 0.5}  # colours are to be those of the scale
_ENDS = "#9aa1ab"


def draw_tooth(data: dict[str, NDArray], surfaces: dict[str, Any], canvas: Canvas) -> None:
    """Two views, one onto each flank; colours span the tolerance, what lies beyond has the end's colour."""
    limit = float(data["tooth:limit_um"])
    names = [str(name) for name in data["tooth:names"]]
    slot = joined(surfaces[name] for name in names)
    body, ends = tooth_body(data, names)
    points = np.concatenate([points_of(shape) for shape in (slot, body, ends)])
    looks = []
    for view, shown, other in zip(canvas.views(2), (names[0], names[-1]), (names[-1], names[0]), strict=True):
        add_mesh(view, body, STEEL, smooth=True, sharp=True, **_LIGHT)
        add_mesh(view, ends, _ENDS, **_LIGHT)
        add_map(view, slot, "deviation_um", limit, **_PLAIN)
        for name, along in ((f"{shown} flank", 0.5), ("toe", _NEAR_END), ("heel", 1.0 - _NEAR_END)):
            add_name(view, place(data, shown, along), name)
        add_colours(view, limit, DEVIATION)
        text = f"onto the {shown} flank; neighbours in grey; {data['tooth:span']}"
        looks.append(Look(view, points, *onto(data, shown, other), text))
    aim_alike(looks)


def tooth_arrays(names: list[str], teeth: int, limit_um: float, span: str) -> dict[str, NDArray]:
    """What this picture wants beside the patches: their names from tip to tip, the teeth, the colours' limit."""
    return {
        "tooth:names": np.array(names), "tooth:teeth": np.array(teeth), "tooth:limit_um": np.array(limit_um),
        "tooth:span": np.array(span),
    }  # fmt: skip


def tooth_body(data: dict[str, NDArray], names: list[str]) -> tuple[Any, Any]:
    """The neighbouring slots, the lands between all and the seams of the slot in the middle; the ends of the teeth.

    With the slot in the middle they enclose the teeth and a rim below them.
    """
    slot = np.concatenate(from_tip_to_tip([_coarse(data[f"patch:{name}:point"]) for name in names]))
    between = seams(from_tip_to_tip([machined(data, name) for name in names]))
    pitch = 2.0 * np.pi / float(data["tooth:teeth"])
    pitch *= min((1.0, -1.0), key=lambda s: float(np.nansum((_turned(slot[0], s * pitch) - slot[-1]) ** 2)))
    slots = [_turned(slot, k * pitch) for k in range(-_NEIGHBOURS, _NEIGHBOURS + 1)]
    middle, n = slots[_NEIGHBOURS], _NEIGHBOURS
    before, after = np.concatenate([*slots[:n], middle[:1]]), np.concatenate([middle[-1:], *slots[n + 1 :]])
    whole = np.concatenate(slots)
    base = _base(whole, data["view:centre"], data["view:up"])
    walls = (np.stack([whole[k], base[k]]) for k in (0, -1))
    faces = (*(np.stack([whole[:, k], base[:, k]]) for k in (0, -1)), base)
    return joined([quads(before), quads(after), *between, *map(quads, walls)]), joined(map(quads, faces))


def _coarse(points: NDArray) -> NDArray:
    """A patch with no more columns than make its edges look smooth."""
    columns = points.shape[1]
    return points[:, np.unique(np.round(np.linspace(0, columns - 1, min(columns, _COLUMNS))).astype(int))]


def _base(points: NDArray, centre: NDArray, up: NDArray) -> NDArray:
    """Points (rows, columns, 3) moved down to a rim below the deepest of their column; ``up`` is up at the centre."""
    out = centre[:2] / np.linalg.norm(centre[:2])
    radial, axial = float(up[:2] @ out), float(up[2])
    radius = np.linalg.norm(points[..., :2], axis=-1)
    height = radial * radius + axial * points[..., 2]
    level = np.nanmin(height, axis=0) - _RIM * (np.nanmax(height, axis=0) - np.nanmin(height, axis=0))
    way = np.concatenate([radial * points[..., :2] / radius[..., None], np.full((*radius.shape, 1), axial)], axis=-1)
    return np.asarray(points + (level - height)[..., None] * way)


def _turned(points: NDArray, angle: float) -> NDArray:
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
