"""What ``gearsim gouge`` shows and writes of faces looked at for local gouging."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.markup import escape

from gearsim.cutters.contact import contact_at
from gearsim.gouging.check import GougeCheck, TightPlace
from gearsim.gouging.compare import TIE, Decision, decide
from gearsim.gouging.junctions import Join
from gearsim.gouging.khan.cases import CASES, case_numbers
from gearsim.gouging.looked import FaceLook
from gearsim.output.exr import header, write_exr
from gearsim.output.gouging.check_maps import draw_faces, face_channels
from gearsim.output.gouging.curvature import draw_curvatures
from gearsim.output.gouging.plots import arcs_words, gouging_arcs, run_sheet
from gearsim.output.gouging.words import size_notes, tool_words, whole_figures, whole_section
from gearsim.output.markdown import pictures, table, verdict, write_report
from gearsim.output.saving import Save
from gearsim.output.summary import SCHEMA_VERSION, number, write_json
from gearsim.result import versions

_STEP = 1.0  # mm: the depth is told at this distance from the contact
_HEADS = ("face", "points", "gouging", "tie", "free", "out of reach", "least difference [1/mm]", "material side")


def check_figures(check: GougeCheck) -> dict[str, Any]:
    """Everything report.json holds."""
    faces = [_face(f) for f in check.looks]
    keys = ("points", "gouging", "tie", "free", "not_reached")
    return {
        "schema_version": SCHEMA_VERSION,
        "surface": check.name,
        "verdict": check.verdict,
        "status": check.status,
        "headline": check.headline,
        "tool": tool_words(check.cutter),
        "tool_axis": [float(x) for x in check.axis],
        "device": check.device,
        "versions": versions(),
        "seconds": round(check.seconds, 3),
        **{k: sum(f[k] for f in faces) for k in keys},
        "spacing_mm": max(f["spacing_mm"] for f in faces),
        "turn_deg": max(f["turn_deg"] for f in faces),
        "faces": faces,
        "meetings": _meetings(check),
        "worst": None if check.worst is None else _worst(check, check.worst),
        "tool_size": whole_figures(check.whole, check.place),
        "skipped": list(check.skipped),
        "faces_left_out": check.left_out,
        "notes": list(check.notes),
    }


def print_check(check: GougeCheck, console: Console) -> None:
    """The answer in a few lines."""
    figures = check_figures(check)
    console.print(escape(f"{figures['surface']}, {figures['tool']}, {figures['points']:,} points in "
                         f"{figures['seconds']:.2f} s"))  # fmt: skip
    style = {"fail": "bold red", "pass": "bold green", "unchecked": "bold yellow"}[check.verdict]
    console.print(f"[{style}]{_answer(check)}[/]: {escape(_counts(figures))}")
    if len(check.looks) > 1:
        for line in _table(figures):
            console.print(line, markup=False)
    for line in _lines(check, figures):
        console.print(line, markup=False)
    console.print(f"verdict: [{style}]{check.verdict}[/]: {escape(check.headline)}")


def write_check(check: GougeCheck, stage: Path) -> None:
    """Write report, pictures and maps into a folder."""
    figures = check_figures(check)
    save = Save(stage)
    drawn = draw_faces(check, size_notes(check.whole, check.place), save)
    if check.worst is not None and check.worst.contact is not None:
        sheet = run_sheet(check.name, {"": check.worst.contact}, {"": tool_words(check.cutter)})
        draw_curvatures(sheet.plots, f"{check.name}: normal curvatures where it is tightest", sheet.zero,
                        "curvature.png", save)  # fmt: skip
        drawn["curvature.png"] = "Normal curvature of tool and part over the direction where it is tightest"
    names = ["gouging"] if len(check.looks) == 1 else [f.face.name for f in check.looks]
    channels = {n: face_channels(check, f) for n, f in zip(names, check.looks, strict=True)}
    write_exr(channels, header(check.name, check.frame), stage / "gouging.exr")
    write_report(_report(check, figures, drawn), check.name, stage)
    write_json(figures, stage / "report.json")


def _face(f: FaceLook) -> dict[str, Any]:
    decision = f.decision
    values = np.concatenate([
        np.where(p.touches, p.comparison.least, np.inf) for p in (f.samples, f.tight)
    ])  # fmt: skip
    return {
        "name": f.face.name,
        "material_side": f.face.side,
        "points": int(decision.size),
        "gouging": int(np.count_nonzero(decision == Decision.GOUGES)),
        "tie": int(np.count_nonzero(decision == Decision.TIE)),
        "free": int(np.count_nonzero(decision == Decision.FREE)),
        "not_reached": int(np.count_nonzero(decision < 0)),
        "least_difference_per_mm": number(float(np.min(values, initial=np.inf))),
        "spacing_mm": f.lines.spacing,
        "turn_deg": float(np.degrees(f.lines.turn)),
    }


def _meetings(check: GougeCheck) -> dict[str, Any]:
    """Places on borders and knot lines by how the sides meet there, and at how many the tool gouges."""
    kinds, least = check.met.kinds(), check.least_at_places
    names = {-1: "border", **{int(k): k.name.lower() for k in Join}}
    out: dict[str, Any] = {"tolerance_mm": check.tolerance}
    for kind, name in names.items():
        mine = least[kinds == kind]
        out[name] = {"places": len(mine), "gouging": int(np.count_nonzero(mine < -TIE)),
                     "tie": int(np.count_nonzero(np.abs(mine) <= TIE))}  # fmt: skip
    return out


def _worst(check: GougeCheck, w: TightPlace) -> dict[str, Any]:
    out: dict[str, Any] = {
        "face": check.looks[w.face].face.name,
        "where": w.meets or "face",
        "with_face": check.looks[w.with_face].face.name if w.with_face >= 0 else None,
        "u": w.u,
        "v": w.v,
        "place_mm": list(w.point),
        "least_difference_per_mm": number(w.least),
        "gouges": bool(decide(np.asarray(w.least)) == Decision.GOUGES),
    }
    if w.contact is None:
        return out
    f = w.contact.comparison
    arcs = gouging_arcs(type(f)(*(x[0] for x in (f.mean, f.amplitude, f.phase, f.least))))
    return out | {
        "contact_angle_deg": float(np.degrees(w.contact.contacts.theta[0])),
        "case": _case(check, w),
        "directions_deg": [[float(a), float(b)] for a, b in arcs],
        "depth_um_1_mm_beside": 1e3 * float(f.depth(_STEP)[0]),
    }


def _case(check: GougeCheck, w: TightPlace) -> str:
    """How the principal curvatures interleave at one point: Khan's case, or the seventh, in words."""
    assert w.contact is not None
    contact = contact_at(check.cutter, w.contact.contacts.theta[0])
    low_tool, high_tool = sorted((float(contact.weaker), float(contact.around)))
    high, low, _ = w.contact.contacts.part[0].principal()
    case = CASES[int(case_numbers(high_tool, low_tool, high, low))]
    return f"case {case.number}, {case.condition}: {case.outcome} ({case.source})"


