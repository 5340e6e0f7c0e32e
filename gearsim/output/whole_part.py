"""The whole part in 3D, as operations left it: a still picture, and a shape for the interactive view."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.canvas import Canvas, add_map, add_mesh
from gearsim.output.colours import BLANK, STEEL, class_colours
from gearsim.output.meshes import mesh
from gearsim.output.shapes import Classes, Colouring, Shape, Values
from gearsim.output.view import DEVIATION, Look, add_colours, add_legend, aim_alike

_WAY = np.array([0.55, -0.6, 0.75])
_GONE = "nothing of the blank is left"
_MOST_NAMES = 8  # of a legend


def whole_shapes(data: dict[str, NDArray]) -> list[Shape]:
    """The part's faces near intended surfaces, and all others, with what they can be coloured by."""
    near = np.isfinite(data["whole:deviation_um"])[data["whole:triangles"]].all(axis=1)
    parts = (("whole part, measured faces", near), ("whole part, other faces", ~near))
    return [_shape(data, name, chosen) for name, chosen in parts if chosen.any()]


def _shape(data: dict[str, NDArray], name: str, chosen: NDArray) -> Shape:
    used, triangles = np.unique(data["whole:triangles"][chosen], return_inverse=True)
    operation = data["whole:operation"][chosen] + 1
    colours: dict[str, Colouring] = {}
    value, limit = data["whole:deviation_um"][used], float(data["whole:limit_um"])
    if np.isfinite(value).all():
        colours["deviation"] = Values(value, -limit, limit, "µm")
    colours["operation"] = Classes(operation, (BLANK, *map(str, data["whole:names"])))
    colours["tool"] = Classes(operation, (BLANK, *map(str, data["whole:tools"])))
    colours["tool mark"] = Classes(_marks(data["whole:tag"][chosen]), (BLANK, *(f"row {k} of ten" for k in range(10))))
    points = data["whole:points"][used]
    return Shape(name, points, triangles.reshape(-1, 3), colours, smooth=False, body="the whole part")


def looked_at(data: dict[str, NDArray]) -> tuple[NDArray, NDArray]:
    """The way to an eye that sees most of what was cut, and up."""
    cut = data["whole:triangles"][data["whole:operation"] >= 0]
    a, b, c = (data["whole:points"][cut[:, k]] for k in range(3))
    above = float(np.cross(b - a, c - a)[:, 2].sum()) >= 0.0 if len(cut) else True
    return seen_from(above)


def seen_from(above: bool) -> tuple[NDArray, NDArray]:
    """The way to an eye above or below, and up."""
    side = np.array([1.0, 1.0, 1.0 if above else -1.0])
    return _WAY * side, np.array([0.0, 0.0, side[2]])


def _marks(tag: NDArray) -> NDArray:
    """Rows that follow each other in different colours, so that marks are seen; 0: the blank."""
    return np.where(tag < 0, 0, 1 + tag % 10)


def draw_whole(data: dict[str, NDArray], _: dict[str, Any], canvas: Canvas) -> None:
    """The whole part by operation, and by deviation where surfaces are intended."""
    left, right = canvas.views(2)
    points, triangles = data["whole:points"], data["whole:triangles"]
    if not len(triangles):
        aim_alike([Look(view, np.eye(3), *looked_at(data), _GONE) for view in (left, right)])
        return
    names, operation = [BLANK, *map(str, data["whole:names"])], data["whole:operation"] + 1
    colours = class_colours(names)
    for k, colour in enumerate(colours):
        own = triangles[operation == k]
        if len(own):
            add_mesh(left, mesh(points, [own]), colour)
    told = dict(zip(names[: _MOST_NAMES + 1], colours, strict=False))
    foot = add_legend(left, told)
    whole = mesh(points, [triangles], values={"deviation_um": data["whole:deviation_um"]})
    limit = float(data["whole:limit_um"])
    add_map(right, whole, "deviation_um", limit, missing=STEEL)
    add_colours(right, limit, DEVIATION)
    more = len(names) - 1 - _MOST_NAMES
    by = "what made each face" + (f"; {more} more operations have the same colours again" if more > 0 else "")
    way, up = looked_at(data)
    aim_alike([
        Look(left, points, way, up, by, foot),
        Look(right, points, way, up, "deviation from the intended surfaces; steel: none is near", foot),
    ])  # fmt: skip
