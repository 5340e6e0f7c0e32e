"""What ``gearsim gouge`` shows and writes of a surface looked at for local gouging."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from gearsim.cutters.contact import approach, contact_at
from gearsim.gouging.cases import CASES, case_numbers
from gearsim.gouging.compare import Decision
from gearsim.gouging.prediction import Prediction
from gearsim.gouging.surface import SurfaceContacts
from gearsim.output.charts import pyplot
from gearsim.output.exr import write_exr
from gearsim.output.gouging.charts import draw_sizes
from gearsim.output.gouging.curvature import GOUGE, draw_curvatures
from gearsim.output.gouging.maps import size_channels
from gearsim.output.gouging.plots import arcs_words, gouging_arcs, run_sheet
from gearsim.output.gouging.report import size_section
from gearsim.output.gouging.summary import size_figures, tool_words
from gearsim.output.gouging.write import size_notes
from gearsim.output.markdown import pictures, write_report
from gearsim.output.summary import SCHEMA_VERSION, number, write_json
from gearsim.result import GougeCheck

_STROKES = 24
_STEP = 1.0  # mm: the depth is told at this distance from the contact


def check_figures(check: GougeCheck) -> dict[str, Any]:
    """Everything report.json holds."""
    decision = check.samples.decision
    return {
        "schema_version": SCHEMA_VERSION,
        "surface": check.surface.name,
        "tool": tool_words(check.cutter),
        "tool_axis": [float(x) for x in check.axis],
        "device": check.device,
        "versions": check.versions,
        "seconds": round(check.timings_s["total"], 3),
        "points": int(decision.size),
        "gouging": int(np.count_nonzero(decision == Decision.GOUGES)),
        "tie": int(np.count_nonzero(decision == Decision.TIE)),
        "free": int(np.count_nonzero(decision == Decision.FREE)),
        "not_reached": int(np.count_nonzero(decision < 0)),
        "worst": None if check.worst < 0 else _worst(check),
        "tool_size": size_figures(check.sizes),
    }


def print_check(check: GougeCheck, console: Console) -> None:
    """The answer in a few lines."""
    figures = check_figures(check)
    share = 100.0 * figures["gouging"] / figures["points"]
    console.print(
        f"{figures['surface']}, {figures['tool']}, {figures['points']:,} points in {figures['seconds']:.2f} s"
    )
    style = "[bold red]gouges[/]" if figures["gouging"] else "[bold green]gouges nowhere[/]"
    console.print(
        f"{style}: {figures['gouging']:,} points gouge ({share:.3g} %), {figures['tie']:,} tie, "
        f"{figures['free']:,} free, {figures['not_reached']:,} out of reach"
    )
    for line in _words(figures["worst"]):
        console.print(line)
    for note in size_notes(check.sizes):
        console.print(note)


def write_check(check: GougeCheck, stage: Path) -> None:
    """Write report, pictures and maps into a folder."""
    figures = check_figures(check)
    _draw_map(check, stage / "gouging.png")
    draw_sizes(check.sizes, f"{check.name}: largest mill of the catalogue", size_notes(check.sizes),
               stage / "tool_size.png")  # fmt: skip
    if check.worst >= 0:
        point = _at(check.samples, check.worst)
        sheet = run_sheet(check.name, {"": point}, {"": tool_words(check.cutter)})
        draw_curvatures(sheet.plots, f"{check.name}: normal curvatures where it is tightest", sheet.zero,
                        stage / "curvature.png")  # fmt: skip
    write_exr({"gouging": _channels(check)}, check, stage / "gouging.exr")
    write_report(_report(figures, stage), check.name, stage)
    write_json(figures, stage / "report.json")


def _worst(check: GougeCheck) -> dict[str, Any]:
    i, grid = check.worst, check.sizes.grid
    f = check.samples.comparison
    u, v = grid.phi.ravel()[i], grid.v.ravel()[i]
    point = _at(check.samples, i)
    arcs = gouging_arcs(_single_comparison(point))
    return {
        "u": float(u),
        "v": float(v),
        "place_mm": [float(x) for x in grid.point.reshape(-1, 3)[i]],
        "contact_angle_deg": float(np.degrees(check.samples.contacts.theta[i])),
        "least_difference_per_mm": number(float(f.least[i])),
        "case": _case(check, i),
        "directions_deg": [[float(a), float(b)] for a, b in arcs],
        "depth_um_1_mm_beside": 1e3 * float(f.depth(_STEP)[i]),
    }


def _case(check: GougeCheck, i: int) -> str:
    """How the principal curvatures interleave at one point: Khan's case, or the seventh, in words."""
    contact = contact_at(check.cutter, check.samples.contacts.theta[i])
    low_tool, high_tool = sorted((float(contact.weaker), float(contact.around)))
    high, low, _ = check.samples.contacts.part[i].principal()
    case = CASES[int(case_numbers(high_tool, low_tool, high, low))]
    return f"case {case.number}, {case.condition}: {case.outcome} ({case.source})"


def _words(worst: dict[str, Any] | None) -> list[str]:
    if worst is None:
        return ["the tool reaches no point from its axis' side: are the normals turned towards it? (--flip turns them)"]
    place = ", ".join(f"{x:.4g}" for x in worst["place_mm"])
    where = f"at u = {worst['u']:.4g}, v = {worst['v']:.4g}, ({place}) mm"
    least = f"least difference of curvature {worst['least_difference_per_mm']:.4g}/mm"
    if not worst["directions_deg"]:
        return [f"tightest {where}: {least}", worst["case"]]
    return [
        f"worst {where}: {least}",
        worst["case"],
        f"there it cuts {worst['depth_um_1_mm_beside']:.3g} um deep 1 mm beside the contact, in the directions "
        f"{arcs_words(np.array(worst['directions_deg']))} (counter-clockwise from uphill)",
    ]


