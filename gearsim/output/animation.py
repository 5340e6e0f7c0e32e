"""A sequence of shapes as an animated WebP: the cut as it goes on, under one look and one scale of colours."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.output.canvas import Canvas, add_map, add_mesh
from gearsim.output.colours import class_colours, shades
from gearsim.output.meshes import mesh
from gearsim.output.shapes import Classes, Shape, Values
from gearsim.output.view import FOOT, add_colours, add_legend, aim

_SIZE = (900, 640)  # pixels
_LIGHT: dict[str, Any] = {"ambient": 0.5, "diffuse": 0.5}


class Frame(NamedTuple):
    """What is seen for a while, and a line of text above it: the operation, the time."""

    shapes: Sequence[Shape]
    text: str


def write_animation(
    frames: Iterable[Frame], file: Path, colouring: str = "", way: ArrayLike = (0.6, -0.6, 0.5),
    up: ArrayLike = (0.0, 0.0, 1.0), frame_s: float = 0.1, last_s: float = 2.0,
) -> int:  # fmt: skip
    """Write frames as an animated WebP that begins anew at its end; returns their number.

    Shapes are coloured by the colouring of that name, those that lack it plain. The look is that onto all of the first
    frame's points, where a stock is whole. A frame stays ``frame_s`` seconds, the last ``last_s``. Raises ValueError
    where there are no frames.
    """
    from PIL import Image

    canvas, pictures, seen = Canvas(), [], np.zeros((0, 3))
    for frame in frames:
        seen = seen if len(seen) else np.concatenate([shape.points for shape in frame.shapes])
        pictures.append(Image.fromarray(np.ascontiguousarray(_picture(canvas, frame, colouring, seen, way, up))))
    if not pictures:
        raise ValueError(f"{file.name}: an animation has at least one frame")
    stays = [round(1e3 * frame_s)] * (len(pictures) - 1) + [round(1e3 * last_s)]
    pictures[0].save(file, "WEBP", save_all=True, append_images=pictures[1:], duration=stays, loop=0, quality=80)
    return len(pictures)


def _picture(
    canvas: Canvas, frame: Frame, colouring: str, seen: NDArray, way: ArrayLike, up: ArrayLike
) -> NDArray:  # fmt: skip
    (view,) = canvas.views(1, size=_SIZE)
    for shape in frame.shapes:
        _add(view, shape, colouring)
    aim(view, seen, way, up, frame.text, _add_key(view, frame.shapes, colouring))
    return canvas.pixels()


def _add(view: Any, shape: Shape, colouring: str) -> None:
    how = shape.colours.get(colouring)
    if isinstance(how, Values):
        coloured = mesh(shape.points, [shape.triangles], values={colouring: how.value})
        add_map(view, coloured, colouring, how.high, low=how.low, palette=how.palette, smooth=shape.smooth, **_LIGHT)
        return
    parts = {shape.plain: shape.triangles}
    if isinstance(how, Classes):
        of_class = np.array(class_colours(how.names))[how.number]
        parts = {colour: shape.triangles[of_class == colour] for colour in np.unique(of_class)}
    for colour, triangles in parts.items():
        if len(triangles):
            add_mesh(view, mesh(shape.points, [triangles]), colour, smooth=shape.smooth, sharp=True, **_LIGHT)


def _add_key(view: Any, shapes: Sequence[Shape], colouring: str) -> float:
    """What the colours are, below; the share of the height that it takes."""
    how = next((shape.colours[colouring] for shape in shapes if colouring in shape.colours), None)
    if how is None:
        return add_legend(view, {shape.name: shape.plain for shape in shapes})
    if isinstance(how, Classes):
        return add_legend(view, dict(zip(how.names, class_colours(how.names), strict=True)))
    if how.low == -how.high:
        add_colours(view, how.high, f"{colouring} [{how.unit}]")
        return FOOT
    named = (f"{colouring} {end:g} {how.unit}" for end in (how.low, how.high))
    return add_legend(view, dict(zip(named, shades(how.palette, 2), strict=True)))
