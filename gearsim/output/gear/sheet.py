"""The inspection sheet: gear data, parameters with tolerances and classes, traces and pitches on one page."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import Any

import numpy as np

from gearsim.metrology.gear_inspection import GearInspection, InspectionRow
from gearsim.output.colours import OUT
from gearsim.output.gear.pitch import draw_pitch_panels
from gearsim.output.gear.style import SYMBOLS, unit_for
from gearsim.output.gear.traces import draw_trace_panels
from gearsim.output.panels import pyplot
from gearsim.output.saving import Save
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear

_WIDTH, _HEIGHT = 11.0, 15.5
_LEFT, _PANEL, _BETWEEN = 0.85, 4.3, 0.8
_LINE = 0.205
_DESCENT = 0.045  # of the lines of a text
_SIGNS = "values are transverse; slopes are + where material grows to the tip, or away from the datum face"


def inspection_sheet(inspection: GearInspection, save: Save) -> None:
    """One page; lengths in inches from its lower left corner. Raises InputError outside ISO 1328-1's scope."""
    plt = pyplot()
    figure = plt.figure(figsize=(_WIDTH, _HEIGHT))
    _header(figure, inspection)
    tolerances = inspection.tolerances_um
    for bottom, height, traces, what in (
        (8.45, 3.0, inspection.profile, "Profile"),
        (4.4, 2.4, inspection.helix, "Helix"),
    ):
        axes = [_place(figure, x, bottom, _PANEL, height) for x in _columns()]
        _heading(figure, bottom + height + 0.68, what)
        draw_trace_panels(axes, traces, inspection.gear, tolerances, 6.5)
    _heading(figure, 3.2, "Pitch")
    rows = [[_place(figure, x, bottom, _PANEL, 0.95) for x in _columns()] for bottom in (1.8, 0.42)]
    draw_pitch_panels(np.array(rows), inspection.pitch, tolerances, 6.5)
    save(figure, "inspection.png", 130)


def _columns() -> tuple[float, float]:
    return _LEFT, _LEFT + _PANEL + _BETWEEN


def _place(figure: Any, left: float, bottom: float, width: float, height: float) -> Any:
    return figure.add_axes((left / _WIDTH, bottom / _HEIGHT, width / _WIDTH, height / _HEIGHT))


def _text(figure: Any, x: float, y: float, text: str, **style: Any) -> None:
    figure.text(x / _WIDTH, y / _HEIGHT, text, va="baseline", **({"fontsize": 8} | style))


def _column(figure: Any, x: float, y: float, lines: Sequence[str], **style: Any) -> None:
    """Lines of one style under each other, the first on a baseline at y, as one text: that is drawn faster."""
    style = {"fontsize": 8} | style
    spacing = 72.0 * _LINE / style["fontsize"]
    figure.text(
        x / _WIDTH, (y + _LINE - _DESCENT) / _HEIGHT, "\n".join(lines), va="top", linespacing=spacing, **style
    )  # fmt: skip


def _rule(figure: Any, y: float, x: Sequence[float], width: float) -> None:
    from matplotlib.lines import Line2D

    ends = [v / _WIDTH for v in x]
    figure.add_artist(Line2D(ends, [y / _HEIGHT] * 2, color="k", lw=width))


def _heading(figure: Any, y: float, text: str) -> None:
    _rule(figure, y + 0.16, (0.35, _WIDTH - 0.35), 0.6)
    _text(figure, 0.35, y - 0.03, text, fontsize=10, weight="bold")


def _header(figure: Any, inspection: GearInspection) -> None:
    top = _HEIGHT - 0.5
    _text(figure, 0.35, top, f"{inspection.title}: inspection of the gear flanks", fontsize=15, weight="bold")
    _rule(figure, top - 0.36, (0.35, _WIDTH - 0.35), 1.2)
    for column, part in enumerate(_gear_data(inspection)):
        names, values = zip(*part, strict=True)
        _column(figure, 0.35 + 2.35 * column, top - 0.62, names, color="0.35")
        _column(figure, 2.35 + 2.35 * column, top - 0.62, values, ha="right")
    _parameters(figure, top - 0.62, inspection)


