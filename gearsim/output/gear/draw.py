"""gear.png; runs in the drawing process."""

from __future__ import annotations

from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.canvas import Canvas, add_map, add_mesh
from gearsim.output.draw_swept import tool_skin
from gearsim.output.gear.style import NOISE_UM, unit_for
from gearsim.output.meshes import joined, mesh, points_of, quads, run
from gearsim.output.view import DEVIATION, STEEL, add_colours, add_legend, aim

_TURN = np.radians(2.0)
_LIFT = 0.03  # mm out of the tri-dexel's surface, so that the measured flanks are not drawn inside it
_TOOL = "#d8b26e"
_LIGHT: dict[str, Any] = {"ambient": 0.35, "diffuse": 0.65}
_ROUND: dict[str, Any] = {**_LIGHT, "smooth": True, "sharp": True}


def draw_gear(data: dict[str, NDArray], surfaces: dict[str, Any], canvas: Canvas) -> None:
    """The whole gear with the tool in space 0; space 0 with its measured flanks, seen onto each of them."""
    whole, *spaces = canvas.views(3, size=(1650, 640))
    skin, ends = _gear_body(data)
    tool = tool_skin(data["gear:profile"], data["gear:tip"], data["gear:axis"])
    add_mesh(whole, skin, STEEL, **_ROUND)
    add_mesh(whole, ends, STEEL, **_LIGHT)
    add_mesh(whole, tool, _TOOL, **_ROUND)
    add_legend(whole, {"the gear": STEEL, "the tool": _TOOL})
    carried = "helix" if data["gear:twist"] else "axis"
    text = f"the section as cut, carried along the {carried}, and the tool"
    aim(whole, np.concatenate([points_of(skin), points_of(tool)]), *_ways(data), text)
    body = _space_body(data)
    for view, name in zip(spaces, surfaces, strict=True):
        _add_space(view, body, data, surfaces, name)


def _add_space(view: Any, body: Any, data: dict[str, NDArray], surfaces: dict[str, Any], seen: str) -> None:
    """Space 0 as its tri-dexel shows it, the measured flanks laid on it and coloured by their deviation."""
    add_mesh(view, body, STEEL, **_ROUND)
    um = np.concatenate([data[key].ravel() for key in data if key.endswith(":deviation_um")])
    unit = unit_for(um)
    limit = unit.per_um * max(float(np.nanmax(np.abs(um), initial=0.0)), NOISE_UM)
    for name in surfaces:
        points = data[f"patch:{name}:point"] + _LIFT * data[f"patch:{name}:normal"]
        lifted = quads(points, {"shown": unit.per_um * data[f"patch:{name}:deviation_um"]})
        add_map(view, lifted, "shown", limit, ambient=0.4, diffuse=0.6)
    add_colours(view, limit, DEVIATION.replace("um", unit.name.replace("µ", "u")))
    normal = np.nanmean(data[f"patch:{seen}:normal"].reshape(-1, 3), axis=0)
    open_side = np.array([float(data["gear:sign"]), 0.0, 0.0])
    way = open_side + 0.6 * normal / np.linalg.norm(normal) + np.array([0.0, 0.0, 0.6])
    text = f"space 1 (tri-dexel), onto its {seen} flank"
    aim(view, points_of(body), way, (0.0, 0.0, 1.0), text)


