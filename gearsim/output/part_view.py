"""The interactive view of a part: its measured surfaces in their colours, the steel around them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.output.canvas import with_normals
from gearsim.output.draw import into_slot
from gearsim.output.draw_tooth import tooth_body
from gearsim.output.gear.draw import LIFT, gear_body, gear_limit, gear_ways
from gearsim.output.interactive import interactive_view
from gearsim.output.meshes import points_of, triangles_of, values_of
from gearsim.output.shapes import Shape, Values
from gearsim.output.whole_part import looked_at, whole_shapes

DEVIATION = "deviation"
_SEGMENT = "segment"  # of the program
_TEETH = "the teeth"
_SIGN = "Deviation along the outward normal of the intended surface: positive is material left, negative is overcut."


def part_view(data: dict[str, NDArray], surfaces: dict[str, Any]) -> str:
    """The arrays of the 3D pictures, and the machined patches made of them, as an interactive view in HTML.

    Nothing where no patch has a face.
    """
    surfaces = {name: mesh for name, mesh in surfaces.items() if mesh.GetNumberOfPolys()}
    whole = whole_shapes(data) if "whole:points" in data else []
    if not surfaces:
        return interactive_view(whole, "The part in 3D", [_SIGN], *looked_at(data)) if whole else ""
    um = np.concatenate([values_of(mesh, "deviation_um") for mesh in surfaces.values()])
    limit, span = colour_limit(data, um)
    lift = LIFT if "section:edges" in data else 0.0
    closing = _TEETH if "tooth:names" in data else ""  # they are the skin of the slot between
    patches = [replace(shape, body=closing) for shape in patch_shapes(surfaces, limit, lift)]
    shapes = [*patches, *_body(data)]
    if any(key.startswith("gouge:") for key in data):  # one surface, under one tool after the other
        shapes = [replace(shape, shown=shape is shapes[0]) for shape in shapes]
    if whole:  # the patches lie in it, and are shown when they are asked for
        shapes = [*whole, *(replace(shape, shown=False) for shape in shapes)]
    way, up = looked_at(data) if whole else _first_look(data, surfaces)
    return interactive_view(shapes, "The part in 3D", [f"{_SIGN} {span[:1].upper()}{span[1:]}."], way, up)


def colour_limit(data: dict[str, NDArray], um: NDArray) -> tuple[float, str]:
    """Where the colours of deviations ``um`` end, and that in words: a tolerance, or else their size."""
    if "tooth:limit_um" in data:
        return float(data["tooth:limit_um"]), str(data["tooth:span"])
    if "whole:limit_um" in data:
        limit = float(data["whole:limit_um"])
        return limit, f"colours span the tolerance, {limit:.3g} um either way"
    return gear_limit({"gear:tolerance_um": np.array(np.inf), **data}, um)


def patch_shapes(surfaces: dict[str, Any], limit_um: float, lift: float = 0.0) -> list[Shape]:
    """Meshes of machined patches as shapes, coloured by deviation up to a limit and by the program's segments.

    ``lift`` [mm] out of the surface, where a body around them has the same skin.
    """
    segments = {name: values_of(mesh, "segment").astype(float) for name, mesh in surfaces.items()}
    last = max(float(s.max(initial=1.0)) for s in segments.values())
    shapes: list[Shape] = []
    for name, mesh in surfaces.items():
        segment = np.where(segments[name] < 0.0, np.nan, segments[name])
        colours = {
            DEVIATION: Values(values_of(mesh, "deviation_um"), -limit_um, limit_um, "µm"),
            _SEGMENT: Values(segment, 0.0, last, "row of the program", "sequential"),
        }
        points = points_of(mesh) + lift * values_of(mesh, "intended_normal")
        shapes.append(Shape(name, points, triangles_of(mesh), colours))
    return shapes


def _body(data: dict[str, NDArray]) -> list[Shape]:
    """What stands around the measured surfaces, in steel."""
    if "tooth:names" in data:
        around, ends = tooth_body(data, [str(name) for name in data["tooth:names"]])
        parts = {"neighbouring teeth": with_normals(around, True), "ends": ends}
        body = _TEETH
    elif "section:edges" in data:
        parts = dict(zip(("gear", "faces"), gear_body(data, "section"), strict=True))
        body = "the gear"
    else:
        return []
    return [Shape(name, points_of(mesh), triangles_of(mesh), body=body) for name, mesh in parts.items()]


def _first_look(data: dict[str, NDArray], surfaces: dict[str, Any]) -> tuple[ArrayLike, ArrayLike]:
    """The way to the eye, and up: those of the still pictures, or onto the first surface."""
    if "tooth:names" in data:
        return into_slot(data)
    if "section:edges" in data:
        return gear_ways(data)
    normal = data[f"patch:{next(iter(surfaces))}:normal"].reshape(-1, 3)
    way = np.nanmean(normal, axis=0) + np.array([0.2, -0.2, 0.3])
    return way, (0.0, 1.0, 0.0) if abs(way[2]) > 0.9 * np.linalg.norm(way) else (0.0, 0.0, 1.0)
