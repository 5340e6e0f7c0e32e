"""What ``gearsim verify`` tells: a table on the screen, and JSON with units in its keys."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from importlib.metadata import version
from math import isfinite
from platform import python_version
from typing import Any

from rich.console import Console
from rich.table import Table

import gearsim
from gearsim.verify.checks import CHECKS, SIGN_STEP, Check, FormReport, Limits

SCHEMA_VERSION = 1
_STYLES = {"pass": "green", "fail": "bold red", "nothing": "dim"}
UNITS = {"distance": "mm", "sign": "mm", "normal": "rad", "curvature": "relative"}


@dataclass(frozen=True)
class SubjectReport:
    """A scene, surface file or point list with its closed forms; none: it declares none."""

    name: str
    forms: tuple[FormReport, ...]
    seconds: float

    @property
    def verdict(self) -> str:
        """``pass``, ``fail``, or ``none`` where nothing is declared; nothing checked at all is a failure."""
        if not self.forms:
            return "none"
        verdicts = {f.verdict for f in self.forms}
        return "fail" if "fail" in verdicts or "pass" not in verdicts else "pass"


def exit_code(subjects: list[SubjectReport]) -> int:
    """0: every declared closed form passed; 1: not."""
    return int(any(s.verdict == "fail" for s in subjects))


def summary(subjects: list[SubjectReport], limits: Limits, seed: int) -> dict[str, Any]:
    """Everything the JSON file holds."""
    return {
        "schema_version": SCHEMA_VERSION,
        "versions": {"gearsim": gearsim.__version__, "python": python_version(), "numpy": version("numpy")},
        "verdict": "fail" if exit_code(subjects) else "pass",
        "seed": seed,
        "limits": {
            "distance_mm": limits.distance_mm,
            "sign_step_mm": SIGN_STEP,
            "normal_rad": limits.normal_rad,
            "curvature_relative": limits.curvature,
        },
        "subjects": [
            {"name": s.name, "verdict": s.verdict, "time_s": round(s.seconds, 3), "forms": [_form(f) for f in s.forms]}
            for s in subjects
        ],
    }


def _form(form: FormReport) -> dict[str, Any]:
    return {
        "name": form.name,
        "flank": form.flank,
        "verdict": form.verdict,
        "points": form.points,
        "missing": form.missing,
        "trimmed": form.trimmed,
        "certain_mm": form.certain_mm,
        "checks": {name: _check(name, check) for name, check in form.checks.items()},
    }


def _check(name: str, check: Check) -> dict[str, Any]:
    return {
        "checked": check.checked,
        "failed": check.failed,
        "unsettled": check.unsettled,
        f"worst_{UNITS[name]}": None if check.worst is None or not isfinite(check.worst) else check.worst,
        "place_mm": check.place_mm,
        **({"inward": check.inward} if name == "sign" else {}),
    }


def print_report(subjects: list[SubjectReport]) -> None:
    """One table per subject that declares closed forms, and a line for each of the others."""
    console = Console(highlight=False, width=None if sys.stdout.isatty() else 130)
    for subject in subjects:
        if subject.verdict == "none":
            console.print(f"{subject.name}: declares no closed form", markup=False)
            continue
        console.print(_table(subject))
        for line in _findings(subject):
            console.print(line, markup=False)
    declared = [s for s in subjects if s.verdict != "none"]
    good = sum(s.verdict == "pass" for s in declared)
    seconds = sum(s.seconds for s in subjects)
    console.print(
        f"{good} of {len(declared)} passed, {len(subjects) - len(declared)} without closed form; {seconds:.1f} s"
    )


def _table(subject: SubjectReport) -> Table:
    table = Table(title=f"{subject.name}: closed form against brute force, worst errors", title_style="bold")
    table.add_column("closed form")
    for head in (
        "points",
        "missing",
        "trimmed",
        "distance mm",
        "sign",
        "normal rad",
        "curvature",
        "unsettled",
        "verdict",
    ):
        table.add_column(head, justify="right")
    for form in subject.forms:
        cells = [_cell(name, form.checks.get(name)) for name in CHECKS]
        unsettled = str(max((c.unsettled for c in form.checks.values()), default=0))
        verdict = f"[{_STYLES[form.verdict]}]{form.verdict}[/]"
        table.add_row(form.name, *map(str, (form.points, form.missing, form.trimmed)), *cells, unsettled, verdict)
    return table


def _cell(name: str, check: Check | None) -> str:
    if check is None or check.worst is None:
        return "-"
    text = ("right" if not check.failed else f"{check.failed} wrong") if name == "sign" else f"{check.worst:.1e}"
    return text if check.passed else f"[bold red]{text}[/]"


def _inward(c: Check) -> str:
    """How many normals need only be turned round."""
    number = "all" if c.inward == c.checked else f"{c.inward} of {c.checked}"
    return (
        f"{number} normals point into the material; turned round they are right: out of the gear, into the tool (which "
        "way a point list's normals point is said by its '# sign:')"
    )


def _findings(subject: SubjectReport) -> list[str]:
    """What failed, and where to look."""
    lines = []
    for form in subject.forms:
        for name, c in form.checks.items():
            if c.failed and c.place_mm:
                place = ", ".join(f"{x:.6f}" for x in c.place_mm)
                lines.append(f"FAILS {form.name}: {name}: {c.failed} of {c.checked} points, worst at ({place}) mm")
                lines += [f"{form.name}: {_inward(c)}"] if c.inward else []
            elif not c.passed:
                lines.append(
                    f"FAILS {form.name}: {name}: differences of its points settle at only {c.checked} of "
                    f"{c.checked + c.unsettled} points; is points(u, v) smooth, in double precision?"
                )
    if subject.verdict == "fail" and not lines:
        lines.append(f"FAILS {subject.name}: there was no point to check: all are missing or trimmed")
    return lines
