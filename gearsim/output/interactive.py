"""An interactive 3D view as a part of an HTML page: it turns, zooms, switches colours; no network, no server.

plotly.js draws it (MIT licence, shipped in the plotly package), told by interactive_traces.js, interactive_caps.js and
interactive.js.
A page holds as many views as it likes, each of ``interactive_view``, and ``viewer`` once behind them.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.output.colours import DARK, class_colours, shades
from gearsim.output.shapes import Classes, Colouring, Shape, Values
from gearsim.output.thinning import thinned_together

MOST = 150_000  # triangles in a view: about 5 MB of a page, and what a phone still turns
_WITHOUT = "This view needs JavaScript; the still pictures of this report show the same."


def interactive_view(
    shapes: Sequence[Shape], title: str, notes: Sequence[str] = (), way: ArrayLike = (0.6, -0.6, 0.5),
    up: ArrayLike = (0.0, 0.0, 1.0), most: int = MOST,
) -> str:  # fmt: skip
    """Shapes as HTML: buttons for their colourings, legend, a section plane; first seen against ``way``, ``up`` up.

    Beyond ``most`` triangles they are thinned, and the view says how far. Raises ValueError where there is no triangle,
    and where one colouring has two scales or lists of classes.
    """
    if not any(len(s.triangles) for s in shapes):
        raise ValueError(f"{title}: a view has at least one triangle")
    shown, told = _thinned([s for s in shapes if len(s.triangles)], most)
    scene = {
        "shapes": [_shape(s) for s in shown],
        "colourings": [_legend(name, colouring) for name, colouring in _colourings(shown).items()],
        "missing": DARK, "way": _unit(way), "up": _unit(up),
    }  # fmt: skip
    data = json.dumps(scene).replace("<", "\\u003c")  # no text ends the element
    said = "".join(f"<p>{escape(note)}</p>" for note in (*notes, told, _sections(shown)))
    return (
        f'<section class="gearsim-view"><h2>{escape(title)}</h2><noscript><p>{_WITHOUT}</p></noscript>'
        '<div class="controls"></div><div class="scene"></div><div class="legend"></div>'
        f'<div class="notes">{said}</div><script type="application/json">{data}</script></section>\n'
    )


def viewer() -> str:
    """What makes the views of a page live, once a page, behind them: plotly.js, our scripts and style. 4.8 MB."""
    from plotly.offline import get_plotlyjs

    names = ("interactive.css", "interactive_traces.js", "interactive_caps.js", "interactive.js")
    style, *scripts = (Path(__file__).with_name(name).read_text(encoding="utf-8") for name in names)
    own = '(() => {\n"use strict";\n' + "\n".join(scripts) + "})();"
    return f"<style>{style}</style><script>{get_plotlyjs()}</script><script>{own}</script>\n"


def _thinned(shapes: Sequence[Shape], most: int) -> tuple[list[Shape], str]:
    """Shapes with at most ``most`` triangles in all, the small ones whole, and that in words."""
    total = sum(len(s.triangles) for s in shapes)
    if total <= most:
        return list(shapes), f"{total:,} triangles, coordinates rounded to single precision: to be looked at; {_DATA}."
    groups: dict[str, list[Shape]] = {}
    for k, s in enumerate(shapes):
        groups.setdefault(s.body or str(k), []).append(s)
    share = _share([sum(len(s.triangles) for s in group) for group in groups.values()], most)
    done = [thinned_together(group, share) for group in groups.values()]
    shown, cell = [s for group, _ in done for s in group], max(c for _, c in done)
    left = sum(len(s.triangles) for s in shown)
    return shown, (
        f"Thinned for display from {total:,} to {left:,} triangles: points within cells of {cell:.2g} mm are one, with "
        f"the value farthest from 0 among theirs; {_DATA}."
    )


def _share(sizes: list[int], most: int) -> int:
    """The size that none may exceed for all together to be ``most`` at most."""
    for left, size in enumerate(sorted(sizes)):
        share = most // (len(sizes) - left)
        if size > share:
            return share
        most -= size
    return max(sizes)


def _sections(shapes: Sequence[Shape]) -> str:
    """What a section plane shows of the shapes."""
    bodies = list(dict.fromkeys(s.body for s in shapes if s.body))
    if not bodies:
        return "A section looks into these surfaces: they enclose no material."
    return f"A section fills the cut face of {' and of '.join(bodies)}; other surfaces are cut open."


_DATA = "to be measured are the files beside it"


def _colourings(shapes: Sequence[Shape]) -> dict[str, Colouring]:
    """One colouring of each name; all of one name agree."""
    found: dict[str, Colouring] = {}
    for shape in shapes:
        for name, colouring in shape.colours.items():
            first = found.setdefault(name, colouring)
            if _agreed(first) != _agreed(colouring):
                raise ValueError(f"{shape.name}: its {name} has another scale than that of a shape before it")
    return found


def _agreed(colouring: Colouring) -> tuple[object, ...]:
    return colouring.scale if isinstance(colouring, Values) else colouring.names


def _legend(name: str, colouring: Colouring) -> dict[str, Any]:
    if isinstance(colouring, Values):
        return {"name": name, "low": colouring.low, "high": colouring.high, "unit": colouring.unit,
                "scale": shades(colouring.palette)}  # fmt: skip
    colours = class_colours(colouring.names)
    return {"name": name, "classes": [list(pair) for pair in zip(colouring.names, colours, strict=True)]}


def _shape(shape: Shape) -> dict[str, Any]:
    colours = {
        name: _packed(c.number, "u2") if isinstance(c, Classes) else _packed(c.value, "f4")
        for name, c in shape.colours.items()
    }
    number = "u2" if len(shape.points) < 1 << 16 else "u4"
    return {
        "name": shape.name, "plain": shape.plain, "smooth": shape.smooth, "shown": shape.shown, "body": shape.body,
        "points": _packed(shape.points, "f4"), "triangles": _packed(shape.triangles, number), "colours": colours,
    }  # fmt: skip


def _packed(array: NDArray, kind: str) -> dict[str, str]:
    data = np.ascontiguousarray(array, dtype=f"<{kind}").tobytes()
    return {"type": kind, "data": base64.b64encode(data).decode("ascii")}


def _unit(vector: ArrayLike) -> list[float]:
    v = np.asarray(vector, dtype=float)
    return [float(x) for x in v / np.linalg.norm(v)]
