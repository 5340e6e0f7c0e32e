"""Benchmark suite `gouging`: points of a NURBS surface per second, from their jets to the largest tool at each."""

from __future__ import annotations

from collections.abc import Callable
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.catalogue import bull
from gearsim.cutters.contact import contact_at, locate
from gearsim.geometry.nurbs import clamped_knots
from gearsim.gouging.compare import compare_contact
from gearsim.gouging.pairs import agreement
from gearsim.gouging.sizes import largest_ball, largest_mills, largest_shank
from gearsim.gouging.standard_mills import metric_mills
from gearsim.gouging.surface import surface_contacts
from gearsim.surfaces.nurbs import NurbsSurface

GRID = {"small": 256, "large": 1024}
PAIRS = {"small": 10_000, "large": 100_000}
_REPEATS = 3
_COLUMNS = ("what", "points", "seconds", "points/s", "result")


def waves(size: float = 100.0, height: float = 4.0, points: int = 12, degree: int = 3) -> NurbsSurface:
    """A cubic surface over a square [mm] with hills and bowls, to be milled from above."""
    x = np.linspace(0.0, size, points)
    z = height * np.outer(np.sin(np.pi * np.arange(points) / 2.5), np.cos(np.pi * np.arange(points) / 3.0))
    net = np.stack([*np.meshgrid(x, x, indexing="ij"), z], axis=-1)
    knots = clamped_knots(points, degree)
    return NurbsSurface(degree, degree, knots, knots, net)


def gouging(device: str, size: str) -> dict[str, Any]:
    """NumPy on one core, whatever the device: jets, contacts, one tool, all tools; and the proof by clearance."""
    count = GRID[size]
    u, v = (x.ravel() for x in np.meshgrid(*2 * [np.linspace(0.0, 1.0, count)], indexing="ij"))
    surface, cutter, mills = waves(), bull(20.0, 3.0, 40.0), metric_mills()
    jet = surface.jet(u, v)
    contacts = surface_contacts(jet)
    theta, part = contacts
    work: list[tuple[str, Callable[[], str]]] = [
        ("NURBS jets", lambda: _done(surface.jet(u, v).r)),
        ("contacts: angles and tensors", lambda: _done(surface_contacts(jet).theta)),
        ("tool locations", lambda: _done(locate(cutter, jet.r, jet.normal).tip)),
        ("one mill compared", lambda: _share(compare_contact(contact_at(cutter, theta), part).least < 0.0)),
        ("largest ball, closed form", lambda: f"least {np.min(largest_ball(theta, part)):.2f} mm"),
        ("largest shank for r = 1 mm", lambda: f"least {np.nanmin(largest_shank(1.0, theta, part)):.2f} mm"),
        (f"largest of {len(mills)} mills", lambda: _mills(largest_mills(mills, theta, part).shank)),
    ]
    rows = [_row(what, len(u), *_timed(run)) for what, run in work]
    pairs, began = PAIRS[size], perf_counter()
    found = agreement(pairs)
    text = f"{found.outside} disagree, {found.inside} of {found.near} near equality"
    rows.append(_row("decision and clearance", found.pairs, perf_counter() - began, text))
    return {"columns": list(_COLUMNS), "rows": rows, "notes": _notes(count)}


def _timed(run: Callable[[], str]) -> tuple[float, str]:
    seconds = []
    for _ in range(_REPEATS):
        began = perf_counter()
        text = run()
        seconds.append(perf_counter() - began)
    return median(seconds), text


def _row(what: str, points: int, seconds: float, result: str) -> dict[str, Any]:
    return {"what": what, "points": points, "seconds": seconds, "points/s": points / seconds, "result": result}


def _done(values: NDArray) -> str:
    return f"{np.mean(np.isfinite(values)):.0%} finite"


def _share(gouges: NDArray) -> str:
    return f"{np.mean(gouges):.1%} gouge"


def _mills(shank: NDArray) -> str:
    return f"R {np.nanmin(shank):g} to {np.nanmax(shank):g} mm"


def _notes(count: int) -> list[str]:
    return [
        f"NumPy on one core, medians of {_REPEATS}; a map of {count} x {count} points is jets, contacts and the last "
        "row but one together. The last row draws random cutters and quadrics and compares the decision by curvature "
        "with the tool's signed distance from the part.",
    ]
