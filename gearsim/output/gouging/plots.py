"""What the curvature pictures show: contacts of a run, and the worked examples by section."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import radians

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.contact import end_mill_contact
from gearsim.gouging.compare import Comparison, Decision, compare
from gearsim.gouging.khan.examples import GOUGING_EXAMPLES, GougingExample
from gearsim.gouging.khan.examples_border import BORDER, MILLS, border_results, direction_angle, patch_tensors, theta0
from gearsim.gouging.khan.examples_sizes import SizeExample, size_examples
from gearsim.gouging.khan.worked import arcs_of
from gearsim.gouging.prediction import Prediction
from gearsim.gouging.tensors import principal_tensor, tool_tensor
from gearsim.output.gouging.curvature import CurvaturePlot, Piece

FROM_TOOL = "the tool's uphill meridian"
FROM_PART = "the part's greatest curvature"


@dataclass(frozen=True)
class Sheet:
    """One picture: its file, heading, what direction is 0, and its contacts."""

    file: str
    heading: str
    zero: str
    plots: tuple[CurvaturePlot, ...]


def run_sheet(name: str, tools: dict[str, Prediction], labels: dict[str, str]) -> Sheet:
    """The contact of a run under every tool."""
    plots = tuple(prediction_plot(labels[k], p) for k, p in tools.items() if p.touches[0])
    return Sheet("curvature.png", f"{name}: normal curvatures at the plotted contact", FROM_TOOL, plots)


def prediction_plot(title: str, found: Prediction) -> CurvaturePlot:
    """One contact of a prediction of a single point."""
    part, f = found.contacts.part[0], _single(found.comparison)
    rim = float(f.least + part.c) if np.isinf(f.mean) else None
    pieces, arcs = (Piece("part", part.at),), gouging_arcs(f)
    return CurvaturePlot(title, lambda a: part.at(a) + f.at(a), pieces, arcs, _decision(f), rim)


def gouging_arcs(f: Comparison, offset: float = 0.0) -> NDArray:
    """Gouging directions [deg] of one contact, shape (n, 2)."""
    if f.decision != Decision.GOUGES:
        return np.empty((0, 2))
    if f.half_width >= 0.5 * np.pi - 1e-12:
        return np.array([(0.0, 360.0)])
    low, high = (float(x) + offset for x in f.interval)
    return arcs_of(np.array([(low, high), (low + np.pi, high + np.pi)]))


def example_sheets(sections: Sequence[str]) -> list[Sheet]:
    """Pictures of the worked examples of the given sections that are known by numbers."""
    sheets = []
    for section in sections:
        chosen = [e for e in GOUGING_EXAMPLES if e.section == section]
        if chosen:
            zero = FROM_PART if section.startswith("6.1") else FROM_TOOL
            plots = tuple(_example(e) for e in chosen)
            sheets.append(Sheet(f"curvature-{section.replace('.', '-')}.png", f"Khan {section}", zero, plots))
    sizes = [e for e in size_examples() if e.section in sections and len(e.theta) == 1]
    if sizes:
        sheets.append(Sheet("curvature-sizes.png", "Khan chapter 7: the mill that fits", FROM_TOOL,
                            tuple(p for e in sizes for p in _size(e))))  # fmt: skip
    if "9.6.1" in sections or "9.6.2" in sections:
        plots = tuple(_border(*mill[:3]) for mill in MILLS if mill[0] in sections)
        sheets.append(
            Sheet("curvature-border.png", "Khan 9.6: a contact on the border of two patches", FROM_TOOL, plots)
        )
    return sheets


def arcs_words(arcs: NDArray) -> str:
    """Arcs [deg] in words, those that meet (at 0 or at a border) joined."""
    joined: list[list[float]] = []
    for start, end in np.asarray(arcs):
        if joined and abs(start - joined[-1][1]) < 1e-6:
            joined[-1][1] = end
        else:
            joined.append([start, end])
    if len(joined) > 1 and joined[0][0] < 1e-6 and joined[-1][1] > 360.0 - 1e-6:
        joined[0][0] = joined.pop()[0]
    return ", ".join(f"{a:.1f}–{b:.1f}°" for a, b in joined)


def _single(f: Comparison) -> Comparison:
    return Comparison(*(np.asarray(x).reshape(-1)[0] for x in (f.mean, f.amplitude, f.phase, f.least)))


def _decision(f: Comparison) -> str:
    if f.decision == Decision.GOUGES:
        return _gouges(gouging_arcs(f))
    return "tie: second order does not tell" if f.decision == Decision.TIE else "free in all directions"


def _gouges(arcs: NDArray) -> str:
    if len(arcs) == 1 and arcs[0, 1] - arcs[0, 0] >= 360.0:
        return "gouges in all directions"
    return f"gouges in {arcs_words(arcs)}"


def _example(e: GougingExample) -> CurvaturePlot:
    high, low = e.tool_curvatures()
    tool, part = principal_tensor(high, low, radians(e.offset)), principal_tensor(*e.part, radians(e.alpha0 + e.offset))
    f = e.comparison()
    arcs = e.gouging_arcs()
    decision = _gouges(arcs) if len(arcs) else _decision(f)
    return CurvaturePlot(e.name, tool.at, (Piece("part", part.at),), arcs, decision)


def _size(e: SizeExample) -> list[CurvaturePlot]:
    """Khan's mill as we run his algorithm, and where print has another that one, at the contact of an example."""
    mills = {"his algorithm": e.khan, "printed": e.printed}
    if e.printed is not None and np.allclose(e.printed, e.khan, atol=0.05):
        mills = {"his algorithm, as printed": e.khan}
    plots = []
    for what, mill in mills.items():
        if mill is None or not np.all(np.isfinite(mill)):
            continue
        f = compare(tool_tensor(end_mill_contact(*mill, e.theta[0])), e.part[0])
        tool = tool_tensor(end_mill_contact(*mill, e.theta[0]))
        title = f"{e.section} {e.name}\n{what}: R = {mill[0]:g}, r = {mill[1]:.4g}"
        plots.append(CurvaturePlot(title, tool.at, (Piece("part", e.part[0].at),), gouging_arcs(f), _decision(f)))
    return plots


def _border(section: str, shank: float, corner: float) -> CurvaturePlot:
    start = direction_angle(BORDER) % (2.0 * np.pi)
    tensors = list(patch_tensors().items())
    ends = ((start, start + np.pi), (start + np.pi, start + 2.0 * np.pi))
    pieces = tuple(Piece(name, t.at, *e) for (name, t), e in zip(tensors, ends, strict=True))
    arcs = arcs_of(np.array([a for r in border_results(shank, corner) for a in r.gouging]))
    tool = tool_tensor(end_mill_contact(shank, corner, theta0()))
    decision = _gouges(arcs) if len(arcs) else "free in all directions"
    return CurvaturePlot(f"{section}: R = {shank:g}, r = {corner:g}", tool.at, pieces, arcs, decision,
                         borders=(start, start + np.pi))  # fmt: skip
