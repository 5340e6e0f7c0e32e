"""The picture of an error map: where over the parameters a formula errs, on a logarithmic scale."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from gearsim.errors import InputError, written
from gearsim.output.panels import pyplot
from gearsim.verify.checks import FormReport, Limits
from gearsim.verify.closed_form import file_name
from gearsim.verify.error_map import ErrorMap, Worst
from gearsim.verify.report import UNITS, SubjectReport

ENDINGS = (".png", ".svg", ".pdf")
_PIXELS = 200
_LEAST = 1e-4  # of the limit: smaller errors have its colour
_COLOURS = "PRGn_r"  # green within the limit, purple beyond
_STATES = {"missing": "0.97", "trimmed": "0.85", "not settled": "0.7"}


def check_plot(file: Path) -> None:
    """Refuse a name that cannot be drawn, before anything is computed. Raises InputError."""
    if file.suffix not in ENDINGS:
        raise InputError(f"--plot {file}: expected a name that ends in {', '.join(ENDINGS)}")


def plot_maps(subjects: Sequence[SubjectReport], limits: Limits, file: Path) -> list[str]:
    """Draw every form that was checked; lines that name the files and the worst points.

    Where there are several forms, each one's name is put into the file's. Raises InputError where there is nothing to
    draw or a file cannot be written.
    """
    forms = [form for s in subjects for form in s.forms if form.errors is not None and form.errors.errors]
    if not forms:
        raise InputError(f"--plot {file}: no formula was checked at any point")
    told = []
    for form in forms:
        target = file if len(forms) == 1 else file.with_name(f"{file.stem}-{file_name(form.name)}{file.suffix}")
        with written(target) as scratch:
            draw_map(form, limits, scratch)
        told += [f"wrote {target}", *worst_lines(form)]
    return told


def worst_lines(form: FormReport) -> Iterator[str]:
    """What the largest error of every check is, and where."""
    assert form.errors is not None
    for name in form.errors.errors:
        worst = form.errors.worst(name)
        if worst is not None:
            yield f"{form.name}: {name}: worst {_worst_text(name, worst)}"


def _worst_text(name: str, worst: Worst) -> str:
    return f"{worst.error:.3g} {UNITS[name]} at u = {worst.u:.4f}, v = {worst.v:.4f}"


def draw_map(form: FormReport, limits: Limits, file: Path) -> None:
    """One panel a check, with its limit in the middle of the scale, its worst point circled and named."""
    errors, plt = form.errors, pyplot()
    assert errors is not None
    names = list(errors.errors)
    figure, axes = plt.subplots(
        1, len(names), figsize=(5.6 * len(names), 5.6), squeeze=False, constrained_layout=True
    )  # fmt: skip
    nearest = _nearest(errors)
    for axis, name in zip(axes[0], names, strict=True):
        _panel(figure, axis, errors, name, limits.of(name), nearest)
    axes[0, 0].set_ylabel("v")
    _add_legend(figure, errors)
    figure.suptitle(f"{form.name}: {form.verdict}, {form.points} points; each one's error about it", fontsize=13)
    figure.savefig(file, dpi=100)
    plt.close(figure)


def _nearest(errors: ErrorMap) -> NDArray:
    """Which point is nearest in every pixel of the parameters' square."""
    at = (np.arange(_PIXELS) + 0.5) / _PIXELS
    pixels = np.stack(np.meshgrid(at, at), axis=-1)
    return np.asarray(cKDTree(np.column_stack([errors.u, errors.v])).query(pixels)[1])


def _panel(figure: Any, axis: Any, errors: ErrorMap, name: str, limit: float, nearest: NDArray) -> None:
    from matplotlib.colors import LogNorm

    error = errors.errors[name]
    finite = error[np.isfinite(error)]
    span = max(1.0 / _LEAST, float(finite.max(initial=0.0)) / limit)
    image = axis.imshow(
        np.clip(error, limit / span, limit * span)[nearest], origin="lower", extent=(0, 1, 0, 1), aspect="auto",
        cmap=_COLOURS, norm=LogNorm(limit / span, limit * span), interpolation="nearest", zorder=1,
    )  # fmt: skip
    axis.imshow(_states(errors, error)[nearest], origin="lower", extent=(0, 1, 0, 1), aspect="auto", zorder=0)
    bar = figure.colorbar(image, ax=axis, label=f"{name} error [{UNITS[name]}], limit {limit:g}")
    bar.ax.axhline(limit, color="k", lw=1.5)
    axis.plot(errors.u, errors.v, ".", ms=1.0, color="0.3", zorder=2)
    axis.plot(errors.u[errors.wrong_side], errors.v[errors.wrong_side], "x", color="k", ms=4, zorder=2)
    worst = errors.worst(name)
    if worst is not None:
        for colour, width in (("w", 3.6), ("k", 1.8)):
            axis.plot(worst.u, worst.v, "o", mfc="none", mec=colour, ms=12, mew=width, zorder=3, clip_on=False)
    text = "nothing compared" if worst is None else f"worst {_worst_text(name, worst)}"
    axis.set_title(f"{name}: {text}", fontsize=9.5, loc="left")
    axis.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0), xlabel="u")


def _states(errors: ErrorMap, error: NDArray) -> NDArray:
    """The grey of every point whose error is not known, shape (n, 3)."""
    grey = np.full(len(error), float(_STATES["not settled"]))
    grey[errors.trimmed] = float(_STATES["trimmed"])
    grey[errors.missing] = float(_STATES["missing"])
    return np.repeat(grey[:, None], 3, axis=1)


def _add_legend(figure: Any, errors: ErrorMap) -> None:
    """What greys and marks are, as far as there are any."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    unsettled = np.zeros(errors.u.shape, dtype=bool)
    for error in errors.errors.values():
        unsettled |= np.isnan(error) & ~errors.missing & ~errors.trimmed
    masks = {"missing": errors.missing, "trimmed": errors.trimmed, "not settled": unsettled}
    marks: list[Any] = [Line2D([], [], ls="", marker="o", mfc="none", mec="k", ms=9, label="the worst point")]
    for name, mask in masks.items():
        if mask.any():
            marks.append(Patch(fc=_STATES[name], ec="0.5", label=f"{name}: {int(mask.sum())} points"))
    if errors.wrong_side.any():
        label = f"normal into the material: {int(errors.wrong_side.sum())} points"
        marks.append(Line2D([], [], ls="", marker="x", color="k", label=label))
    figure.legend(handles=marks, loc="outside lower center", ncols=len(marks), frameon=False, fontsize=9)
