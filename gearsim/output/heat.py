"""Maps of deviations over a surface."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, log10
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from gearsim.metrology.grid import GridMeasurement
from gearsim.metrology.samples import SampleGrid
from gearsim.output.colours import DIVERGING
from gearsim.output.contours import draw_contours
from gearsim.surfaces.part import Tolerance
from gearsim.surfaces.patch import Way

if TYPE_CHECKING:
    from matplotlib.axes import Axes

NOISE_UM = 1e-3
_FONT = 8
_PALE = 4.0  # so many times smaller than its scale a map may be
_LEAST_MARK = 0.02  # of the limit


def is_perfect(m: GridMeasurement) -> bool:
    """Whether everything that could be measured was, and lies within a nanometre of what is intended."""
    um = 1e3 * m.deviation.value[m.measurable]
    return bool(um.size) and bool(np.isfinite(um).all()) and float(np.abs(um).max()) < NOISE_UM


def limit_of(um: NDArray) -> float:
    """The greatest size of deviations [um], or a nanometre: where the scale of a map ends."""
    return max(float(np.nanmax(np.abs(um), initial=0.0)), NOISE_UM)


def shared_limits(own: Sequence[float], rows: Sequence[int]) -> list[float]:
    """Where the scales of maps end: with those of its row a map shares one, unless it would be too pale to be read."""
    largest = {row: max(limit for limit, at in zip(own, rows, strict=True) if at == row) for row in set(rows)}
    return [largest[row] if limit * _PALE >= largest[row] else limit for limit, row in zip(own, rows, strict=True)]


def draw_heat(
    axis: Axes, grid: SampleGrid, um: NDArray, what: str, limit: float, tolerance: Tolerance | None
) -> None:  # fmt: skip
    """A map of one surface on its grid, as ``draw_map``."""
    draw_map(axis, grid.patch.ways, (grid.height, grid.length), um, what, limit, tolerance)


def draw_map(
    axis: Axes, ways: tuple[Way, Way], places: tuple[NDArray, NDArray], um: NDArray, what: str, limit: float,
    tolerance: Tolerance | None,
) -> None:  # fmt: skip
    """A map from -``limit`` to ``limit`` with its range in the title and its scale at the right.

    ``ways``: along the surface and up it; ``places``: of rows and columns, as fractions. The tolerance is marked on the
    scale as far as it lies on it. The contours are of the map averaged, most along the face, or a path's steps would
    fill it.
    """
    along, up = ways
    known = um[np.isfinite(um)]
    x, y = along.at(places[1]), up.at(places[0])
    paint(axis, x, y, um, limit)
    if tolerance is not None:
        _mark(axis, tolerance, limit)
    smooth = averaged(um)
    steps = smooth[np.isfinite(smooth)]
    if steps.size and np.ptp(steps) > 0.2 * limit and min(um.shape) > 2:
        draw_contours(axis, x, y, smooth)
    axis.locator_params(nbins=4)
    axis.tick_params(labelsize=_FONT)
    axis.set_title(f"{what}: {span(known)}", fontsize=10, y=1.03)  # fixed: to find a place for it is slow
    axis.set_xlabel(along.what, fontsize=9)
    axis.set_ylabel(up.what, fontsize=9)


def averaged(values: NDArray) -> NDArray:
    """A map without the steps of a path, shape (rows, columns): averaged over a few columns and fewer rows."""
    rows, columns = values.shape
    return _blurred(_blurred(values, rows / 80.0).T, columns / 40.0).T


def _blurred(values: NDArray, spread: float) -> NDArray:
    """Columns averaged with normal weights to four standard deviations, their ends going on; SciPy's, slow to load."""
    reach = int(4.0 * spread + 0.5)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / spread) ** 2)
    padded = np.pad(values, ((reach, reach), (0, 0)), mode="edge")
    return np.asarray(sliding_window_view(padded, len(weights), axis=0) @ (weights / weights.sum()))


def paint(axis: Axes, x: NDArray, y: NDArray, um: NDArray, limit: float, unit: str = "µm") -> None:
    """A map alone, its scale at the right; values may be in another unit."""
    axis.imshow(
        um, extent=(x[0], x[-1], y[0], y[-1]), origin="lower", aspect="auto", cmap=DIVERGING, vmin=-limit, vmax=limit,
        interpolation="bilinear",
    )  # fmt: skip
    axis.set(xlim=sorted((x[0], x[-1])), ylim=(y[0], y[-1]), facecolor="0.85")
    _scale(axis, limit, unit)


def span(known: NDArray) -> str:
    """The least and the largest of values [um], to three digits of the larger one."""
    if not known.size:
        return "nothing cut"
    low, high = float(known.min()), float(known.max())
    decimals = _decimals(max(abs(low), abs(high)))
    low, high = (round(value, decimals) + 0.0 for value in (low, high))
    return f"{low:.{decimals}f} to {high:.{decimals}f} µm".replace("-", "−")


def _mark(axis: Axes, tolerance: Tolerance, limit: float) -> None:
    """Strokes across the scale at the tolerance's ends that lie on it, where they do not run into its middle."""
    from matplotlib.collections import LineCollection

    shares = (um / limit for um in (-tolerance.overcut_um, tolerance.excess_um))
    strokes = [[(x, 0.5 + 0.5 * at) for x in (1.015, 1.055)] for at in shares if _LEAST_MARK < abs(at) <= 1.0]
    style: dict[str, Any] = {"colors": "k", "linewidths": 1.2, "transform": axis.transAxes, "clip_on": False}
    axis.add_collection(LineCollection(strokes, **style), autolim=False)


def _decimals(largest: float) -> int:
    return int(np.clip(2 - floor(log10(max(largest, NOISE_UM))), 0, 5))


def _scale(axis: Axes, limit: float, unit: str) -> None:
    """What colours mean, beside the map: one picture and its ends' numbers, cheaper than a colour bar of its own."""
    axis.set_autoscale_on(False)
    axis.imshow(
        np.linspace(-1.0, 1.0, 64)[:, None], extent=(1.02, 1.05, 0.0, 1.0), transform=axis.transAxes, origin="lower",
        aspect="auto", cmap=DIVERGING, clip_on=False, interpolation="bilinear",
    )  # fmt: skip
    decimals = _decimals(limit)
    for height, value in ((0.0, -limit), (0.5, 0.0), (1.0, limit)):
        text = f"0 {unit}" if value == 0.0 else f"{value:+.{decimals}f}".replace("-", "−")
        axis.text(1.065, height, text, transform=axis.transAxes, fontsize=_FONT, va="center_baseline")
