"""A tool and a choice of mills in words and figures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from gearsim.cutters.profile import Profile
from gearsim.gouging.khan.sizes import SideBySide
from gearsim.output.markdown import table
from gearsim.output.summary import number

_MILLS = {"Khan's algorithm": "thesis", "true optimum": "optimum"}


def tool_words(cutter: Profile) -> str:
    """A tool by its kind and sizes."""
    bottom = [e for e in cutter.elements if e.is_arc]
    corner = f", r = {bottom[0].radius:g} mm" if bottom and cutter.name.startswith(("bull", "ball")) else ""
    return f"{cutter.name}, R = {cutter.max_radius:g} mm{corner}"


def whole_figures(whole: SideBySide | None, place: Sequence[float]) -> dict[str, Any]:
    """One mill for everything, by Khan's algorithm (of his catalogue) and truly; empty where none reaches anything.

    ``place`` [mm] limits it; nothing does where it is the catalogue's largest.
    """
    if whole is None:
        return {}
    optimum = {
        "shank_mm": number(whole.best.shank),
        "corner_mm": number(whole.best.corner),
        "least_difference_per_mm": number(whole.best.least),
        "limited_at_mm": list(place) if whole.best.row else None,
    }
    if whole.khan is None:
        return {"optimum": optimum}
    thesis = {
        "shank_mm": number(whole.khan[0]),
        "corner_mm": number(whole.khan[1]),
        "least_difference_per_mm": number(whole.least),
        "gouges": bool(whole.least < -1e-9),
    }
    return {"thesis": thesis, "optimum": optimum}


def size_notes(whole: SideBySide | None, place: Sequence[float] = ()) -> list[str]:
    """Khan's mill and the optimum in a line; ``place`` [mm] limits them."""
    figures = whole_figures(whole, place)
    if not figures:
        return ["no mill of the catalogue reaches any point"]
    words = []
    for name, key in _MILLS.items():
        mill = figures.get(key)
        if mill is None:
            continue
        gouges = " (gouges)" if mill.get("gouges") else ""
        size = "none" if mill["shank_mm"] is None else f"R = {mill['shank_mm']:g}, r = {mill['corner_mm']:.4g} mm"
        words.append(f"{name}: {size}{gouges}")
    notes = ["one mill for the whole surface: " + "; ".join(words)]
    if figures["optimum"]["shank_mm"] is None:
        at = f", not at ({', '.join(f'{x:.4g}' for x in place)}) mm" if place else ""
        notes.append(f"no mill of the catalogue fits everywhere{at}")
    return notes


def whole_section(sizes: dict[str, Any]) -> str:
    """One mill for everything, by Khan's algorithm and truly."""
    if "optimum" not in sizes:
        return "## Tool size\n\nNo mill of the catalogue reaches any point.\n"
    rows = []
    for name, key in _MILLS.items():
        mill = sizes.get(key)
        if mill is None:
            continue
        fits = mill["shank_mm"] is not None
        least = mill["least_difference_per_mm"]
        what = "none fits" if not fits else f"R = {mill['shank_mm']:g}, r = {mill['corner_mm']:.4g}"
        state = "–" if least is None else "gouges" if least < -1e-9 else "tie" if least <= 1e-9 else "free"
        rows.append([name, what, "–" if least is None else f"{least:.3g}", state if fits else "–"])
    place = sizes["optimum"]["limited_at_mm"]
    limit = f"is limited at ({', '.join(f'{x:.3g}' for x in place)}) mm" if place else "is the catalogue's largest"
    return (
        "## Largest mill of the catalogue for the whole surface\n\n"
        + table(["", "mill [mm]", "least difference of curvature [1/mm]", ""], rows)
        + f"\nThe optimum {limit}. "
    )