def _report(figures: dict[str, Any], stage: Path) -> str:
    answer = "**gouges**" if figures["gouging"] else "**gouges nowhere**"
    captions = {
        "gouging.png": "Tool's curvature minus the part's, least over all directions; strokes: worst directions",
        "tool_size.png": "The largest mill of the catalogue that does not gouge, point by point",
        "curvature.png": "Normal curvature of tool and part over the direction where it is tightest",
    }
    lines = "".join(f"- {line}\n" for line in _words(figures["worst"]))
    return (
        f"# {figures['surface']}\n\nThe {figures['tool']} {answer}: {figures['gouging']:,} of {figures['points']:,} "
        f"points gouge, {figures['tie']:,} tie, {figures['free']:,} are free, "
        f"{figures['not_reached']:,} out of reach.\n\n"
        f"{lines}\nLocal gouging only: elsewhere on the surface the tool may still hit it; a scene of kind `nurbs` "
        "cuts and tells.\n"
        + pictures({p: text for p, text in captions.items() if (stage / p).exists()})
        + "\n"
        + size_section(figures["tool_size"])
    )


def _channels(check: GougeCheck) -> dict[str, NDArray]:
    shape, f = check.sizes.grid.shape, check.samples.comparison
    known = check.samples.touches
    values = {
        "least_difference.per_mm": np.where(known, f.least, np.nan),
        "decision": check.samples.decision,
        "worst_direction.deg": np.where(known, np.degrees(f.worst), np.nan),
        "gouging_half_width.deg": np.where(known, np.degrees(f.half_width), np.nan),
        "contact_angle.deg": np.degrees(check.samples.contacts.theta),
    }
    return {**size_channels(check.sizes), **{k: v.reshape(shape) for k, v in values.items()}}


def _draw_map(check: GougeCheck, file: Path) -> None:
    """gouging.png: the least difference of curvature, the gouging region outlined, its worst directions as strokes."""
    plt = pyplot()
    grid, f = check.sizes.grid, check.samples.comparison
    least = np.where(check.samples.touches, f.least, np.nan).reshape(grid.shape)
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
        _strokes(axis, check, least)
        row, column = np.unravel_index(check.worst, grid.shape)
        axis.plot(grid.length[column], grid.height[row], "o", mfc="none", mec="k", ms=10, mew=1.6)
    axis.set_xlabel("u [share of the domain]")
    axis.set_ylabel("v [share of the domain]")
    gouging = int(check.samples.gouges.sum())
    axis.set_title(
        f"{check.name}, {tool_words(check.cutter)}\n{gouging:,} of {least.size:,} points gouge; circle: the tightest; "
        "grey: out of reach", fontsize=11,
    )  # fmt: skip
    figure.savefig(file, dpi=110)
    plt.close(figure)


def _strokes(axis: Any, check: GougeCheck, least: NDArray) -> None:
    """Worst directions at some gouging points, as they run in the picture."""
    grid = check.sizes.grid
    rows, columns = (np.unique(np.linspace(0, n - 1, _STROKES).astype(int)[1:-1]) for n in grid.shape)
    i, j = (a.ravel() for a in np.meshgrid(rows, columns, indexing="ij"))
    shown = least[i, j] < -1e-9
    i, j = i[shown], j[shown]
    if not len(i):
        return
    at = i * grid.shape[1] + j
    way = _worst_tangents(check, at)
    jet = check.surface.jet(grid.phi.ravel()[at], grid.v.ravel()[at])
    e, f, g = (np.einsum("ni,ni->n", a, b) for a, b in ((jet.ru, jet.ru), (jet.ru, jet.rv), (jet.rv, jet.rv)))
    p, q = (np.einsum("ni,ni->n", way, d) for d in (jet.ru, jet.rv))
    (u0, u1), (v0, v1) = check.surface.domain
    du, dv = (g * p - f * q) / (e * g - f * f) / (u1 - u0), (e * q - f * p) / (e * g - f * f) / (v1 - v0)
    size = 0.4 / _STROKES / np.hypot(du, dv)
    x, y = grid.length[j], grid.height[i]
    axis.plot([x - size * du, x + size * du], [y - size * dv, y + size * dv], color=GOUGE, lw=1.2)


def _worst_tangents(check: GougeCheck, at: NDArray) -> NDArray:
    normal = check.sizes.grid.normal.reshape(-1, 3)[at]
    uphill = approach(normal, check.axis).uphill
    angle = check.samples.comparison.worst[at][:, None]
    return np.cos(angle) * uphill + np.sin(angle) * np.cross(normal, uphill)


def _at(found: Prediction, i: int) -> Prediction:
    """The prediction at one point."""
    f = found.comparison
    one = type(f)(*(np.atleast_1d(x[i]) for x in (f.mean, f.amplitude, f.phase, f.least)))
    contacts = SurfaceContacts(found.contacts.theta[i : i + 1], found.contacts.part[i : i + 1])
    return Prediction(contacts, one, found.touches[i : i + 1])


def _single_comparison(found: Prediction) -> Any:
    f = found.comparison
    return type(f)(*(x[0] for x in (f.mean, f.amplitude, f.phase, f.least)))
