"""The error budget in the report: one cause a line, and what the lines say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from gearsim.metrology.gear_budget import BudgetMeasurement
from gearsim.output.gear.words import exactly, order, size
from gearsim.output.markdown import table
from gearsim.output.summary import number
from gearsim.result import Result

_NAMES = ("f_Halpha", "f_falpha", "F_alpha", "f_Hbeta", "f_fbeta", "F_beta", "F_p")
_CONTROL = "tool-centre-point control"
_LINEAR = "all axes linear"


def figures(m: BudgetMeasurement) -> dict[str, Any]:
    return {"lines": [_plain(asdict(line)) for line in m.lines]}


def _plain(line: dict[str, Any]) -> dict[str, Any]:
    """A budget line with null for what is nan."""
    parameters = {k: None if v is None else number(v) for k, v in line.pop("parameters").items()}
    values = {k: number(v) if isinstance(v, float) else v for k, v in line.items()}
    return {**values, "parameters_um": parameters}


def sections(_: Result, found: Sequence[BudgetMeasurement]) -> dict[str, str]:
    return {"costs": error_budget(figures(found[0])["lines"])}


def error_budget(lines: list[dict[str, Any]]) -> str:
    """Table and reading; nothing for a budget without lines."""
    if not lines:
        return ""
    rows = [
        [
            line["cause"], _amount(line), *(size(line["parameters_um"].get(name)) for name in _NAMES),
            size(line["runout_um"]), size(line["largest_um"]), size(line["mean_um"]),
        ]
        for line in lines
    ]  # fmt: skip
    head = ["Cause alone", "size", *_NAMES, "F_r", "largest", "mean"]
    said = [*_method(lines), *_steps(lines), *_decimals(lines), *_workshop(lines)]
    return (
        "## Error budget\n\nSpace 1 cut again by the finishing operation, each time with one cause of deviations alone "
        "(eccentricity: all spaces). Transverse, the worse side; `largest` and `mean` of all samples of the traces.\n\n"
        + table(head, rows)
        + "\n"
        + "".join(f"- {sentence}\n" for sentence in said)
    )


def _of(lines: list[dict[str, Any]], cause: str, ending: str = "") -> list[dict[str, Any]]:
    return [line for line in lines if line["cause"] == cause and line["size"].endswith(ending)]


def _number(line: dict[str, Any]) -> float:
    """The number that a size begins with."""
    return float(line["size"].split()[0])


def _amount(line: dict[str, Any]) -> str:
    return str(line["size"]).replace(" um", " µm")


def _method(lines: list[dict[str, Any]]) -> list[str]:
    return [
        f"With {line['size']} the flank lies within **{exactly(line['largest_um'])}** of the design: that is what the "
        "method itself costs."
        for line in _of(lines, "none")
    ]


def _steps(lines: list[dict[str, Any]]) -> list[str]:
    """What the steps along the involute and along the axis cost, by interpolation."""
    said = []
    for cause, name in (("involute step", "F_alpha"), ("axial step", "F_beta")):
        linear, control = _of(lines, cause, _LINEAR), _of(lines, cause, _CONTROL)
        if linear:
            coarsest, worst = max(map(_number, linear)), max(line["largest_um"] for line in linear)
            said.append(f"With {_LINEAR} an {cause} of up to {coarsest:g} mm costs {exactly(worst)} at most.")
        if control:
            said.append(f"Under {_CONTROL} {_chords(cause, name, control)}")
    return said


def _chords(cause: str, name: str, lines: list[dict[str, Any]]) -> str:
    """A sentence on the straight chords that the tool's tip runs between the points."""
    ordered = sorted(lines, key=_number, reverse=True)
    values = [line["parameters_um"].get(name) or 0.0 for line in ordered]
    steps = [_number(line) for line in ordered]
    costs = ", ".join(f"{size(v)} at {h:g} mm" for h, v in zip(steps, values, strict=True))
    power = order(steps, values)
    if power is None:
        return f"the {cause} leaves no {name} that could be told from nothing ({costs})."
    if abs(power) < 0.2:
        return f"{name} hardly depends on the {cause} ({costs}): it comes from the chords across it."
    return f"the chords cost {name} {costs}: it falls with the {cause} to the power {power:.2f}."


def _decimals(lines: list[dict[str, Any]]) -> list[str]:
    found = sorted(_of(lines, "decimals"), key=_number)
    if not found:
        return []
    costs = ", ".join(f"{_number(line):g} decimals {size(line['largest_um'])}" for line in found)
    first, last = found[0], found[-1]
    steps = _number(last) - _number(first)
    if not steps or not first["largest_um"] or not last["largest_um"]:
        return [f"Numbers rounded to decimals (mm and deg) cost: {costs}."]
    fall = (first["largest_um"] / last["largest_um"]) ** (1.0 / steps)
    return [f"Numbers rounded to decimals (mm and deg) cost: {costs}; each further one divides it by {fall:.1f}."]


def _workshop(lines: list[dict[str, Any]]) -> list[str]:
    said = [
        f"A {cause} of {_amount(line)} moves the flanks by up to {size(line['largest_um'])}, "
        f"{size(line['mean_um'])} on average; {_alone(line, 'F_alpha')}, {_alone(line, 'F_beta')}."
        for cause in ("tool radius", "tool runout", "pivot offset")
        for line in _of(lines, cause)
    ]
    said += [
        f"A mounting eccentricity of {_amount(line)} makes {_alone(line, 'F_p')} and a runout F_r of "
        f"{size(line['runout_um'])}."
        for line in _of(lines, "mounting eccentricity")
    ]
    return said


def _alone(line: dict[str, Any], name: str) -> str:
    return f"{name} {size(line['parameters_um'].get(name))}"
