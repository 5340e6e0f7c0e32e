"""The report of a run that generates surfaces, told to a gear engineer, figures first."""

from __future__ import annotations

from typing import Any

from gearsim.output.markdown import findings, not_drawn, pictures, provenance, table, third_witness, um, verdict

FIRST = ("slot.png", "envelope.png", "deviation.png")
PICTURES = {
    "slot.png": "The slot cut out of the blank (tri-dexel), coloured by its distance from the closed-form surfaces",
    "envelope.png": "The closed-form surfaces with grazing curves (black) and the tool at both ends of its motion",
    "deviation.png": "Deviation maps of every surface under every motion",
    "axes.png": "Axis values along the motion",
}


def generating_report(report: dict[str, Any], files: list[str], drawn: list[str], missing: list[str]) -> str:
    """The report as Markdown; ``files`` are the programs in the folder, ``drawn`` its pictures."""
    parts = [
        _head(report),
        pictures({p: PICTURES[p] for p in FIRST if p in drawn}),
        _motions(report),
        _roads(report),
        findings(report),
        _convergence(report),
        pictures({p: text for p, text in PICTURES.items() if p in drawn and p not in FIRST}),
        not_drawn(missing),
        provenance(report, _files(files)),
    ]
    return "\n".join(p for p in parts if p)


def _head(report: dict[str, Any]) -> str:
    scene, metrology = report["scene"]["scene"], report["scene"]["metrology"]
    judged = ", ".join(metrology["judged"])
    limit = f"±{metrology['tolerance_um']:g} µm under {judged}" if judged else "no motion is judged by a tolerance"
    return (
        f"# {scene['name']}\n\n{scene['summary']}\n\n{verdict(report)} ({limit}).\n\n"
        "Deviation is measured along the outward surface normal of the closed-form surface that the first motion "
        "generates: **positive is material left, negative is overcut**.\n"
    )


def _motions(report: dict[str, Any]) -> str:
    lines = "".join(f"- **{name}**: {text}\n" for name, text in report["motions"].items())
    rows = []
    for side, surface in report["flanks"].items():
        for name, motion in surface["motions"].items():
            d = motion["deviation_um"]
            rows.append(
                [f"{side}: {name}", *(um(d[k]) for k in ("min", "max", "mean", "rms")), d["uncut"], d["through"]]
            )
    head = ["Deviation from the closed form [µm]", "min", "max", "mean", "RMS", "uncut", "cut through"]
    notes = "".join(f"\n*{note}*\n" for note in report["machine_notes"])
    return f"## What each motion cuts\n\n{lines}\n" + table(head, rows) + notes


def _roads(report: dict[str, Any]) -> str:
    rows = []
    for side, surface in report["flanks"].items():
        for name, motion in surface["motions"].items():
            gap = motion["envelope_gap_um"]
            share = ", ".join(f"{k} {100 * v:.1f} %" for k, v in gap["class_share"].items() if v)
            rows.append(
                [f"{side}: {name}", f"{1e3 * gap['max']:.2g}", gap["valid"], gap["excluded"], gap["disagree"], share]
            )
    counted = "".join(
        f"- {side}: {s['samples']:,} samples, {s['missing']:,} without a point of the closed form, "
        f"{s['trimmed']:,} trimmed by the generating motion itself\n"
        for side, s in report["flanks"].items()
    )
    return (
        "## Can the number be trusted?\n\n"
        "The machined surface is found by two roads: closed-form classes of the exact motion, trimmed; and a kernel "
        "that sweeps the tool through rays and knows no envelope condition. They must agree to 1 nm, and under the "
        "generating motion both must lie on the closed form.\n\n"
        + table(["Largest gap of the two roads", "nm", "samples", "excluded", "disagree", "classes"], rows)
        + f"\n{counted}"
        + (third_witness(report["tri_dexel"]) if "tri_dexel" in report else "")
    )


def _convergence(report: dict[str, Any]) -> str:
    rows, points = [], []
    for side, surface in report["flanks"].items():
        for name, c in surface["convergence"].items():
            points = c["points"]
            rows.append([f"{side}: {name}", *(f"{w:.4g}" for w in c["worst_um"]), f"{c['order']:.2f}"])
    if not rows:
        return ""
    head = ["Largest change from the generating motion [µm], number of points:", *map(str, points), "order"]
    return "## Convergence with the number of points\n\n" + table(head, rows)


def _files(programs: list[str]) -> str:
    own = "".join(f"`{name}`, " for name in programs)
    return (
        f"{own}`deviation.exr` (maps), `tooth.vtp` (machined surfaces), `samples.parquet` (every sample), "
        "`report.json` (all figures)"
    )
