"""report.md and report.html: the run told to a gear engineer, figures first."""

from __future__ import annotations

import base64
import re
from pathlib import Path
from typing import Any

_STYLE = """
body{font:16px/1.5 system-ui,sans-serif;max-width:72rem;margin:2rem auto;padding:0 1rem;color:#1b1f24}
table{border-collapse:collapse;margin:1rem 0;font-variant-numeric:tabular-nums}
td,th{border:1px solid #c8ccd0;padding:.25rem .6rem;text-align:right}
td:first-child,th:first-child{text-align:left}
img{max-width:100%;height:auto}
h1,h2{border-bottom:1px solid #e1e4e8;padding-bottom:.2rem}
code{background:#f3f4f6;padding:.1rem .25rem}
"""

_ROTATIONS = ("mid_rotation_um", "best_rotation_um")

PICTURES = {
    "slot.png": "The machined slot (tri-dexel), coloured by its deviation from the intended slot",
    "deviation.png": "Deviation maps, inspector's grid and mean profile, after all passes",
    "profile.png": "Intended and machined profile in the plane of the mean point (Zhou's figure 4.16)",
    "envelopes.png": "The cutter's untrimmed envelopes in the slot (figure 4.13)",
    "toolpaths.png": "Tool axis positions of the finish passes in the slot (figure 4.9)",
    "blanks.png": "Blanks of gear and pinion (figure 3.2)",
}


def write_report(report: dict[str, Any], folder: Path, missing: list[str]) -> None:
    """Write report.md and report.html into a folder that already holds the pictures.

    ``missing`` says why pictures could not be drawn; it is told in the report.
    """
    text = markdown(report, [p for p in PICTURES if (folder / p).exists()], missing)
    (folder / "report.md").write_text(text, encoding="utf-8")
    (folder / "report.html").write_text(_html(text, folder, report["scene"]["scene"]["name"]), encoding="utf-8")


def markdown(report: dict[str, Any], pictures: list[str], missing: list[str]) -> str:
    """The report as Markdown."""
    parts = [
        _head(report),
        _pictures([p for p in ("slot.png", "deviation.png") if p in pictures]),
        _costs(report),
        _roads(report),
        _findings(report),
        _published(report),
        _convergence(report),
        _inspection(report),
        _root(report),
        _pictures([p for p in pictures if p not in ("slot.png", "deviation.png")]),
        "".join(f"\n*Not drawn: {reason}*\n" for reason in missing),
        _provenance(report),
    ]
    return "\n".join(p for p in parts if p)


def _head(report: dict[str, Any]) -> str:
    scene, metrology = report["scene"]["scene"], report["scene"]["metrology"]
    verdict = {
        "pass": "**PASS**: every measured deviation is within tolerance",
        "fail": "**FAIL**: out of tolerance, see the findings",
        "unchecked": f"**UNCHECKED**: {report['status']}",
    }[report["verdict"]]
    return (
        f"# {scene['name']}\n\n{scene['summary']}\n\n{verdict} (flanks ±{metrology['tolerance_um']:g} µm, "
        f"cuts into the root {metrology['root_tolerance_um']:g} µm).\n\n"
        "Deviation is measured along the outward surface normal: **positive is material left, negative is "
        "overcut**.\n"
    )


def _costs(report: dict[str, Any]) -> str:
    names = {
        "own_pass": "own pass, continuous motion (what planning costs)",
        "own_pass_cl": "own pass, CL data (adds what discretisation costs)",
        "all_passes": "all passes (adds what the other flank's pass costs)",
    }
    rows = []
    for side, flank in report["flanks"].items():
        for key, text in names.items():
            if flank[key] is not None:
                d = flank[key]["deviation_um"]
                values = [_um(d[k]) for k in ("min", "max", "mean", "rms")]
                rows.append([f"{side}: {text}", *values, d["uncut"], d["through"]])
    head = ["Deviation of the working flank [µm]", "min", "max", "mean", "RMS", "uncut", "cut through"]
    return "## What each step costs\n\n" + _table(head, rows)


def _roads(report: dict[str, Any]) -> str:
    rows = []
    for side, flank in report["flanks"].items():
        for key, motion in (("envelope_gap_um", "continuous"), ("envelope_gap_cl_um", "CL data")):
            gap = flank[key]
            if gap is not None:
                share = ", ".join(f"{k} {100 * v:.1f} %" for k, v in gap["class_share"].items() if v)
                rows.append(
                    [
                        f"{side}, {motion}",
                        f"{1e3 * gap['max']:.2g}",
                        gap["valid"],
                        gap["excluded"],
                        gap["disagree"],
                        share,
                    ]
                )
    dexel = report["tri_dexel"]
    check = dexel["check_um"]["max"]
    agreement = "no cut ends" if check is None else f"to {1e3 * check:.2g} nm"
    volumes = ", ".join(f"{v:.2f}" for v in dexel["removed_volume_mm3"])
    return (
        "## Can the number be trusted?\n\n"
        "Two roads lead to the machined surface: the closed-form envelope of the exact motion, and a kernel "
        "that sweeps the cutter through rays and knows no envelope condition. They must agree to 1 nm.\n\n"
        + _table(["Largest gap of the two roads", "nm", "samples", "excluded", "disagree", "classes"], rows)
        + f"\nThird witness: {dexel['check_um']['points']} ends of a tri-dexel (rays that do not know the "
        f"normals) lie where the rays along the normals say {agreement}. Its three "
        f"bundles find {volumes} mm³ removed from the slot's box.\n"
    )


