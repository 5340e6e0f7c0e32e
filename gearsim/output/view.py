"""Views of 3D pictures: a parallel projection that shows everything, a scale bar in mm, a legend.

A view is a VTK renderer. Its lengths are shares of its width and height, from its lower left corner.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from textwrap import wrap
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.output.colours import diverging, rgb
from gearsim.output.meshes import mesh
from gearsim.output.rounding import round_below

DEVIATION = "deviation [um], + material left"
_ROOM = 1.12  # about what is seen
FOOT = 0.16  # of the view's height, for legend, scales and bars
_HEAD = 0.08  # of the view's height, for the text
_SCALE = 0.3  # of the view's width, at most
_LEFT, _BASE, _LINE = 0.42, 0.02, 0.038  # of legends and scales
_FONT = 18  # pixels
_CHARACTER = 9.5  # pixels of a letter, about


class Look(NamedTuple):
    """What a view shows: points, shape (n, 3), seen against ``way`` with ``up`` up, a text above, a scale bar below.

    ``foot`` is the share of the view's height that is kept free below.
    """

    view: Any
    points: NDArray
    way: ArrayLike
    up: ArrayLike
    text: str
    foot: float = FOOT


def aim(
    view: Any, points: NDArray, way: ArrayLike, up: ArrayLike, text: str, foot: float = FOOT
) -> None:  # fmt: skip
    """Look at points so that all are in the view; arguments as of Look."""
    aim_alike([Look(view, points, way, up, text, foot)])


def aim_alike(looks: Sequence[Look]) -> None:
    """Look so that all points are in their views, and all views have one scale."""
    half = max(_half(look) for look in looks)
    for look in looks:
        _aim(look, half)


def _seen(look: Look) -> tuple[NDArray, NDArray]:
    """The points that exist along the frame's axes, (n, 3), and the frame's rows: toward the eye, right, top."""
    points = look.points.reshape(-1, 3)
    frame = np.array(_frame(np.asarray(look.way, dtype=float), np.asarray(look.up, dtype=float)))
    return points[np.isfinite(points).all(axis=1)] @ frame.T, frame


def _half(look: Look) -> float:
    """Half the height [mm] of a view in which everything has room."""
    width, height = look.view.GetSize()
    _, across, along = np.ptp(_seen(look)[0], axis=0)
    return 0.5 * _ROOM * max(float(along) / (1.0 - look.foot - _HEAD), float(across) / (width / height), 1e-9)


def _aim(look: Look, half: float) -> None:
    """Look at the middle of what is seen, ``half`` [mm] of it above and below."""
    (seen, frame), (width, height) = _seen(look), look.view.GetSize()
    middle = 0.5 * (seen.min(axis=0) + seen.max(axis=0)) - [0.0, 0.0, half * (look.foot - _HEAD)]
    middle[0] = np.mean(seen[:, 0])
    far = 2.0 * float(np.linalg.norm(np.ptp(seen, axis=0)))
    focus = middle @ frame
    camera = look.view.GetActiveCamera()
    camera.SetPosition(*(focus + far * frame[0]))
    camera.SetFocalPoint(*focus)
    camera.SetViewUp(*frame[2])
    camera.ParallelProjectionOn()
    camera.SetParallelScale(half)
    look.view.ResetCameraClippingRange()
    _add_scale(look.view, 2.0 * half * width / height)
    for line, told in enumerate(wrap(look.text, round(width / _CHARACTER))):
        _add_text(look.view, 0.02, 1.0 - _LINE * (line + 0.85), told)


def add_legend(view: Any, entries: Mapping[str, str]) -> float:
    """What the view's colours are, at its lower right; returns the share of the height that is to be kept free."""
    heights = _BASE + _LINE * np.arange(len(entries))[::-1]
    boxes = np.column_stack([0.0 * heights + _LEFT, heights, 0.0 * heights + _LEFT + 0.025, heights + 0.55 * _LINE])
    _add_boxes(view, boxes, np.array([rgb(colour) for colour in entries.values()]))
    for height, text in zip(heights, entries, strict=True):
        _add_text(view, _LEFT + 0.035, height, text)
    return max(FOOT, _BASE + _LINE * (len(entries) + 0.5))