def _answer(check: GougeCheck) -> str:
    if check.verdict == "unchecked":
        return "unchecked"
    return "gouges" if check.verdict == "fail" else "gouges nowhere"


def _counts(figures: dict[str, Any]) -> str:
    share = 100.0 * figures["gouging"] / max(figures["points"], 1)
    met = sum(m["gouging"] for m in figures["meetings"].values() if isinstance(m, dict))
    return (
        f"{figures['gouging']:,} points gouge ({share:.3g} %), {figures['tie']:,} tie, {figures['free']:,} free, "
        f"{figures['not_reached']:,} out of reach"
        + (f"; {met:,} places at borders and where faces meet gouge" if met else "")
    )


def _rows(figures: dict[str, Any]) -> list[list[str]]:
    rows = []
    for f in figures["faces"]:
        least = "–" if f["least_difference_per_mm"] is None else f"{f['least_difference_per_mm']:.4g}"
        counts = [f"{f[k]:,}" for k in ("points", "gouging", "tie", "free", "not_reached")]
        rows.append([f["name"], *counts, least, f["material_side"]])
    return rows


def _table(figures: dict[str, Any]) -> list[str]:
    """The faces in columns as wide as they need to be."""
    rows = [list(_HEADS), *_rows(figures)]
    widths = [max(len(row[k]) for row in rows) for k in range(len(_HEADS))]
    return ["  ".join([row[0].ljust(widths[0]), *(x.rjust(w) for x, w in zip(row[1:], widths[1:], strict=True))])
            for row in rows]  # fmt: skip


