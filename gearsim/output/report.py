"""The report of a flank-milled tooth, told to a gear engineer, figures first."""

from __future__ import annotations

from typing import Any

from gearsim.output.markdown import findings, not_drawn, pictures, provenance, table, third_witness, um, verdict

_ROTATIONS = ("mid_rotation_um", "best_rotation_um")

FIRST = ("slot.png", "deviation.png")
FILES = (
    "`deviation.exr` (maps), `tooth.vtp` (machined slot surfaces), `samples.parquet` (every sample), "
    "`toolpath.cl` (the program that was simulated), `program.nc` (the same for the scene's machine, where it has "
    "one), `report.json` (all figures)"
)
PICTURES = {
    "slot.png": "The machined slot (tri-dexel), coloured by its deviation from the intended slot",
    "deviation.png": "Deviation maps, inspector's grid and mean profile, after all passes",
    "profile.png": "Intended and machined profile at mid-face (Zhou's figures 4.16 and 4.17)",
    "envelopes.png": "The cutter's untrimmed envelopes in the slot (figure 4.13)",
    "toolpaths.png": "Tool axis positions of the finish passes in the slot (figure 4.9)",
    "blanks.png": "Blanks of gear and pinion (figure 3.2)",
}


def flank_milling_report(report: dict[str, Any], drawn: list[str], missing: list[str]) -> str:
    """The report as Markdown; ``drawn`` pictures are shown, ``missing`` says why others could not be drawn."""
    parts = [
        _head(report),
        pictures({p: PICTURES[p] for p in FIRST if p in drawn}),
        _costs(report),
        _roads(report),
        findings(report),
        _notes(report),
        _published(report),
        _convergence(report),
        _inspection(report),
        _root(report),
        pictures({p: text for p, text in PICTURES.items() if p in drawn and p not in FIRST}),
        not_drawn(missing),
        provenance(report, FILES),
    ]
    return "\n".join(p for p in parts if p)


def _head(report: dict[str, Any]) -> str:
    scene, metrology = report["scene"]["scene"], report["scene"]["metrology"]
    return (
        f"# {scene['name']}\n\n{scene['summary']}\n\n{verdict(report)} (flanks ±{metrology['tolerance_um']:g} µm, "
        f"cuts into the root {metrology['root_tolerance_um']:g} µm).\n\n"
        "Deviation is measured along the outward surface normal: **positive is material left, negative is "
        "overcut**.\n"
    )


def _notes(report: dict[str, Any]) -> str:
    notes = "".join(f"- {note}\n" for note in report["program_notes"])
    return f"## How the CL file was read\n\n{notes}" if notes else ""


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
                values = [um(d[k]) for k in ("min", "max", "mean", "rms")]
                rows.append([f"{side}: {text}", *values, d["uncut"], d["through"]])
    head = ["Deviation of the working flank [µm]", "min", "max", "mean", "RMS", "uncut", "cut through"]
    return "## What each step costs\n\n" + table(head, rows)


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
    return (
        "## Can the number be trusted?\n\n"
        "Two roads lead to the machined surface: the closed-form envelope of the exact motion, and a kernel "
        "that sweeps the cutter through rays and knows no envelope condition. They must agree to 1 nm.\n\n"
        + table(["Largest gap of the two roads", "nm", "samples", "excluded", "disagree", "classes"], rows)
        + third_witness(report["tri_dexel"])
    )


def _published(report: dict[str, Any]) -> str:
    reference = report["scene"].get("reference")
    if reference is None:
        return ""
    rows = []
    for side, flank in report["flanks"].items():
        rows += [
            [f"{side}, published (sign turned)", *map(um, flank["published_profile_um"].values())],
            [f"{side}, ours, surface normal", *map(um, flank["profile_um"].values())],
            [f"{side}, ours, normal in the profile plane", *map(um, flank["profile_inplane_um"].values())],
        ]
    head = ["Deviation at the mean profile [µm]", *next(iter(report["flanks"].values()))["profile_um"]]
    sign = "counts overcut as positive; its sign is turned here" if reference["overcut_is_positive"] else "has our sign"
    return (
        f"## Beside the published figures\n\n{reference['source']}. The source {sign}. Ours is the flank's own pass on "
        "the continuous motion; L0 lies on the contact path, where the planned cutter touches the tooth, so it is 0 by "
        f"construction. {reference.get('note', '')}\n\n" + table(head, rows)
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
    return "## Convergence with the number of CL points\n\n" + table(head, rows)


def _inspection(report: dict[str, Any]) -> str:
    out = ["## Inspector's grid after all passes [µm]\n\nRows root to tip, columns toe to heel.\n"]
    for side, flank in report["flanks"].items():
        t = flank["topography"]["all_passes"]
        mid, best = (f"turned by {um(t[k])} µm at r = {t['radius_mm']:.2f} mm" for k in _ROTATIONS)
        kinds = {
            "as cut": "as_cut_um",
            f"mid-point zeroed ({mid})": "mid_zeroed_um",
            f"best rotated ({best})": "best_rotated_um",
        }
        for text, key in kinds.items():
            rows = [[f"row {i + 1}", *map(um, row)] for i, row in enumerate(t[key])]
            head = [f"{side}, {text}", *(str(i + 1) for i in range(len(t[key][0])))]
            out.append(table(head, rows))
    return "\n".join(out)


def _root(report: dict[str, Any]) -> str:
    rows = [
        [name, *(um(p["deviation_um"][k]) for k in ("min", "max", "mean")), p["deviation_um"]["uncut"]]
        for name, p in report["root"].items()
    ]
    return "## Root after all passes [µm]\n\n" + table(["", "min", "max", "mean", "uncut samples"], rows)
