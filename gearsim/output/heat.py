"""Maps of deviations over a surface."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from gearsim.metrology.samples import SampleGrid
from gearsim.output.colours import DIVERGING

if TYPE_CHECKING:
    from matplotlib.axes import Axes

NOISE_UM = 1e-3


def is_perfect(um: NDArray) -> bool:
    """Whether everything was measured and lies within a nanometre."""
    return bool(um.size) and bool(np.isfinite(um).all()) and float(np.abs(um).max()) < NOISE_UM


def draw_heat(figure: Any, axis: Axes, grid: SampleGrid, um: NDArray, what: str) -> None:
    """A map of one surface with its range in the title; of a surface that is as intended, that sentence alone.

    The contours are of the map averaged along the face, or a path's steps would fill it.
    """
    blank = grid.patch.blank
    along = blank.face_width if blank else 1.0
    known = um[np.isfinite(um)]
    limit = max(float(np.abs(known).max(initial=0.0)), NOISE_UM)
    axis.set_title(f"{what}: {_span(known)}", fontsize=10)
    axis.set_xlabel("toe to heel [mm]" if blank else "along the motion [share]", fontsize=9)
    axis.set_ylabel("root to tip [share]" if blank else "across [share]", fontsize=9)
    if is_perfect(um):
        axis.set(xlim=(0.0, along), ylim=(0.0, 1.0), facecolor="#eef0ee")
        text = f"as intended, to {1e3 * float(np.abs(known).max()):.1g} nm"
        axis.text(0.5, 0.5, text, transform=axis.transAxes, ha="center", va="center", fontsize=10, color="0.3")
        return
    extent = (along * grid.length[0], along * grid.length[-1], grid.height[0], grid.height[-1])
    image = axis.imshow(
        um, extent=extent, origin="lower", aspect="auto", cmap=DIVERGING, vmin=-limit, vmax=limit,
        interpolation="bilinear",
    )  # fmt: skip
    _contours(axis, along * grid.length, grid.height, um, limit)
    figure.colorbar(image, ax=axis, label="deviation [µm]", pad=0.02)


def _span(known: NDArray) -> str:
    if not known.size:
        return "nothing cut"
    return f"{known.min():.3g} to {known.max():.3g} µm".replace("-", "−")


def _contours(axis: Axes, x: NDArray, y: NDArray, um: NDArray, limit: float) -> None:
    smooth = gaussian_filter1d(um, um.shape[1] / 40.0, axis=1, mode="nearest")
    known = smooth[np.isfinite(smooth)]
    if known.size and np.ptp(known) > 0.2 * limit and min(um.shape) > 2:
        lines = axis.contour(x, y, smooth, levels=5, colors="k", linewidths=0.6)
        axis.clabel(lines, fontsize=7, fmt="%.3g", inline_spacing=2)