def _findings(report: dict[str, Any]) -> str:
    rows = [
        [
            f["kind"], f["patch"], _um(f["depth_um"]), ", ".join(f"{x:.2f}" for x in f["place_mm"]),
            f"{f['cone_distance_mm']:.2f}", f"{f['height_mm']:.2f}", "FAILS" if f["fails"] else "", f["text"],
        ]
        for f in report["findings"]
    ]  # fmt: skip
    if not rows:
        return "## Findings\n\nNone.\n"
    head = ["Kind", "where", "µm", "x, y, z [mm]", "cone distance [mm]", "above root [mm]", "", "what"]
    return "## Findings\n\n" + _table(head, rows)


def _published(report: dict[str, Any]) -> str:
    reference = report["scene"].get("reference")
    if reference is None:
        return ""
    rows = []
    for side, flank in report["flanks"].items():
        rows += [
            [f"{side}, published (sign turned)", *map(_um, flank["published_profile_um"].values())],
            [f"{side}, ours, surface normal", *map(_um, flank["profile_um"].values())],
            [f"{side}, ours, normal in the profile plane", *map(_um, flank["profile_inplane_um"].values())],
        ]
    head = ["Deviation at the mean profile [µm]", *next(iter(report["flanks"].values()))["profile_um"]]
    sign = "counts overcut as positive; its sign is turned here" if reference["overcut_is_positive"] else "has our sign"
    return (
        f"## Beside the published figures\n\n{reference['source']}. The source {sign}. Ours is the flank's own pass on "
        "the continuous motion; L0 lies on the contact path, where the planned cutter touches the tooth, so it is 0 by "
        f"construction. {reference.get('note', '')}\n\n" + _table(head, rows)
    )


def _convergence(report: dict[str, Any]) -> str:
    flanks = {s: f["convergence"] for s, f in report["flanks"].items() if f["convergence"]}
    if not flanks:
        return ""
    points = next(iter(flanks.values()))["points"]
    rows = [[side, *(f"{w:.4g}" for w in c["worst_um"]), f"{c['order']:.2f}"] for side, c in flanks.items()]
    head = [
        "Largest change from the continuous path [µm], CL points over the face:",
        *map(str, points),
        "order",
    ]
    return "## Convergence with the number of CL points\n\n" + _table(head, rows)


def _inspection(report: dict[str, Any]) -> str:
    out = ["## Inspector's grid after all passes [µm]\n\nRows root to tip, columns toe to heel.\n"]
    for side, flank in report["flanks"].items():
        t = flank["topography"]["all_passes"]
        mid, best = (f"turned by {_um(t[k])} µm at r = {t['radius_mm']:.2f} mm" for k in _ROTATIONS)
        kinds = {
            "as cut": "as_cut_um",
            f"mid-point zeroed ({mid})": "mid_zeroed_um",
            f"best rotated ({best})": "best_rotated_um",
        }
        for text, key in kinds.items():
            rows = [[f"row {i + 1}", *map(_um, row)] for i, row in enumerate(t[key])]
            head = [f"{side}, {text}", *(str(i + 1) for i in range(len(t[key][0])))]
            out.append(_table(head, rows))
    return "\n".join(out)


def _root(report: dict[str, Any]) -> str:
    rows = [
        [name, *(_um(p["deviation_um"][k]) for k in ("min", "max", "mean")), p["deviation_um"]["uncut"]]
        for name, p in report["root"].items()
    ]
    return "## Root after all passes [µm]\n\n" + _table(["", "min", "max", "mean", "uncut samples"], rows)


def _pictures(names: list[str]) -> str:
    return "".join(f"\n![{PICTURES[n]}]({n})\n\n*{PICTURES[n]}*\n" for n in names)


def _provenance(report: dict[str, Any]) -> str:
    counts, timings = report["counts"], report["timings_s"]
    lines = [
        "Files: `deviation.exr` (maps), `tooth.vtp` (machined slot surfaces), `samples.parquet` (every sample), "
        "`toolpath.cl` (the program that was simulated), `report.json` (all figures).",
        f"{counts['rays']:,} rays, {counts['segments']:,} segments, {counts['pairs']:,} swept ray-segment pairs "
        f"({counts['candidates']:,} looked at), device {report['device']}.",
        "Seconds: " + ", ".join(f"{k} {v:.2f}" for k, v in timings.items()) + ".",
        "Versions: " + ", ".join(f"{k} {v}" for k, v in report["versions"].items()) + ".",
    ]
    return "## Provenance\n\n" + "\n\n".join(lines) + "\n"


def _um(x: float | None) -> str:
    """A deviation in um with the digits that matter."""
    if x is None:
        return "–"
    if abs(x) < 5e-7:
        return "0"
    return f"{x:.1f}" if abs(x) >= 100.0 else f"{x:.3f}" if abs(x) >= 1e-3 else f"{x:.1e}"


def _table(head: list[str], rows: list[list[Any]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(str(c) for c in row) + " |" for row in lines) + "\n"


def _html(text: str, folder: Path, title: str) -> str:
    """The Markdown as one HTML file with the pictures inside."""
    from markdown_it import MarkdownIt

    body = MarkdownIt("commonmark").enable("table").render(text)

    def inline(match: re.Match[str]) -> str:
        data = base64.b64encode((folder / match[1]).read_bytes()).decode()
        return f'src="data:image/png;base64,{data}"'

    body = re.sub(r'src="([\w.-]+\.png)"', inline, body)
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>gearsim: {title}</title>'
        f"<style>{_STYLE}</style></head><body>{body}</body></html>\n"
    )
