"""The report of a cylindrical gear, told to a gear engineer, figures first."""

from __future__ import annotations

from typing import Any

from gearsim.output.cylindrical.beside import beside
from gearsim.output.cylindrical.budget import error_budget
from gearsim.output.cylindrical.words import duration, size
from gearsim.output.markdown import (
    findings,
    not_drawn,
    pictures,
    provenance,
    table,
    third_witness,
    um,
    verdict,
)
from gearsim.surfaces.cylindrical_gear import SIDES

PICTURES = {
    "inspection.png": "Inspection sheet",
    "gear.png": "The machined gear with its tool, and space 1 with its flanks coloured by deviation",
    "section.png": "Transverse section of the whole gear as cut, and one space",
    "deviation.png": "Topography of both flanks of space 1, along the normal, under the whole program",
    "profile.png": "Profile traces",
    "helix.png": "Helix traces",
    "pitch.png": "Pitch",
    "roughness.png": "Roughness of the path alone",
}
FIRST = ("inspection.png", "gear.png")
LATER = ("section.png", "deviation.png", "profile.png", "helix.png", "pitch.png")

FILES = (
    "`program.nc` (what was cut), `deviation.exr` (maps), `tooth.vtp` (both flanks of space 1), `samples.parquet` "
    "(every sample of the maps), `report.json` (all figures)"
)


def gear_report(report: dict[str, Any], drawn: list[str], missing: list[str]) -> str:
    """The report as Markdown; ``drawn`` are the pictures in the folder."""
    parts = [
        _head(report),
        _pictures(FIRST, drawn),
        _parameters(report),
        _reached(report),
        error_budget(report["budget"]),
        beside(report),
        _pictures(("roughness.png",), drawn),
        _roads(report),
        findings(report),
        _program(report),
        _pictures(LATER, drawn),
        not_drawn(missing),
        provenance(report, FILES),
    ]
    return "\n".join(p for p in parts if p)


def _pictures(names: tuple[str, ...], drawn: list[str]) -> str:
    return pictures({p: PICTURES[p] for p in names if p in drawn})


def _head(report: dict[str, Any]) -> str:
    scene, gear, inspection = report["scene"]["scene"], report["gear"], report["inspection"]
    angle = gear["helix_angle_deg"]
    hand = "spur" if not angle else f"{abs(angle):g}° {'right' if angle > 0.0 else 'left'}-hand"
    worst = [row["class_achieved"] for row in inspection["parameters"] if row["class_achieved"] is not None]
    reached = f"; the worst parameter measured is of class {max(worst)}" if worst else ""
    return (
        f"# {scene['name']}\n\n{scene['summary']}\n\n{verdict(report)} (class {inspection['class']} of "
        f"{inspection['standard']}, and ±{report['scene']['metrology']['tolerance_um']:g} µm on the maps of space 1"
        f"{reached}).\n\n"
        f"{gear['kind'].capitalize()} {hand} gear, z = {gear['teeth']}, normal module "
        f"{gear['normal_module_mm']:.6g} mm, normal pressure angle {gear['normal_pressure_angle_deg']:.6g}°, face "
        f"width {gear['face_width_mm']:g} mm, profile shift {gear['profile_shift']:g}.\n\n"
        "Traces, pitches and the error budget are **transverse** as ISO 1328-1 takes them, maps are along the "
        "normal: **positive is material left, negative is overcut**. Slopes are positive where material grows from "
        "the root to the tip, or from the top face to the bottom. Flutes, deflection, heat and servo axes are not "
        "modelled: what is measured is what the program itself makes.\n"
    )


def _parameters(report: dict[str, Any]) -> str:
    inspection = report["inspection"]
    rows = []
    for row in inspection["parameters"]:
        achieved = row["class_achieved"]
        rows.append(
            [
                row["parameter"], *(size(row[f"{side}_um"]) for side in SIDES), f"{row['tolerance_um']:g} µm",
                f"{row['incomplete']} missing" if row["incomplete"] else "beyond 11" if achieved is None else achieved,
                "" if row["within"] else "**beyond**" if not row["incomplete"] else "",
            ]
        )  # fmt: skip
    spaces, count = len(inspection["spaces"]), abs(report["gear"]["teeth"])
    probed = "all spaces" if spaces == count else f"{spaces} of {count} spaces; pitch takes them all"
    head = [
        f"{inspection['standard']}", *(f"{s} flanks" for s in SIDES), f"tolerance, class {inspection['class']}",
        "class achieved", "",
    ]  # fmt: skip
    runout = f"Runout F_r (a ball in every space): {size(inspection['runout_um'])}."
    return (
        f"## Parameters\n\nLargest of {probed}, three traces on each flank.\n\n" + table(head, rows) + f"\n{runout}\n"
    )


def _reached(report: dict[str, Any]) -> str:
    rows = [
        [
            side, *(f"{r[f'{end}_roll_deg']:.3f}°" for end in ("root", "tip")),
            *(f"{r[f'{end}_radius_mm']:.3f}" for end in ("root", "tip")),
        ]
        for side, r in report["reached"].items()
    ]  # fmt: skip
    gear = report["gear"]
    rows.append(["circles of the gear", "", "", *(f"{gear[f'{end}_radius_mm']:.3f}" for end in ("root", "tip"))])
    head = ["Generated over the whole face width", "roll at root", "roll at tip", "R at root [mm]", "R at tip [mm]"]
    return table(head, rows)


def _roads(report: dict[str, Any]) -> str:
    rows, maps = [], []
    for side, surface in report["flanks"].items():
        for name, motion in surface["motions"].items():
            d, gap = motion["deviation_um"], motion["envelope_gap_um"]
            maps.append(
                [f"{side}: {name}", *(um(d[k]) for k in ("min", "max", "mean", "rms")), d["uncut"], d["through"]]
            )
            if gap is None:
                continue
            share = ", ".join(f"{k} {100 * v:.1f} %" for k, v in gap["class_share"].items() if v)
            rows.append(
                [f"{side}: {name}", f"{1e3 * gap['max']:.2g}", gap["valid"], gap["excluded"], gap["disagree"], share]
            )
    return (
        "## Can the number be trusted?\n\n"
        "The machined surface is found by two roads: closed-form classes of the exact motion, trimmed; and a kernel "
        "that sweeps the tool through rays and knows no envelope condition. They must agree to 1 nm on the dense "
        "maps of space 1, for the blocks that finish it.\n\n"
        + table(["Largest gap of the two roads", "nm", "samples", "excluded", "disagree", "classes"], rows)
        + "\n"
        + table(["Maps of space 1 [µm, normal]", "min", "max", "mean", "RMS", "uncut", "cut through"], maps)
        + third_witness(report["tri_dexel"])
    )


def _program(report: dict[str, Any]) -> str:
    program = report["program"]
    rows = [
        [
            op["name"].lower(),
            duration(op["cutting_s"]),
            _speed(op["largest_speed_mm_per_min"]),
            _speed(op["feed_mm_per_min"]),
        ]
        for op in program["operations"]
    ]
    rows.append(["together", duration(program["cutting_s"]), "", ""])
    notes = "".join(f"\n*{note}*\n" for note in program["notes"])
    return (
        f"## The program\n\n`program.nc`: {program['lines']:,} lines, {program['blocks']:,} blocks. Read back and cut "
        "as it stands. Speeds are those of the tool's axis on the gear, from its end to the top face [mm/min].\n\n"
        + table(["Operation", "time in feed", "largest speed", "feed asked for"], rows)
        + notes
    )


def _speed(value: float | None) -> str:
    return "–" if value is None else f"{value:.1f}"
