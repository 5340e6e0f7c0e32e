"""A gear's slot between its teeth, as it was machined: measured surfaces, sharp edges, the neighbours in steel."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.colours import DIVERGING
from gearsim.output.draw import quads
from gearsim.output.view import DEVIATION, STEEL, add_colours, aim, plotter_with

_NEIGHBOURS = 1
_COARSER = 6
_LIGHT = {"ambient": 0.35, "diffuse": 0.65}


def draw_tooth(data: dict[str, NDArray], surfaces: dict[str, Any], file: Path) -> None:
    """Two views, one onto each flank; colours span the tolerance, what lies beyond has the end's colour."""
    limit = float(data["tooth:limit_um"])
    names = [str(name) for name in data["tooth:names"]]
    plotter = plotter_with(views=2)
    body = _body(data, names)
    for view, way in enumerate((1.0, -1.0)):
        plotter.subplot(0, view)
        plotter.add_mesh(body, color=STEEL, **_LIGHT)
        for name in names:
            plotter.add_mesh(
                surfaces[name].copy(), scalars="deviation_um", cmap=DIVERGING, clim=(-limit, limit), nan_color="black",
                show_scalar_bar=False, **_LIGHT,
            )  # fmt: skip
        shown = names[0] if way > 0.0 else names[-1]
        plotter.add_point_labels(
            _middle(data, shown)[None], [shown], font_size=15, text_color="black", shape=None, show_points=False,
            always_visible=True,
        )  # fmt: skip
        add_colours(plotter, limit, DEVIATION)
        points = np.concatenate([body.points, *(surfaces[name].points for name in names)])
        span = str(data["tooth:span"])
        aim(plotter, points, *_ways(data, names, way), f"onto the {shown} flank; neighbours in grey; {span}")
    plotter.screenshot(str(file))


def tooth_arrays(names: list[str], teeth: int, limit_um: float, span: str) -> dict[str, NDArray]:
    """What this picture wants beside the patches: their names from tip to tip, the teeth, the colours' limit."""
    return {
        "tooth:names": np.array(names), "tooth:teeth": np.array(teeth), "tooth:limit_um": np.array(limit_um),
        "tooth:span": np.array(span),
    }  # fmt: skip


def _points(data: dict[str, NDArray], name: str, coarse: bool = True) -> NDArray:
    points = data[f"patch:{name}:point"]
    if not coarse:
        return points
    columns = np.unique(np.append(np.arange(0, points.shape[1], _COARSER), points.shape[1] - 1))
    rows = np.unique(np.append(np.arange(0, points.shape[0], 2), points.shape[0] - 1))
    return points[rows][:, columns]


def _middle(data: dict[str, NDArray], name: str) -> NDArray:
    points = data[f"patch:{name}:point"]
    return points[points.shape[0] // 2, points.shape[1] // 2]


def _body(data: dict[str, NDArray], names: list[str]) -> Any:
    """The neighbouring slots and the lands between all of them."""
    import pyvista as pv

    first, last = (_outer(data, name) for name in (names[0], names[-1]))
    pitch = 2.0 * np.pi / float(data["tooth:teeth"])
    way = min((1.0, -1.0), key=lambda s: float(np.nansum((_turned(first, s * pitch) - last) ** 2)))
    parts = []
    for k in range(-_NEIGHBOURS, _NEIGHBOURS + 1):
        if k:
            parts += [quads(_turned(_points(data, name), k * way * pitch), {}) for name in names]
        if k < _NEIGHBOURS:
            land = np.stack([_turned(last, k * way * pitch), _turned(first, (k + 1) * way * pitch)])
            parts.append(quads(land, {}))
    return pv.merge(parts, merge_points=False)


def _outer(data: dict[str, NDArray], name: str) -> NDArray:
    """The edge of a flank that is farther from the other surfaces: its tip."""
    points = _points(data, name)
    up = data["view:up"]
    return points[-1] if np.nanmean(points[-1] @ up) > np.nanmean(points[0] @ up) else points[0]


def _turned(points: NDArray, angle: float) -> NDArray:
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


def _ways(data: dict[str, NDArray], names: list[str], way: float) -> tuple[NDArray, NDArray]:
    """The way to the eye, from the heel, from above and from the side of the flank not looked at; and up."""
    up = data["view:up"]
    along = data["view:along"] - (data["view:along"] @ up) * up
    along = along / np.linalg.norm(along)
    across = _middle(data, names[-1]) - _middle(data, names[0])
    across = across - (across @ up) * up - (across @ along) * along
    across = across / max(float(np.linalg.norm(across)), 1e-12)
    return 0.62 * up + 0.45 * along + 0.64 * way * across, up