def _lines(check: GougeCheck, figures: dict[str, Any]) -> list[str]:
    """All that the counts do not say."""
    lines = []
    lines += [f"skipped: {s}" for s in check.skipped]
    if figures["worst"] is None:
        lines.append(
            "the tool reaches no point from its axis' side: are the normals turned towards it, and is its flank "
            "steeper than the walls? (--flip turns the normals)"
        )
    else:
        lines += _words(figures["worst"], len(check.looks) > 1)
    lines.append(_spacing(figures))
    lines += _meeting_words(figures["meetings"], check.met.places.count)
    return lines + list(check.notes) + size_notes(check.whole, check.place)


def _spacing(figures: dict[str, Any]) -> str:
    return (
        f"looked at on lines at most {figures['spacing_mm']:.3g} mm apart, between which the normal turns at most "
        f"{figures['turn_deg']:.2g} deg, on both sides of knots where it or the curvature jumps; the tightest points "
        "are searched for between the lines"
    )


def _meeting_words(meetings: dict[str, Any], count: int) -> list[str]:
    if not count:
        return ["borders, and where faces meet, were left out by the margin"]
    words = []
    for name, what in (("border", "free border"), ("tangent", "tangent joins"), ("convex", "convex edges"),
                       ("concave", "concave corners"), ("disagree", "joins of opposite material sides")):  # fmt: skip
        m = meetings[name]
        if m["places"]:
            words.append(f"{m['places']:,} on {what}" + (f" ({m['gouging']:,} gouge)" if m["gouging"] else ""))
    return [f"places on borders and knot lines, faces within {meetings['tolerance_mm']:.2g} mm meeting: "
            + ", ".join(words)]  # fmt: skip


def _words(worst: dict[str, Any], several: bool) -> list[str]:
    place = ", ".join(f"{x:.4g}" for x in worst["place_mm"])
    on = f"on {worst['face']} " if several or worst["where"] != "face" else ""
    if worst["where"] != "face":
        other = f" with {worst['with_face']}" if worst["with_face"] and worst["with_face"] != worst["face"] else ""
        on += f"at its {worst['where']}{other} "
    least = worst["least_difference_per_mm"]
    value = (
        f"least difference of curvature {least:.4g}/mm" if least is not None else "no smooth tool enters, however small"
    )
    head = "worst" if worst["gouges"] else "tightest"
    lines = [f"{head} {on}at u = {worst['u']:.4g}, v = {worst['v']:.4g}, ({place}) mm: {value}"]
    if "case" in worst:
        lines.append(worst["case"])
        if worst["directions_deg"]:
            lines.append(
                f"there it cuts {worst['depth_um_1_mm_beside']:.3g} um deep 1 mm beside the contact, in the directions "
                f"{arcs_words(np.array(worst['directions_deg']))} (counter-clockwise from uphill)"
            )
    return lines


def _report(check: GougeCheck, figures: dict[str, Any], drawn: dict[str, str]) -> str:
    lines = "".join(f"- {line}\n" for line in _lines(check, figures))
    faces = table(list(_HEADS), _rows(figures)) if len(check.looks) > 1 else ""
    return (
        f"# {figures['surface']}\n\n{verdict(figures)}.\n\n"
        f"The {figures['tool']}: **{_answer(check)}**. {_counts(figures)}.\n\n{faces}\n"
        f"{lines}\nLocal gouging only: elsewhere on the surface the tool may still hit it; a scene of kind `nurbs` "
        "cuts and tells.\n" + pictures(drawn) + "\n" + whole_section(figures["tool_size"])
    )