def _gear_data(inspection: GearInspection) -> tuple[list[tuple[str, str]], list[tuple[str, str]]]:
    gear = inspection.gear
    angle = degrees(gear.helix_angle)
    hand = "" if angle == 0.0 else " right" if angle > 0.0 else " left"
    span = next(iter(inspection.profile.values())).span
    shape = [
        ("kind", "internal" if gear.is_internal else "external"),
        ("teeth z", f"{gear.teeth}".replace("-", "−")),
        ("normal module", f"{gear.module:.4g} mm"),
        ("transverse module", f"{gear.transverse_module:.4g} mm"),
        ("pressure angle αn", f"{degrees(gear.pressure_angle):.4g}°"),
        ("helix angle", f"{abs(angle):.4g}°{hand}"),
        ("face width b", f"{gear.facewidth:.4g} mm"),
        ("profile shift x", f"{gear.profile_shift:.4g}"),
    ]
    circles = [
        ("reference dia.", f"{2.0 * gear.reference_radius:.3f} mm"),
        ("base dia.", f"{2.0 * gear.base_radius:.3f} mm"),
        ("tip dia.", f"{2.0 * gear.tip_radius:.3f} mm"),
        ("root dia.", f"{2.0 * gear.root_radius:.3f} mm"),
        ("profile from dia.", _diameter(gear, span.first)),
        ("profile to dia.", _diameter(gear, span.last)),
        _helix_span(inspection),
        ("runout Fr", _with_unit(inspection.runout.total)),
    ]
    return shape, circles


def _helix_span(inspection: GearInspection) -> tuple[str, str]:
    span = next(iter(inspection.helix.values())).span
    return "helix z", f"{span.first:.2f} to {span.last:.2f} mm".replace("-", "−")


def _diameter(gear: CylindricalGear, roll_length: float) -> str:
    return f"{2.0 * float(gear.radius(roll_length / gear.base_radius)):.3f} mm"


def _with_unit(um: float) -> str:
    unit = unit_for([um])
    return f"{unit.text(um)} {unit.name}" if np.isfinite(um) else "not measured"


def _parameters(figure: Any, y: float, inspection: GearInspection) -> None:
    """The table of parameters: tolerance of the class asked for, largest value of each side, class achieved."""
    columns = (5.25, 6.75, 7.85, 8.95, 10.6)
    _text(figure, columns[0], y, "ISO 1328-1", weight="bold")
    heads = (f"class {inspection.gear_class}", *SIDES, "class achieved")
    for x, head in zip(columns[1:], heads, strict=True):
        _text(figure, x, y, head, ha="right", weight="bold")
    _rule(figure, y - 0.07, (5.2, _WIDTH - 0.35), 0.6)
    rows, first = inspection.rows(), y - 0.23
    _column(figure, columns[0], first, [SYMBOLS[row.parameter] for row in rows], fontsize=9)
    _column(figure, columns[1], first, [_tolerance(row) for row in rows], ha="right")
    for x, side in zip(columns[2:4], SIDES, strict=True):
        cells = [(_with_unit(row.value_um[side]), abs(row.value_um[side]) <= row.tolerance_um) for row in rows]
        _cells(figure, x, first, cells)
    _cells(figure, columns[4], first, [(_achieved(row), row.within) for row in rows])
    _text(figure, columns[0], y - 0.23 - _LINE * 8.2, _SIGNS, fontsize=7, color="0.35")


def _cells(figure: Any, x: float, y: float, cells: Sequence[tuple[str, bool]]) -> None:
    """A column of texts; one that is not within its tolerance stands out, and then each is a text of its own."""
    if all(within for _, within in cells):
        _column(figure, x, y, [text for text, _ in cells], ha="right")
        return
    for i, (text, within) in enumerate(cells):
        _text(figure, x, y - _LINE * i, text, ha="right", **({} if within else {"color": OUT, "weight": "bold"}))


def _tolerance(row: InspectionRow) -> str:
    return f"{'±' if row.parameter.startswith('f_H') else ''}{row.tolerance_um:g} µm"


def _achieved(row: InspectionRow) -> str:
    return f"{row.achieved}" if row.achieved else f"{row.incomplete} missing" if row.incomplete else "> 11"
