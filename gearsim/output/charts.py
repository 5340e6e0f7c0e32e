"""Flat pictures with Matplotlib: deviation maps, whiskers, profiles."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from gearsim.metrology.bevel import FlankResult
from gearsim.metrology.deviation import Deviation
from gearsim.metrology.samples import SampleGrid
from gearsim.output.summary import published_um
from gearsim.result import FlankMillingResult

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_NOISE_UM = 1e-3


def draw_deviation(result: FlankMillingResult, file: Path) -> None:
    """deviation.png, one column a flank: maps with contours, whiskers on the inspector's grid, mean profile."""
    plt = pyplot()
    figure, axes = plt.subplots(4, 2, figsize=(13, 17), constrained_layout=True)
    for column, flank in enumerate(result.flanks.values()):
        own = flank.own or flank.own_cl
        motion = "continuous motion" if flank.own else "CL data"
        heat_map(figure, axes[0, column], flank.grid, own, f"{flank.side} flank, own pass, {motion}")
        heat_map(figure, axes[1, column], flank.grid, flank.all_passes, f"{flank.side} flank, all passes")
        _whiskers(axes[2, column], flank)
        _profile(axes[3, column], flank, result.scene)
    name = result.scene["scene"]["name"]
    figure.suptitle(f"{name}: deviation of the machined flanks (+ material left, - overcut)", fontsize=14)
    figure.savefig(file, dpi=100)
    plt.close(figure)


def draw_profile(result: FlankMillingResult, file: Path) -> None:
    """profile.png: intended and machined profile at mid-face, and the flanks' own passes enlarged."""
    plt = pyplot()
    figure, (left, right) = plt.subplots(1, 2, figsize=(13, 5.5), constrained_layout=True)
    measured = [(f.grid, f.all_passes) for f in result.flanks.values()]
    measured += [(p.grid, p.deviation) for p in result.patches.values()]
    _section(left, result, measured, 1.0)
    left.set_title("all passes, true to scale")
    own = [(f.grid, f.own or f.own_cl) for f in result.flanks.values()]
    scale = _enlargement([d for _, d in own])
    _section(right, result, own, scale)
    right.set_title(f"each flank's own pass, deviation {scale:,.0f} times enlarged")
    figure.savefig(file, dpi=110)
    plt.close(figure)


def pyplot() -> Any:
    """Matplotlib without a screen."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    return plt


def heat_map(figure: Any, axis: Axes, grid: SampleGrid, deviation: Deviation, what: str) -> None:
    """A map of one surface; the contours are of the map averaged along the face, or CL steps would fill it."""
    um = 1e3 * deviation.value
    blank = grid.patch.blank
    length = grid.length * (blank.face_width if blank else 1.0)
    limit = max(_largest(um), _NOISE_UM)
    image = axis.pcolormesh(length, grid.height, um, cmap="RdBu_r", vmin=-limit, vmax=limit, shading="gouraud")
    smooth = gaussian_filter1d(um, um.shape[1] / 40.0, axis=1, mode="nearest")
    known = smooth[np.isfinite(smooth)]
    if known.size and np.ptp(known) > 0.2 * limit:
        lines = axis.contour(length, grid.height, smooth, levels=7, colors="k", linewidths=0.7)
        axis.clabel(lines, fontsize=8, fmt="%.3g")
    figure.colorbar(image, ax=axis, label="deviation [µm]")
    summary = deviation.summary_um()
    span = "nothing cut" if summary["min"] is None else f"{summary['min']:.3g} to {summary['max']:.3g} µm"
    axis.set_title(f"{what}: {span}")
    axis.set_xlabel("toe to heel [mm]" if blank else "along the motion [share]")
    axis.set_ylabel("root to tip [share of surface]" if blank else "tip to shank [share of profile]")


def _whiskers(axis: Axes, flank: FlankResult) -> None:
    """The inspector's grid: a stroke per point, up for material left, with its scale."""
    um = flank.topography["all_passes"].as_cut_um
    x, y = np.meshgrid(flank.inspection.length, flank.inspection.height)
    largest = _largest(um)
    step = flank.inspection.height[1] - flank.inspection.height[0]
    tips = y + 0.8 * step * np.nan_to_num(um) / largest
    for i in range(um.shape[0]):
        axis.plot(x[i], y[i], color="0.7", lw=0.8)
        axis.plot(x[i], tips[i], color="tab:blue", lw=1.0)
    for j in range(um.shape[1]):
        axis.plot(x[:, j], y[:, j], color="0.85", lw=0.6)
    colours = np.where(um.ravel() < 0.0, "tab:blue", "tab:red")
    axis.vlines(x.ravel(), y.ravel(), tips.ravel(), colors=list(colours), lw=2.0)
    axis.annotate("", (1.04, 0.1 + 0.8 * step), (1.04, 0.1), arrowprops={"arrowstyle": "|-|", "lw": 1.2})
    axis.text(1.02, 0.1 + 0.4 * step, f"{largest:.3g} µm", rotation=90, va="center", ha="right", fontsize=9)
    axis.set_xlim(0.0, 1.07)
    axis.set_ylim(-0.12, 1.12)
    axis.set_title(f"{flank.side} flank on the inspector's grid, as cut, all passes")
    axis.set_xlabel("toe to heel [share of face]")
    axis.set_ylabel("root to tip [share of flank]")


