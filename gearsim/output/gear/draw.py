"""gear.png; runs in the drawing process."""

from __future__ import annotations

from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.canvas import Canvas, add_map, add_mesh, with_normals
from gearsim.output.colours import STEEL
from gearsim.output.draw_swept import tool_skin
from gearsim.output.gear.style import NOISE_UM
from gearsim.output.meshes import joined, mesh, points_of, quads
from gearsim.output.view import DEVIATION, Look, add_colours, add_legend, add_name, aim, aim_alike

_ROOT = "root"
_TURN = np.radians(2.0)
LIFT = 0.03  # mm out of the section's skin, so that the measured flanks are not drawn inside it
_ENDS = "#9aa1ab"
_FACING = 0.25  # cosine of the angle between a named flank's normal and the way to the eye, at least
_TOOL = "#d8b26e"
_LIGHT: dict[str, Any] = {"ambient": 0.35, "diffuse": 0.65}


def draw_gear(data: dict[str, NDArray], surfaces: dict[str, Any], canvas: Canvas) -> None:
    """The whole gear with the tool in space 0; space 0 with its measured surfaces, seen onto each of its flanks.

    One section is cut, at half the facewidth: rays in each plane more would cost a run as much again. What differs
    along the face helix.png and the flanks' colours tell.
    """
    whole, *spaces = canvas.views(3, size=(1650, 640))
    skin, ends = gear_body(data, "section")
    tool = tool_skin(data["gear:profile"], data["gear:tip"], data["gear:axis"])
    add_mesh(whole, skin, STEEL, **_LIGHT)
    add_mesh(whole, ends, STEEL, **_LIGHT)
    add_mesh(whole, tool, _TOOL, smooth=True, sharp=True, **_LIGHT)
    add_legend(whole, {"the gear": STEEL, "the tool": _TOOL})
    carried = "helix" if data["gear:twist"] else "axis"
    where = f"z = {float(data['section:z']):g} mm"
    text = f"the section at {where} as cut, carried along the {carried} to both faces; the tool"
    aim(whole, np.concatenate([points_of(skin), points_of(tool)]), *gear_ways(data), text)
    um = np.concatenate([data[f"patch:{name}:deviation_um"].ravel() for name in surfaces])
    limit, span = gear_limit(data, um)
    body = gear_body(data, "space")
    shown = np.concatenate([points_of(shape) for shape in body])
    looks = []
    for view, name in zip(spaces, (name for name in surfaces if name != _ROOT), strict=True):
        way, up = _onto(data, name)
        _add_space(view, body, data, surfaces, limit, way)
        text = f"space 1, onto its {name} flank; neighbours in grey; {span}"
        looks.append(Look(view, shown, way, up, text))
    aim_alike(looks)


def gear_limit(data: dict[str, NDArray], um: NDArray) -> tuple[float, str]:
    """Where the colours end [um], and that in words: the tolerance, or where there is none the deviations' size."""
    tolerance = float(data["gear:tolerance_um"])
    largest = max(float(np.nanmax(np.abs(um), initial=0.0)), NOISE_UM)
    limit, what = (tolerance, "tolerance") if np.isfinite(tolerance) else (largest, "deviations")
    return limit, f"colours span the {what}, {limit:.3g} um either way"


def _add_space(
    view: Any, body: tuple[Any, Any], data: dict[str, NDArray], surfaces: dict[str, Any], limit: float, way: NDArray
) -> None:  # fmt: skip
    """Space 0 and its neighbours, the measured surfaces on it coloured by their deviation; those seen are named.

    ``way`` to the eye.
    """
    skin, ends = body
    add_mesh(view, skin, STEEL, **_LIGHT)
    add_mesh(view, ends, _ENDS, **_LIGHT)
    for name in surfaces:
        points = data[f"patch:{name}:point"] + LIFT * data[f"patch:{name}:normal"]
        lifted = quads(points, {"deviation_um": data[f"patch:{name}:deviation_um"]})
        add_map(view, lifted, "deviation_um", limit, ambient=0.55, diffuse=0.5)
        if _normal(data, name) @ way > _FACING * np.linalg.norm(way):
            add_name(
                view, points[points.shape[0] // 2, points.shape[1] // 2], name if name == _ROOT else f"{name} flank"
            )
    add_colours(view, limit, DEVIATION)


def _normal(data: dict[str, NDArray], name: str) -> NDArray:
    """A flank's mean normal, a unit vector."""
    mean = np.nanmean(data[f"patch:{name}:normal"].reshape(-1, 3), axis=0)
    return np.asarray(mean / np.linalg.norm(mean))


def _onto(data: dict[str, NDArray], flank: str) -> tuple[NDArray, tuple[float, float, float]]:
    """The way to an eye where the space opens, that looks down onto a flank; and up."""
    open_side = np.array([float(data["gear:sign"]), 0.0, 0.0])
    return open_side + 0.6 * _normal(data, flank) + np.array([0.0, 0.0, 0.6]), (0.0, 0.0, 1.0)


def gear_ways(data: dict[str, NDArray]) -> tuple[NDArray, tuple[float, float, float]]:
    """The way to an eye above and where space 0 opens, a little from the side; and up."""
    return np.array([0.62 * float(data["gear:sign"]), -0.35, 0.7]), (0.0, 0.0, 1.0)


def gear_body(data: dict[str, NDArray], name: str) -> tuple[Any, Any]:
    """Strips of the section between the faces, turned along the helix: the skin and both faces."""
    points, lines = _numbered(data[f"{name}:edges"])
    levels, n = np.linspace(0.0, -float(data["gear:facewidth"]), _levels(data)), len(points)
    upper = (np.arange(len(levels) - 1)[:, None, None] * n + lines).reshape(-1, 2)
    walls = np.column_stack([upper, upper[:, ::-1] + n])
    skin = mesh(np.concatenate([_at(points, z, data) for z in levels]), [walls])
    inner, faces = _numbered(data[f"{name}:quads"])
    return with_normals(skin, True), joined(mesh(_at(inner, z, data), [faces]) for z in levels[[0, -1]])


def _numbered(corners: NDArray) -> tuple[NDArray, NDArray]:
    """Points (n, 2), each once, and their numbers at the corners, shape (cells, corners), of cells (.., .., 2)."""
    points, number = np.unique(np.round(corners.reshape(-1, 2), 9), axis=0, return_inverse=True)
    return points, number.reshape(corners.shape[:2])


def _levels(data: dict[str, NDArray]) -> int:
    """Rings of the skin: one for every few degrees that the helix turns."""
    turn = abs(float(data["gear:twist"]) * float(data["gear:facewidth"]))
    return 2 + ceil(turn / _TURN)


def _at(points: NDArray, z: float, data: dict[str, NDArray]) -> NDArray:
    """The section's points carried along the helix to height z."""
    turn = float(data["gear:twist"]) * (z - float(data["section:z"]))
    x, y = points[:, 0], points[:, 1]
    cos, sin = np.cos(turn), np.sin(turn)
    return np.column_stack([cos * x - sin * y, sin * x + cos * y, np.full(len(points), z)])
