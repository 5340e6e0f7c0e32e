"""The reports of runs of local gouging and of worked examples, figures first."""

from __future__ import annotations

from typing import Any

from gearsim.output.markdown import findings, not_drawn, pictures, provenance, table, um, verdict

PICTURES = {
    "surface.png": "The machined surface under every tool, coloured by deviation, with the tool at the plotted contact",
    "deviation.png": "Deviation and what made the overcut; dashed: where the tool is predicted to gouge",
    "curvature.png": "Normal curvature of tool and part over the direction at the plotted contact",
    "tool_size.png": "The largest mill of the catalogue that does not gouge, point by point",
}


def sculptured_report(report: dict[str, Any], drawn: list[str], missing: list[str]) -> str:
    """The report of a surface cut, as Markdown."""
    files = (
        "`deviation.exr` (maps, one part a tool), `tool_size.exr` (largest mills), `tooth.vtp` (machined surfaces), "
        "`samples.parquet` (every sample), `report.json` (all figures)"
    )
    parts = [
        _head(report),
        pictures({p: text for p, text in PICTURES.items() if p in drawn}),
        _prediction(report),
        _tools(report),
        size_section(report["tool_size"]),
        worked_section(report["worked_examples"]),
        findings(report),
        not_drawn(missing),
        provenance(report, files),
    ]
    return "\n".join(p for p in parts if p)


def examples_report(report: dict[str, Any], captions: dict[str, str]) -> str:
    """The report of worked examples known by numbers, as Markdown."""
    scene = report["scene"]["scene"]
    head = f"# {scene['name']}\n\n{scene['summary']}\n\n{verdict(report)}: nothing is cut, the comparison ran.\n"
    worked = worked_section(report["worked_examples"])
    return "\n".join([head, worked, pictures(captions), provenance(report, "`report.json` (all figures)")])


def worked_section(worked: dict[str, Any]) -> str:
    """Printed numbers beside ours."""
    if not worked["rows"]:
        return ""
    rows = [[r["section"], r["quantity"], r["printed"], r["ours"], r["verdict"]] for r in worked["rows"]]
    return f"## Beside the thesis\n\n{worked['agree']} of {len(rows)} printed results reproduce.\n\n" + table(
        ["Section", "quantity", "printed", "ours", "verdict"], rows
    )


def size_section(sizes: dict[str, Any]) -> str:
    """One mill for the whole surface, by the thesis and truly, and how sizes spread."""
    spread = (
        f"At single points R runs from {_mm(sizes['least_shank_mm'])} to {_mm(sizes['greatest_shank_mm'])}; at "
        f"{sizes['no_mill_fits']:,} of {sizes['points']:,} points none fits.\n"
    )
    return whole_section(sizes) + spread


def whole_section(sizes: dict[str, Any]) -> str:
    """One mill for everything, by the thesis and truly."""
    if "optimum" not in sizes:
        return "## Tool size\n\nNo mill of the catalogue reaches any point.\n"
    rows = []
    for name, key in (("the thesis's algorithm", "thesis"), ("true optimum", "optimum")):
        mill = sizes[key]
        fits = mill["shank_mm"] is not None
        least = mill["least_difference_per_mm"]
        what = "none fits" if not fits else f"R = {mill['shank_mm']:g}, r = {mill['corner_mm']:.4g}"
        state = "–" if least is None else "gouges" if least < -1e-9 else "tie" if least <= 1e-9 else "free"
        rows.append([name, what, "–" if least is None else f"{least:.3g}", state if fits else "–"])
    place = ", ".join(f"{x:.3g}" for x in sizes["optimum"]["limited_at_mm"])
    return (
        "## Largest mill of the catalogue for the whole surface\n\n"
        + table(["", "mill [mm]", "least difference of curvature [1/mm]", ""], rows)
        + f"\nThe optimum is limited at ({place}) mm. "
    )


def _head(report: dict[str, Any]) -> str:
    scene, metrology = report["scene"]["scene"], report["scene"]["metrology"]
    return (
        f"# {scene['name']}\n\n{scene['summary']}\n\n{verdict(report)} (the chosen tool may overcut by "
        f"{metrology['tolerance_um']:g} µm).\n\nDeviation is measured along the surface's normal: "
        "**positive is material left, negative is overcut**.\n"
    )


def _prediction(report: dict[str, Any]) -> str:
    rows = []
    for name, t in report["tools"].items():
        a, o = t["cut_alone"], t["overcut_samples"]
        error = "–" if a["largest_error_per_mm"] is None else f"{a['largest_error_per_mm']:.1e}"
        rows.append([name, a["contacts"], a["gouge"], a["too_near_a_tie"], a["disagree"], error, o["local"], o["tie"],
                     o["global"], o["unpredicted"]])  # fmt: skip
    head = ["", "contacts cut alone", "gouge", "too near a tie", "**against prediction**", "largest error [1/mm]",
            "overcut samples: local", "tie", "global", "**not predicted**"]  # fmt: skip
    return (
        "## Does the overcut appear where it is predicted?\n\n"
        "Every contact on its own: the tool stands there alone and 16 rays about it are cut; the clearance must\n"
        "have the curvature that was predicted. Then all passes together: every sample overcut beyond the tolerance\n"
        "is traced to the contact that cut deepest. Either the tool is clear of the surface on the way there, so that\n"
        "another part of it has hit another part of the surface (global gouging); or it is not, and then somewhere\n"
        "on the way the part must be predicted to gouge (local).\n\n" + table(head, rows)
    )


def _tools(report: dict[str, Any]) -> str:
    rows = []
    for name, t in report["tools"].items():
        d = t["deviation_um"]
        rows.append([f"{name}: {t['tool']}", t["contacts"], t["contacts_gouging"], t["contacts_tie"], um(d["min"]),
                     um(d["max"]), um(d["mean"]), d["uncut"], d["through"],
                     f"{t['machined_points_off_tool_um']:.1e}"])  # fmt: skip
    head = ["Tool", "contacts", "predicted to gouge", "tie", "min [µm]", "max", "mean", "uncut", "cut through",
            "machined points off the tool [µm]"]  # fmt: skip
    return "## What each tool cuts\n\n" + table(head, rows)


def _mm(x: float | None) -> str:
    return "–" if x is None else f"{x:g} mm"