def add_colours(view: Any, limit: float, title: str) -> None:
    """The scale of deviations from -``limit`` to ``limit``, at the lower right, with its ``title``."""
    x = np.linspace(_LEFT, 0.94, 65)
    boxes = np.column_stack([x[:-1], np.full(64, _BASE + _LINE), x[1:], np.full(64, _BASE + 1.8 * _LINE)])
    _add_boxes(view, boxes, diverging(np.linspace(-1.0, 1.0, 64)))
    for value, at in ((-limit, x[0]), (0.0, x[32]), (limit, x[-1])):
        _add_text(view, at, _BASE, _signed(value), centred=True)
    _add_text(view, _LEFT, _BASE + 2.2 * _LINE, title)


def _signed(value: float) -> str:
    """A value to three digits, or without decimals."""
    return "0" if value == 0.0 else f"{value:+.0f}" if abs(value) >= 1000.0 else f"{value:+.3g}"


def add_name(view: Any, place: ArrayLike, name: str) -> None:
    """A name at a place [mm] of the part, in front of everything."""
    actor = _text(name)
    at = actor.GetPositionCoordinate()
    at.SetCoordinateSystemToWorld()
    at.SetValue(*np.asarray(place, dtype=float))
    style = actor.GetTextProperty()
    style.SetJustificationToCentered()
    style.SetBackgroundColor(1.0, 1.0, 1.0)
    style.SetBackgroundOpacity(0.7)
    view.AddViewProp(actor)


def _frame(way: NDArray, up: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Unit vectors toward the eye, to the right and to the top of the picture."""
    toward = way / np.linalg.norm(way)
    right = np.cross(up, toward)
    right = right / np.linalg.norm(right)
    return toward, right, np.cross(toward, right)


def _add_scale(view: Any, across: float) -> None:
    """A bar of a round length of a view that is ``across`` [mm] wide, at its lower left."""
    length = round_below(_SCALE * across)
    share, thick = length / across, 0.12 * _LINE
    ends = [[0.03 + x, _BASE, 0.03 + x + 0.003, _BASE + 0.4 * _LINE] for x in (0.0, share)]
    _add_boxes(view, np.array([[0.03, _BASE, 0.03 + share, _BASE + thick], *ends]), np.zeros((3, 3)))
    _add_text(view, 0.03 + 0.5 * share, _BASE + 0.6 * _LINE, f"{length:g} mm", centred=True)


def _add_boxes(view: Any, boxes: NDArray, colours: NDArray) -> None:
    """Flat boxes (left, bottom, right, top), shape (n, 4), in colours (n, 3) from 0 to 1."""
    from vtkmodules.vtkRenderingCore import vtkActor2D, vtkCoordinate, vtkPolyDataMapper2D

    corners = np.zeros((len(boxes), 4, 3))
    corners[..., :2] = boxes[:, [[0, 1], [2, 1], [2, 3], [0, 3]]]
    shades = np.repeat(np.round(255.0 * colours).astype(np.uint8), 4, axis=0)
    faces = np.arange(4 * len(boxes)).reshape(-1, 4)
    flat = mesh(corners.reshape(-1, 3), [faces], values={"colour": shades})
    flat.GetPointData().SetActiveScalars("colour")
    mapper, place, actor = vtkPolyDataMapper2D(), vtkCoordinate(), vtkActor2D()
    place.SetCoordinateSystemToNormalizedViewport()
    mapper.SetInputData(flat)
    mapper.SetTransformCoordinate(place)
    actor.SetMapper(mapper)
    view.AddViewProp(actor)


def _add_text(view: Any, x: float, y: float, text: str, centred: bool = False) -> None:
    actor = _text(text)
    at = actor.GetPositionCoordinate()
    at.SetCoordinateSystemToNormalizedViewport()
    at.SetValue(x, y)
    if centred:
        actor.GetTextProperty().SetJustificationToCentered()
    view.AddViewProp(actor)


def _text(text: str) -> Any:
    from vtkmodules.vtkRenderingCore import vtkTextActor

    actor = vtkTextActor()
    actor.SetInput(text)
    actor.SetTextScaleModeToNone()
    style = actor.GetTextProperty()
    style.SetFontFamilyToArial()
    style.SetFontSize(_FONT)
    style.SetColor(0.0, 0.0, 0.0)
    return actor
