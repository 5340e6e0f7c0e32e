"""The report, told to a gear engineer, figures first: one text for every kind of job."""

from __future__ import annotations

from typing import Any

from gearsim.output.markdown import VIEW_MARK, findings, not_drawn, pictures, provenance, verdict
from gearsim.output.presenters import SLOTS, collected
from gearsim.result import Result

_HEADINGS = {"trust": "## Can the number be trusted?\n\n"}
_FIRST = 2


def report_text(
    result: Result, figures: dict[str, Any], captions: dict[str, str], files: list[str], view: bool = False
) -> str:
    """The report as Markdown; ``captions`` of the pictures that were drawn, ``files`` all that lies beside it.

    ``view``: there is an interactive view; its place is marked.
    """
    told: dict[str, list[str]] = {slot: [] for slot in SLOTS}
    for sections in collected(result, "sections"):
        for slot, text in sections.items():
            told[slot].append(text)
    if figures["counts"]["rays"]:
        told["findings"].append(findings(figures))
    if result.job.notes:
        told["notes"].append("## Notes\n\n" + "".join(f"- {note}\n" for note in result.job.notes))
    names = list(captions)
    parts = [_head(result, figures), pictures({n: captions[n] for n in names[:_FIRST]}), f"\n{VIEW_MARK}\n" * view]
    parts += [_HEADINGS.get(slot, "") + "\n".join(t for t in told[slot] if t) for slot in SLOTS if any(told[slot])]
    parts += [pictures({n: captions[n] for n in names[_FIRST:]}), not_drawn(figures["not_drawn"])]
    return "\n".join(p for p in [*parts, provenance(figures, files)] if p)


def _head(result: Result, figures: dict[str, Any]) -> str:
    summary = result.scene.get("scene", {}).get("summary", "")
    if not figures["counts"]["rays"] and result.verdict == "pass":
        return f"# {result.name}\n\n{summary}\n\n{verdict(figures)}.\n"
    return (
        f"# {result.name}\n\n{summary}\n\n{verdict(figures)}.\n\nTolerances: {_tolerances(result)}.\n\n"
        "Deviation is measured along the outward normal of the intended surface: **positive is material left, "
        "negative is overcut**.\n"
    )


def _tolerances(result: Result) -> str:
    """Every tolerance, and what is held against it."""
    limits: dict[str, list[str]] = {}
    for name, surface in result.job.part.surfaces.items():
        if surface.tolerance is not None:
            limits.setdefault(surface.tolerance.text, []).append(name)
    for measured in result.measurements.values():
        for name, tolerance in getattr(measured, "tolerances", {}).items():  # of a whole part's own surfaces
            if name not in result.job.part.surfaces:
                limits.setdefault(tolerance.text, []).append(name)
    return "; ".join(f"{', '.join(names)}: {text}" for text, names in limits.items()) or "no surface has a tolerance"
