"""Contours whose labels do not collide: one that would lie on another or on the border is left out, and islands."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

_FONT = 7.0  # points
_CHARACTER = 0.68  # of the font's size
_ROOM = 3.0  # points about a label
_SHORTEST = 30.0  # points of a line with a label
_MOST = 3  # labels a level
_ISLAND = 24.0  # points: shorter contours are left out
_FULL = 20  # contours
_END = 0.02  # of the range
_ALONG = (0.5, 0.35, 0.65, 0.2, 0.8)  # of a contour's length, where a label is tried


def draw_contours(axis: Any, x: NDArray, y: NDArray, values: NDArray, levels: int = 4) -> None:
    """Contours of values, shape (rows, columns), at about as many round ``levels``, with their values on them.

    None where there would be so many that they fill the map: colours alone tell more of waves.
    """
    from contourpy import contour_generator
    from matplotlib.collections import LineCollection

    to_points = 72.0 / axis.get_figure().dpi
    found = contour_generator(x, y, np.ma.masked_invalid(values))
    curves = [(level, curve) for level in round_levels(values, levels) for curve in _lines(found, level)]
    paths = [(f"{level:g}".replace("-", "−"), to_points * axis.transData.transform(curve)) for level, curve in curves]
    long = [k for k, (_, path) in enumerate(paths) if _length(path)[-1] > _ISLAND]
    if len(long) > _FULL:
        return
    dashes = ["--" if curves[k][0] < 0.0 else "-" for k in long]
    axis.add_collection(LineCollection([curves[k][1] for k in long], colors="k", linewidths=0.6, linestyles=dashes))
    paths = [paths[k] for k in long]
    panel = to_points * axis.get_window_extent().get_points()
    back = axis.transData.inverted()
    for text, place in place_labels(paths, panel):
        at = back.transform(place / to_points)
        style = {"fc": "w", "lw": 0, "alpha": 0.65, "pad": 0.6}
        axis.text(*at, text, fontsize=_FONT, ha="center", va="center_baseline", bbox=style)


def _lines(found: Any, level: float) -> list[NDArray]:
    """The lines of a level, shape (n, 2) each, as the generator gives them by default."""
    return list(found.lines(level))


def round_levels(values: NDArray, count: int) -> NDArray:
    """About as many round levels within the range of values; none at its ends, where a contour is but noise."""
    from matplotlib.ticker import MaxNLocator

    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    levels = np.asarray(MaxNLocator(count + 1, min_n_ticks=1).tick_values(low, high))
    room = _END * (high - low)
    return levels[(levels > low + room) & (levels < high - room)]


def place_labels(paths: Sequence[tuple[str, NDArray]], panel: NDArray) -> list[tuple[str, NDArray]]:
    """Texts that have room on their lines, with their middles, shape (2,); the longest line chooses first.

    Lines, shape (n, 2), and the ``panel``'s lower left and upper right corner, shape (2, 2), in points.
    """
    placed: list[tuple[str, NDArray]] = []
    times: Counter[str] = Counter()
    taken = np.empty((0, 2, 2))
    for text, line in sorted(paths, key=lambda path: -_length(path[1])[-1]):
        if times[text] == _MOST:
            continue
        half = 0.5 * np.array([_CHARACTER * _FONT * len(text), _FONT])
        for middle in _tries(line, max(6.0 * half[0], _SHORTEST)):
            box = np.stack([middle - half, middle + half])
            inside = bool((box[0] > panel[0] + 1.0).all() and (box[1] < panel[1] - 1.0).all())
            if inside and not _overlaps(box, taken).any():
                placed.append((text, middle))
                times[text] += 1
                taken = np.concatenate([taken, box[None]])
                break
    return placed


def _length(line: NDArray) -> NDArray:
    """Length up to every point of a line."""
    return np.append(0.0, np.cumsum(np.hypot(*np.diff(line, axis=0).T)))


def _tries(line: NDArray, least: float) -> Iterator[NDArray]:
    """Places on a line, its middle first; none on a line shorter than ``least``."""
    along = _length(line)
    if along[-1] < least:
        return
    for share in _ALONG:
        yield np.array([np.interp(share * along[-1], along, c) for c in line.T])


def _overlaps(box: NDArray, taken: NDArray) -> NDArray:
    """Which of other boxes (n, 2, 2) a box (2, 2) comes nearer than the room about it."""
    return np.asarray(((taken[:, 0] < box[1] + _ROOM) & (taken[:, 1] > box[0] - _ROOM)).all(axis=1))