def _space_body(data: dict[str, NDArray]) -> Any:
    """The tri-dexel's surface between both faces of the gear."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPlane, vtkPlaneCollection
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D
    from vtkmodules.vtkFiltersGeneral import vtkClipClosedSurface

    grid, surface, clip, faces = vtkImageData(), vtkFlyingEdges3D(), vtkClipClosedSurface(), vtkPlaneCollection()
    grid.SetDimensions(data["body:field"].shape)
    grid.SetSpacing(*map(float, data["body:step"]))
    grid.SetOrigin(*map(float, data["body:origin"]))
    grid.GetPointData().SetScalars(numpy_to_vtk(data["body:field"].ravel(order="F"), deep=True))
    surface.SetInputData(grid)
    surface.SetValue(0, 0.0)
    surface.ComputeNormalsOff()
    surface.ComputeScalarsOff()
    for z, way in ((-float(data["gear:facewidth"]), 1.0), (0.0, -1.0)):
        plane = vtkPlane()
        plane.SetOrigin(0.0, 0.0, z)
        plane.SetNormal(0.0, 0.0, way)
        faces.AddItem(plane)
    clip.SetInputConnection(surface.GetOutputPort())
    clip.SetClippingPlanes(faces)
    return run(clip)


def _ways(data: dict[str, NDArray]) -> tuple[NDArray, tuple[float, float, float]]:
    """The way to an eye above and where space 0 opens, a little from the side; and up."""
    return np.array([0.62 * float(data["gear:sign"]), -0.35, 0.7]), (0.0, 0.0, 1.0)


def _gear_body(data: dict[str, NDArray]) -> tuple[Any, Any]:
    """The section between the faces, turned along the helix: the skin and both faces."""
    inner, border, edge = _face(data)
    levels = np.linspace(0.0, -float(data["gear:facewidth"]), _levels(data))
    points, n = points_of(edge), edge.GetNumberOfPoints()
    lines = _corners(edge.GetLines(), 2)
    upper = (np.arange(len(levels) - 1)[:, None, None] * n + lines).reshape(-1, 2)
    strips = np.column_stack([upper, upper[:, ::-1] + n])
    skin = mesh(np.concatenate([_at(points, z, data) for z in levels]), [strips])
    ends = []
    for z in levels[[0, -1]]:
        ends.append(mesh(_at(inner, z, data), [np.arange(len(inner)).reshape(-1, 4)]))
        ends.append(_moved(border, _at(points_of(border), z, data)))
    return skin, joined(ends)


def _corners(cells: Any, each: int) -> NDArray:
    """Point numbers of cells that have as many corners each."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    return np.asarray(vtk_to_numpy(cells.GetConnectivityArray())).reshape(-1, each)


def _moved(shape: Any, points: NDArray) -> Any:
    """A mesh with its points elsewhere."""
    out = mesh(points)
    out.SetPolys(shape.GetPolys())
    return out


def _levels(data: dict[str, NDArray]) -> int:
    """Rings of the skin: one for every few degrees that the helix turns."""
    turn = abs(float(data["gear:twist"]) * float(data["gear:facewidth"]))
    return 2 + ceil(turn / _TURN)


def _face(data: dict[str, NDArray]) -> tuple[NDArray, Any, Any]:
    """The section where the share of material is over a half: corners of quads, shape (4 n, 3), a
    mesh of what the border cuts, and the border's lines.

    Cells that are whole are joined along their rows: a face has some thousands of polygons, not some hundred thousands.
    """
    x, y, share = (data[f"section:{name}"] for name in ("x", "y", "share"))
    inside = share > 0.5
    corners = np.stack([inside[:-1, :-1], inside[1:, :-1], inside[1:, 1:], inside[:-1, 1:]])
    whole = np.asarray(corners.all(axis=0))
    cut = np.asarray(corners.any(axis=0)) & ~whole
    steps = np.diff(np.pad(whole, ((0, 0), (1, 1))).astype(int), axis=1)
    (row, first), (_, last) = np.nonzero(steps == 1), np.nonzero(steps == -1)
    runs = np.stack([x[first], y[row], x[last], y[row], x[last], y[row + 1], x[first], y[row + 1]], axis=1)
    inner = np.column_stack([runs.reshape(-1, 2), np.zeros(4 * len(row))])
    return inner, *_border(x, y, share, cut)


def _border(x: NDArray, y: NDArray, share: NDArray, cut: NDArray) -> tuple[Any, Any]:
    """What of the cells that the border cuts is inside, and the border's lines."""
    from vtkmodules.vtkFiltersCore import vtkClipPolyData, vtkContourFilter

    row, column = np.nonzero(cut)
    corner = row * len(x) + column
    faces = np.stack([corner, corner + 1, corner + 1 + len(x), corner + len(x)], axis=1)
    points = np.stack([*np.meshgrid(x, y), np.zeros(share.shape)], axis=-1).reshape(-1, 3)
    used, faces = np.unique(faces, return_inverse=True)
    cells = mesh(points[used], [faces.reshape(-1, 4)], values={"share": share.ravel()[used]})
    cells.GetPointData().SetActiveScalars("share")
    inside, border = vtkClipPolyData(), vtkContourFilter()
    inside.SetValue(0.5)
    border.SetValue(0, 0.5)
    for made in (inside, border):
        made.SetInputData(cells)
    return run(inside), run(border)


def _at(points: NDArray, z: float, data: dict[str, NDArray]) -> NDArray:
    """The section's points carried along the helix to height z."""
    turn = float(data["gear:twist"]) * (z - float(data["section:z"]))
    x, y = points[:, 0], points[:, 1]
    cos, sin = np.cos(turn), np.sin(turn)
    return np.column_stack([cos * x - sin * y, sin * x + cos * y, np.full(len(points), z)])
