"""Views of 3D pictures: a parallel projection that shows everything, a scale bar in mm, a legend."""

from __future__ import annotations

from collections.abc import Mapping
from textwrap import wrap
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.output.colours import DIVERGING
from gearsim.output.rounding import round_below

STEEL = "#b8bec6"
DEVIATION = "deviation [um], + material left"
_SIZE = (1300, 780)
_SAMPLES = 4  # a pixel: edges look smooth, and a processor has less to draw than for the usual 8
_ROOM = 1.12  # about what is seen
_FOOT = 0.16  # of the view's height, for legend, scales and bars
_HEAD = 0.08  # of the view's height, for the text
_SCALE = 0.3  # of the view's width, at most
_LEFT, _BASE, _LINE = 0.42, 0.02, 0.038  # of legends and scales, shares of the view
_FONT = 9
_CHARACTER = 9.5  # pixels of a letter, about


def plotter_with(views: int = 1, size: tuple[int, int] = _SIZE) -> Any:
    """A white off-screen scene with views side by side."""
    import pyvista as pv

    plotter = pv.Plotter(off_screen=True, window_size=list(size), shape=(1, views), border=False)
    plotter.set_background("white")
    plotter.render_window.SetMultiSamples(_SAMPLES)
    return plotter


def aim(
    plotter: Any, points: NDArray, way: ArrayLike, up: ArrayLike, text: str, foot: float = _FOOT
) -> None:  # fmt: skip
    """Look at points, shape (n, 3), against ``way``, so that all are in the view; a text above, a scale bar below.

    ``foot`` is the share of the view's height that is kept free below.
    """
    points = points.reshape(-1, 3)
    points = points[np.isfinite(points).all(axis=1)]
    toward, right, top = _frame(np.asarray(way, dtype=float), np.asarray(up, dtype=float))
    across, along = points @ right, points @ top
    width, height = plotter.renderer.GetSize()
    aspect, free = width / height, 1.0 - foot - _HEAD
    half = 0.5 * _ROOM * max(float(np.ptp(along)) / free, float(np.ptp(across)) / aspect, 1e-9)
    middle = 0.5 * (along.min() + along.max()) - half * (foot - _HEAD)
    far = 2.0 * float(np.linalg.norm(np.ptp(points, axis=0)))
    focus = right * 0.5 * (across.min() + across.max()) + top * middle + toward * float(np.mean(points @ toward))
    plotter.camera_position = [tuple(focus + far * toward), tuple(focus), tuple(top)]
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = half
    _add_scale(plotter, 2.0 * half * aspect)
    for line, told in enumerate(wrap(text, round(width / _CHARACTER))):
        _add_text(plotter, 0.02, 1.0 - _LINE * (line + 0.85), told)


def add_legend(plotter: Any, entries: Mapping[str, str]) -> float:
    """What the view's colours are, at its lower right; returns the share of the height that is to be kept free."""
    from matplotlib.colors import to_rgb

    heights = _BASE + _LINE * np.arange(len(entries))[::-1]
    boxes = np.column_stack([0.0 * heights + _LEFT, heights, 0.0 * heights + _LEFT + 0.025, heights + 0.55 * _LINE])
    _add_boxes(plotter, boxes, np.array([to_rgb(colour) for colour in entries.values()]))
    for height, text in zip(heights, entries, strict=True):
        _add_text(plotter, _LEFT + 0.035, height, text)
    return max(_FOOT, _BASE + _LINE * (len(entries) + 0.5))


def add_colours(plotter: Any, limit: float, title: str) -> None:
    """The scale of deviations from -``limit`` to ``limit``, at the lower right, with its ``title``."""
    from matplotlib import colormaps

    x = np.linspace(_LEFT, 0.94, 65)
    boxes = np.column_stack([x[:-1], np.full(64, _BASE + _LINE), x[1:], np.full(64, _BASE + 1.8 * _LINE)])
    _add_boxes(plotter, boxes, colormaps[DIVERGING](np.linspace(0.0, 1.0, 64))[:, :3])
    for value, at in ((-limit, x[0]), (0.0, x[32]), (limit, x[-1])):
        _add_text(plotter, at, _BASE, f"{value:+.3g}" if value else "0", centred=True)
    _add_text(plotter, _LEFT, _BASE + 2.2 * _LINE, title)


def segments(starts: NDArray, ends: NDArray) -> Any:
    """One mesh of straight lines from points to points, both shape (n, 3)."""
    import pyvista as pv

    n = len(starts)
    lines = np.column_stack([np.full(n, 2), np.arange(n), n + np.arange(n)])
    return pv.PolyData(np.concatenate([starts, ends]), lines=lines.ravel())


def _frame(way: NDArray, up: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Unit vectors toward the eye, to the right and to the top of the picture."""
    toward = way / np.linalg.norm(way)
    right = np.cross(up, toward)
    right = right / np.linalg.norm(right)
    return toward, right, np.cross(toward, right)


def _add_scale(plotter: Any, across: float) -> None:
    """A bar of a round length of a view that is ``across`` [mm] wide, at its lower left."""
    length = round_below(_SCALE * across)
    share, thick = length / across, 0.12 * _LINE
    ends = [[0.03 + x, _BASE, 0.03 + x + 0.003, _BASE + 0.4 * _LINE] for x in (0.0, share)]
    _add_boxes(plotter, np.array([[0.03, _BASE, 0.03 + share, _BASE + thick], *ends]), np.zeros((3, 3)))
    _add_text(plotter, 0.03 + 0.5 * share, _BASE + 0.6 * _LINE, f"{length:g} mm", centred=True)


def _add_boxes(plotter: Any, boxes: NDArray, colours: NDArray) -> None:
    """Flat boxes (left, bottom, right, top), shares of the view, shape (n, 4), in colours (n, 3) from 0 to 1."""
    import pyvista as pv
    from vtkmodules.vtkRenderingCore import vtkActor2D, vtkCoordinate, vtkPolyDataMapper2D

    n = len(boxes)
    corners = np.zeros((n, 4, 3))
    corners[..., :2] = boxes[:, [[0, 1], [2, 1], [2, 3], [0, 3]]]
    mesh = pv.PolyData(corners.reshape(-1, 3), np.column_stack([np.full(n, 4), np.arange(4 * n).reshape(n, 4)]).ravel())
    mesh.cell_data["colour"] = np.round(255.0 * colours).astype(np.uint8)
    mesh.set_active_scalars("colour", preference="cell")
    mapper, place, actor = vtkPolyDataMapper2D(), vtkCoordinate(), vtkActor2D()
    place.SetCoordinateSystemToNormalizedViewport()
    mapper.SetInputData(mesh)
    mapper.SetTransformCoordinate(place)
    actor.SetMapper(mapper)
    plotter.renderer.AddViewProp(actor)


def _add_text(plotter: Any, x: float, y: float, text: str, centred: bool = False) -> None:
    actor = plotter.add_text(text, position=(x, y), viewport=True, color="black", font_size=_FONT)
    if centred:
        actor.prop.justification_horizontal = "center"
