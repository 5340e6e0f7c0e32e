"""Maps of faces looked at for local gouging: least difference of curvature and largest mill, as pictures and EXR."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.contact import approach
from gearsim.gouging.check import GougeCheck
from gearsim.gouging.choice import SizeChoice
from gearsim.gouging.fitting import size_map
from gearsim.gouging.looked import FaceLook
from gearsim.output.colours import GOUGE
from gearsim.output.columns import DECISIONS, YES_NO, Column, key_of_numbers, known
from gearsim.output.gouging.mill_map import draw_sizes
from gearsim.output.gouging.mills import size_channels
from gearsim.output.gouging.words import tool_words
from gearsim.output.panels import pyplot
from gearsim.output.saving import Save

_STROKES = 24
_MOST = 6


def draw_faces(check: GougeCheck, notes: list[str], save: Save) -> dict[str, str]:
    """Pictures of the tightest faces, six at most, with their captions."""
    reached = [k for k, f in enumerate(check.looks) if f.reached] or [0]
    tightest = sorted(reached, key=lambda k: float(np.min(_least(check.looks[k]), initial=np.inf)))[:_MOST]
    drawn = {}
    for k in tightest:
        f = check.looks[k]
        mark, of = ("", "") if len(check.looks) == 1 else (f"-{k + 1}", f"{f.face.name}: ")
        title = check.name if not of else f"{check.name}, {f.face.name}"
        _draw_map(check, f, title, f"gouging{mark}.png", save)
        draw_sizes(face_sizes(check, f), f"{title}: largest mill of the catalogue", notes, f"tool_size{mark}.png", save)
        drawn[f"gouging{mark}.png"] = (
            f"{of}Tool's curvature minus the part's, least over all directions; strokes: worst directions"
        )
        drawn[f"tool_size{mark}.png"] = f"{of}The largest mill of the catalogue that does not gouge, point by point"
    return drawn


def face_sizes(check: GougeCheck, f: FaceLook) -> SizeChoice:
    """The largest mill at every point of a face."""
    choice = size_map(f, check.mills)
    shape = f.grid.shape
    return SizeChoice(f.grid, choice.shank.reshape(shape), choice.corner.reshape(shape), check.mills, check.whole,
                      check.place)  # fmt: skip


def face_channels(check: GougeCheck, f: FaceLook) -> dict[str, Column]:
    """What gouging.exr holds of a face; the least difference of curvature first."""
    seen, touches, contacts = f.samples.comparison, f.samples.touches, f.samples.contacts

    def on_grid(values: NDArray, where: NDArray | bool = True) -> NDArray:
        return np.where(where, values, np.nan).reshape(f.grid.shape)

    angle = "from uphill, counter-clockwise"
    return {
        "least_difference.per_mm": Column(
            on_grid(seen.least, touches), "tool's curvature minus the part's, least over all directions"
        ),
        "decision.id": Column(
            known(f.samples.decision.reshape(f.grid.shape)), "whether it gouges; nothing: out of reach",
            key_of_numbers(DECISIONS),
        ),
        "on_face": Column(f.held, "whether the point lies on the trimmed face", YES_NO),
        "worst_direction.deg": Column(on_grid(np.degrees(seen.worst), touches), f"direction of the least, {angle}"),
        "gouging_half_width.deg": Column(
            on_grid(np.degrees(seen.half_width), touches), "half the width of the directions that gouge"
        ),
        "contact_angle.deg": Column(on_grid(np.degrees(contacts.theta)), "angle of the contact on the tool's profile"),
        **size_channels(face_sizes(check, f)),
    }  # fmt: skip


def _least(f: FaceLook) -> NDArray:
    return np.where(f.samples.touches, f.samples.comparison.least, np.inf)


def _draw_map(check: GougeCheck, f: FaceLook, title: str, name: str, save: Save) -> None:
    """gouging.png: the least difference of curvature, the gouging region outlined, its worst directions as strokes."""
    plt = pyplot()
    grid, values = f.grid, _least(f).reshape(f.grid.shape)
    least = np.where(np.isfinite(values), values, np.nan)
    figure, axis = plt.subplots(figsize=(9.0, 7.4), constrained_layout=True)
    axis.set_facecolor("#d9d9d9")
    known = least[np.isfinite(least)]
    if known.size:
        limit = max(float(np.quantile(np.abs(known), 0.98)), 1e-9)
        image = axis.pcolormesh(grid.length, grid.height, least, cmap="RdBu", vmin=-limit, vmax=limit,
                                shading="nearest", rasterized=True)  # fmt: skip
        figure.colorbar(image, ax=axis, label="least of tool minus part [1/mm]; below 0 gouges")
        if known.min() < -1e-9 < 1e-9 < known.max():
            axis.contour(grid.length, grid.height, least, levels=[-1e-9], colors="k", linewidths=1.3)
        _strokes(axis, check, f, least)
        row, column = np.unravel_index(int(np.nanargmin(least)), grid.shape)
        axis.plot(grid.length[column], grid.height[row], "o", mfc="none", mec="k", ms=10, mew=1.6)
    axis.set_xlabel("u [share of the domain]")
    axis.set_ylabel("v [share of the domain]")
    gouging = int(f.samples.gouges.sum())
    axis.set_title(
        f"{title}, {tool_words(check.cutter)}\n{gouging:,} of {int(f.held.sum()):,} points gouge; circle: tightest; "
        "grey: out of reach or off the face", fontsize=11,
    )  # fmt: skip
    save(figure, name, 110)


def _strokes(axis: Any, check: GougeCheck, f: FaceLook, least: NDArray) -> None:
    """Worst directions at some gouging points, as they run in the picture."""
    grid, surface = f.grid, f.face.surface
    rows, columns = (np.unique(np.linspace(0, n - 1, _STROKES).astype(int)[1:-1]) for n in grid.shape)
    i, j = (a.ravel() for a in np.meshgrid(rows, columns, indexing="ij"))
    shown = least[i, j] < -1e-9
    i, j = i[shown], j[shown]
    if not len(i):
        return
    at = i * grid.shape[1] + j
    way = _worst_tangents(check, f, at)
    jet = surface.jet(grid.u.ravel()[at], grid.v.ravel()[at])
    e, g12, g = (np.einsum("ni,ni->n", a, b) for a, b in ((jet.ru, jet.ru), (jet.ru, jet.rv), (jet.rv, jet.rv)))
    p, q = (np.einsum("ni,ni->n", way, d) for d in (jet.ru, jet.rv))
    (u0, u1), (v0, v1) = surface.domain
    square = e * g - g12 * g12
    du, dv = (g * p - g12 * q) / square / (u1 - u0), (e * q - g12 * p) / square / (v1 - v0)
    size = 0.4 / _STROKES / np.hypot(du, dv)
    x, y = grid.length[j], grid.height[i]
    axis.plot([x - size * du, x + size * du], [y - size * dv, y + size * dv], color=GOUGE, lw=1.2)


def _worst_tangents(check: GougeCheck, f: FaceLook, at: NDArray) -> NDArray:
    normal = f.grid.normal.reshape(-1, 3)[at]
    uphill = approach(normal, check.axis).uphill
    angle = f.samples.comparison.worst[at][:, None]
    return np.asarray(np.cos(angle) * uphill + np.sin(angle) * np.cross(normal, uphill))
