"""Reports as Markdown and as one HTML file with the pictures and the interactive view inside."""

from __future__ import annotations

import base64
import re
from html import escape
from math import isnan
from pathlib import Path
from typing import Any

from gearsim.output.interactive import viewer
from gearsim.output.wanted import EVERYTHING, Wanted

VIEW_MARK = "<!-- in report.html: a 3D view -->"
_STYLE = """
body{font:16px/1.5 system-ui,sans-serif;max-width:72rem;margin:2rem auto;padding:0 1rem;color:#1b1f24}
table{border-collapse:collapse;margin:1rem 0;font-variant-numeric:tabular-nums;display:block;overflow-x:auto}
td,th{border:1px solid #c8ccd0;padding:.25rem .6rem;text-align:right}
td:first-child,th:first-child{text-align:left}
img{max-width:100%;height:auto}
h1,h2{border-bottom:1px solid #e1e4e8;padding-bottom:.2rem}
code{background:#f3f4f6;padding:.1rem .25rem;overflow-wrap:anywhere}
td code{white-space:nowrap}
pre{overflow-x:auto}
@media(max-width:40rem){body{font-size:14px;margin:.6rem auto;padding:0 .6rem}td,th{padding:.2rem .35rem}}
"""


def write_report(text: str, title: str, folder: Path, wanted: Wanted = EVERYTHING, view: str = "") -> None:
    """Write report.md and report.html, as wanted, into a folder that already holds the pictures.

    ``view`` is an interactive view's HTML, which report.html has where the text is marked.
    """
    if wanted.file("report.md"):
        (folder / "report.md").write_text(text, encoding="utf-8")
    if wanted.file("report.html"):
        (folder / "report.html").write_text(as_html(text, folder, title, view), encoding="utf-8")


def verdict(report: dict[str, Any]) -> str:
    """The verdict and all that belongs into one line with it."""
    return f"**{report['verdict'].upper()}**: {report['headline']}"


def pictures(texts: dict[str, str]) -> str:
    """Pictures by file name with their captions."""
    return "".join(f"\n![{text}]({name})\n\n*{text}*\n" for name, text in texts.items())


def not_drawn(missing: list[str]) -> str:
    """Why pictures are missing."""
    return "".join(f"\n*Not drawn: {reason}*\n" for reason in missing)


def provenance(report: dict[str, Any], files: list[str]) -> str:
    """What was computed, by what, and what else the folder holds."""
    counts, timings = report["counts"], report["timings_s"]
    lines = [
        f"Files: {', '.join(f'`{name}`' for name in files)}.",
        f"{counts['rays']:,} rays, {counts['segments']:,} segments, {counts['pairs']:,} swept ray-segment pairs "
        f"({counts['candidates']:,} looked at), device {report['device']}.",
        "Seconds: " + ", ".join(f"{k} {v:.2f}" for k, v in timings.items()) + ".",
        "Versions: " + ", ".join(f"{k} {v}" for k, v in report["versions"].items()) + ".",
    ]
    return "## Provenance\n\n" + "\n\n".join(lines) + "\n"


def findings(report: dict[str, Any]) -> str:
    """What was found, with depth and place; on a bevel gear's blank, where on the tooth."""
    found = report["findings"]
    if not found:
        return "## Findings\n\nNone.\n"
    on_blank = any(f["cone_distance_mm"] is not None for f in found)
    rows = [
        [
            f["kind"], f["patch"], um(f["depth_um"]), ", ".join(f"{x:.2f}" for x in f["place_mm"]),
            *((_mm(f["cone_distance_mm"]), _mm(f["height_mm"])) if on_blank else ()),
            "FAILS" if f["fails"] else "", f["text"],
        ]
        for f in found
    ]  # fmt: skip
    on_tooth = ["cone distance [mm]", "above root [mm]"] if on_blank else []
    return "## Findings\n\n" + table(["Kind", "where", "µm", "x, y, z [mm]", *on_tooth, "", "what"], rows)


def _mm(x: float | None) -> str:
    return "–" if x is None else f"{x:.2f}"


def third_witness(dexel: dict[str, Any]) -> str:
    """What the tri-dexel says."""
    check = dexel["check_um"]["max"]
    agreement = "no cut ends" if check is None else f"to {1e3 * check:.2g} nm"
    volumes = ", ".join(f"{v:.2f}" for v in dexel["removed_volume_mm3"])
    return (
        f"\nThird witness: {dexel['check_um']['points']} ends of a tri-dexel (rays that do not know the "
        f"normals) lie where the rays along the normals say {agreement}. Its three "
        f"bundles find {volumes} mm³ removed from the slot's box.\n"
    )


def um(x: float | None) -> str:
    """A deviation in um with the digits that matter; a dash where there is none."""
    if x is None or isnan(x):
        return "–"
    if abs(x) < 5e-7:
        return "0"
    return f"{x:.1f}" if abs(x) >= 100.0 else f"{x:.3f}" if abs(x) >= 1e-3 else f"{x:.1e}"


def table(head: list[str], rows: list[list[Any]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(map(_cell, row)) + " |" for row in lines) + "\n"


def _cell(value: Any) -> str:
    """A text that ends no cell: names are the user's."""
    return " ".join(str(value).split("\n")).replace("|", "\\|")


def as_html(text: str, folder: Path, title: str, view: str = "") -> str:
    """The Markdown as one HTML file with pictures and view inside; tags in it, as of a user's names, are mere text."""
    from markdown_it import MarkdownIt

    body = MarkdownIt("commonmark", {"html": False}).enable("table").render(text)

    def inline(match: re.Match[str]) -> str:
        data = base64.b64encode((folder / match[1]).read_bytes()).decode()
        return f'src="data:image/png;base64,{data}"'

    body = re.sub(r'src="([\w.-]+\.png)"', inline, body)
    if view:
        body = body.replace(f"<p>{escape(VIEW_MARK)}</p>", view) + viewer()
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        f'<meta name="viewport" content="width=device-width,initial-scale=1"><title>gearsim: {escape(title)}</title>'
        f"<style>{_STYLE}</style></head><body>{body}</body></html>\n"
    )
