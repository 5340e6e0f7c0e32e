"""The largest mill at every point of a surface as a map of regions, each with its mill's sizes on it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.gouging.choice import SizeChoice
from gearsim.output.panels import pyplot
from gearsim.output.saving import Save

_WIDTH, _HEIGHT = 10.0, 8.6
_MAP = (0.8, 0.7, 7.8, 6.9)  # left, bottom, width, height [inch]
_PIXEL = 0.02  # inch a pixel of the map
_FONT = 7.5  # points
_NONE = "0.85"


def draw_sizes(sizes: SizeChoice, title: str, notes: list[str], name: str, save: Save) -> None:
    """One map: a region a mill, coloured by the radius that varies, with the numbers where they have room.

    Where the answer is everywhere the same it is a sentence.
    """
    mills, index = regions(sizes)
    if len(mills) <= 1 and (index == index.flat[0]).all():
        _say(title, [*notes, _everywhere(mills)], name, save)
        return
    figure = pyplot().figure(figsize=(_WIDTH, _HEIGHT))
    left, bottom, width, height = _MAP
    axis = figure.add_axes((left / _WIDTH, bottom / _HEIGHT, width / _WIDTH, height / _HEIGHT))
    what, shown, words = _told(mills)
    raster = index[np.ix_(_nearest(sizes.grid.height, height), _nearest(sizes.grid.length, width))]
    _draw_regions(figure, axis, sizes, raster, shown, what)
    _number(axis, raster, words, shown)
    axis.set_facecolor(_NONE)
    if (index < 0).any():
        axis.text(0.01, -0.075, "grey: none fits", transform=axis.transAxes, fontsize=9, color="0.25")
    axis.set_xlabel("u [share of the domain]")
    axis.set_ylabel("v [share of the domain]")
    axis.set_title(what, fontsize=10, loc="left")
    _head(figure, title, notes)
    save(figure, name)


def _head(figure: Any, title: str, lines: list[str]) -> None:
    width, height = figure.get_size_inches()
    figure.text(_MAP[0] / width, 1.0 - 0.35 / height, title, fontsize=13, weight="bold")
    figure.text(_MAP[0] / width, 1.0 - 0.45 / height, "\n".join(lines), fontsize=9, va="top")


def _say(title: str, lines: list[str], name: str, save: Save) -> None:
    """A picture of words alone."""
    figure = pyplot().figure(figsize=(_WIDTH, 0.65 + 0.18 * len(lines)))
    _head(figure, title, lines)
    save(figure, name)


def _everywhere(mills: NDArray) -> str:
    if not len(mills):
        return "at no point of the surface a mill of the catalogue fits"
    shank, corner = mills[0]
    return f"at every point of the surface the same is the largest: R = {shank:g} mm, r = {corner:g} mm"


def regions(sizes: SizeChoice) -> tuple[NDArray, NDArray]:
    """The mills that are the largest somewhere (R, r) [mm], shape (m, 2), and which of them where, -1: none fits."""
    fits = np.isfinite(sizes.shank)
    mills, which = np.unique(np.column_stack([sizes.shank[fits], sizes.corner[fits]]), axis=0, return_inverse=True)
    index = np.full(sizes.shank.shape, -1)
    index[fits] = which.ravel()
    return mills, index


def _told(mills: NDArray) -> tuple[str, NDArray, list[str]]:
    """What colours and numbers are; the coloured radius of every mill; the text of every mill."""
    shank, corner = mills.T if len(mills) else np.empty((2, 0))
    one = len(np.unique(shank)) <= 1
    if np.array_equal(shank, corner):
        return "numbers: R = r of the ball end mill [mm]", shank, [f"{x:g}" for x in shank]
    if one:
        return f"R = {shank[0]:g} mm; numbers: corner radius r [mm]", corner, [f"{x:g}" for x in corner]
    return "numbers: R, r [mm]; colours: R", shank, [f"{a:g}, {b:g}" for a, b in mills]


def _nearest(places: NDArray, inches: float) -> NDArray:
    """Which of some ascending places is nearest at every pixel of a picture that they span."""
    pixels = np.linspace(places[0], places[-1], round(inches / _PIXEL))
    return np.searchsorted(0.5 * (places[1:] + places[:-1]), pixels)


def _draw_regions(figure: Any, axis: Any, sizes: SizeChoice, raster: NDArray, shown: NDArray, what: str) -> None:
    grid = sizes.grid
    low, high = float(shown.min()), float(shown.max())
    values = np.where(raster < 0, np.nan, shown[raster])
    image = axis.imshow(
        values, extent=(grid.length[0], grid.length[-1], grid.height[0], grid.height[-1]), origin="lower",
        aspect="auto", cmap="viridis", vmin=low, vmax=max(high, low * (1.0 + 1e-9)), interpolation="nearest",
    )  # fmt: skip
    if high > low:
        left, bottom, width, height = _MAP
        place = ((left + width + 0.15) / _WIDTH, bottom / _HEIGHT, 0.18 / _WIDTH, height / _HEIGHT)
        figure.colorbar(image, cax=figure.add_axes(place), label="r [mm]" if "corner" in what else "R [mm]")


def _number(axis: Any, raster: NDArray, words: list[str], shown: NDArray) -> None:
    """Every region's text where it has room; white on dark."""
    em = _FONT / 72.0 / _PIXEL
    box = (round(1.1 * em), round(0.66 * em * (1 + max(map(len, words)))))
    dark = shown <= 0.5 * (shown.min() + shown.max())
    rows, columns = raster.shape
    for i, j in label_places(raster, box):
        mill = raster[i, j]
        axis.text(
            (j + 0.5) / columns, (i + 0.5) / rows, words[mill], transform=axis.transAxes, fontsize=_FONT,
            ha="center", va="center_baseline", color="w" if dark[mill] else "k",
        )  # fmt: skip


def label_places(index: NDArray, box: tuple[int, int]) -> list[tuple[int, int]]:
    """Of every connected region of equal index from 0 up the place (row, column) farthest from its border, where a box
    (rows, columns) about it lies within the region; regions without room have none. Ties go to the middle column.
    """
    from scipy import ndimage  # the run itself needs the names of pictures only

    edge = np.ones(index.shape, dtype=bool)
    edge[1:-1, 1:-1] = (index[1:-1, 1:-1] != index[:-2, 1:-1]) | (index[1:-1, 1:-1] != index[1:-1, :-2])
    parts, count = ndimage.label(~edge & (index >= 0))
    fits = ndimage.minimum_filter(index, box, mode="constant", cval=-2) == ndimage.maximum_filter(index, box)
    middle = 0.5 * (index.shape[1] - 1)
    off = np.abs(np.arange(index.shape[1]) - middle) / index.shape[1]
    room = np.where(fits, ndimage.distance_transform_edt(~edge) - off, -1.0)
    places = ndimage.maximum_position(room, parts, np.arange(1, count + 1)) if count else []
    return [(int(i), int(j)) for i, j in places if room[i, j] > 0.0]