def _profile(axis: Axes, flank: FlankResult, scene: dict[str, Any]) -> None:
    """Deviation at L0..L6 over the distance from the contact path, with published values beside."""
    offsets = np.array(scene["metrology"]["profile_offsets_mm"])
    order = np.argsort(offsets)
    normal = np.array(list(flank.profile_um.values()))
    in_plane = np.array(list(flank.profile_inplane_um.values()))
    axis.plot(offsets[order], normal[order], "o-", label="ours, surface normal")
    axis.plot(offsets[order], in_plane[order], "x--", label="ours, normal in the profile plane")
    for name, x, y in zip(flank.profile_um, offsets, normal, strict=True):
        axis.annotate(name, (x, y), textcoords="offset points", xytext=(4, 6), fontsize=8)
    reference = scene.get("reference")
    ours, scale = _largest(np.concatenate([normal, in_plane])), ""
    if reference is not None:
        published = np.array(published_um(reference, flank.side))
        axis.plot(offsets[order], published[order], "s:", color="0.5", label=f"{reference['source']} (sign turned)")
        if _largest(published) > 3.0 * ours:
            axis.set_yscale("symlog", linthresh=ours)
            scale = f" (logarithmic beyond {ours:.2g} µm)"
    axis.axhline(0.0, color="k", lw=0.6)
    axis.margins(y=0.15)
    axis.set_title(f"{flank.side} flank, mean profile, own pass{scale}")
    axis.set_xlabel("height above the contact path [mm]")
    axis.set_ylabel("deviation [µm]")
    axis.legend(fontsize=8)


def _section(
    axis: Axes, result: FlankMillingResult, measured: list[tuple[SampleGrid, Deviation]], scale: float
) -> None:
    """Intended and machined profiles at mid-face, seen along the pitch cone's generator from the slot's middle."""
    bottom = result.tooth.bottom
    middle = bottom.jet(*bottom.locate(np.array([0.5]), np.array([0.5]))).r[0]
    generator, up = bottom.blank.cone_directions(middle)
    to_plane = np.column_stack([np.cross(up, generator), up])
    for number, (grid, deviation) in enumerate(measured):
        column = grid.shape[1] // 2
        points = grid.point[:, column] - middle
        moved = points + scale * np.nan_to_num(deviation.value[:, column])[:, None] * grid.normal[:, column]
        labels = ("intended", "machined") if number == 0 else (None, None)
        axis.plot(*(points @ to_plane).T, color="0.35", lw=2.5, label=labels[0])
        axis.plot(*(moved @ to_plane).T, color="tab:red", lw=1.2, label=labels[1])
    axis.set_aspect("equal")
    axis.set_xlabel("y across the slot [mm]")
    axis.set_ylabel("height above the root [mm]")
    axis.legend(loc="lower right")


def _enlargement(deviations: list[Deviation]) -> float:
    """A power of ten that makes the largest deviation at mid-face a few tenths of a millimetre."""
    largest = max(_largest(d.value[:, d.value.shape[1] // 2]) for d in deviations)
    return float(10.0 ** np.floor(np.log10(max(1.0 / largest, 1.0))))


def _largest(deviation: NDArray) -> float:
    """Largest size of the values that exist, at least 1e-6."""
    return float(np.nanmax(np.abs(deviation), initial=1e-6))
