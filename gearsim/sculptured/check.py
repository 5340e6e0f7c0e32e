"""A user's own surface looked at for local gouging: ``gearsim gouge``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError, Status, read_input
from gearsim.gouging.evaluate import evaluate
from gearsim.gouging.khan_sizes import beside_best
from gearsim.gouging.prediction import predict_at
from gearsim.gouging.sizes import largest_mills
from gearsim.gouging.standard_mills import khan_mills, metric_mills, ranked
from gearsim.metrology.samples import sample_grid
from gearsim.result import GougeCheck, SizeChoice, versions
from gearsim.surfaces.nurbs import NurbsSurface
from gearsim.surfaces.nurbs_file import load_surfaces


def check_surface(
    surface: NurbsSurface, cutter: Profile, mills: NDArray, *, grid: int = 256, margin: float = 0.0,
    axis: Sequence[float] = (0.0, 0.0, 1.0), device: str = "cpu",
) -> GougeCheck:  # fmt: skip
    """Predict local gouging at ``grid`` x ``grid`` points, and the largest of the mills (R, r), shape (m, 2).

    ``axis``: the tool's, away from its tip, of any length. Raises InputError for a cutter that is not convex.
    """
    started = perf_counter()
    length = float(np.linalg.norm(axis))
    if not length > 0.0:
        raise InputError(f"the tool axis must have a direction, got {tuple(axis)}")
    unit = np.asarray(axis, dtype=float) / length
    points = sample_grid(surface, grid, grid, margin)
    jet = evaluate(surface, points.phi.ravel(), points.v.ravel(), device)
    found = predict_at(jet, cutter, unit)
    theta, part = found.contacts.theta, found.contacts.part
    mine = np.flatnonzero(np.isfinite(theta + part.a) & (theta <= 0.5 * np.pi + 1e-9))
    choice = largest_mills(mills, np.where(np.isin(np.arange(len(theta)), mine), theta, np.pi), part)
    both = beside_best(theta[mine], part[mine], mills) if len(mine) else None
    place = points.point.reshape(-1, 3)[mine[both.best.limiting]] if both else np.full(3, np.nan)
    shape = points.shape
    sizes = SizeChoice(points, choice.shank.reshape(shape), choice.corner.reshape(shape), mills, both, tuple(place))
    least = np.where(found.touches, found.comparison.least, np.inf)
    worst = int(np.argmin(least)) if found.touches.any() else -1
    return GougeCheck(
        scene={"scene": {"name": surface.name, "summary": f"local gouging of {surface.name} by a {cutter.name}"}},
        device=device,
        findings=(),
        verdict="fail" if found.gouges.any() else "pass",
        status=Status.OK.name or "OK",
        counts={"points": int(least.size)},
        timings_s={"total": perf_counter() - started},
        versions=versions(),
        frame="part frame of the control net",
        surface=surface,
        cutter=cutter,
        axis=unit,
        samples=found,
        sizes=sizes,
        worst=worst,
    )


def read_surface(name_or_path: str, number: int, flip: bool) -> tuple[NurbsSurface, int]:
    """One surface of a file or of the shipped ones, its normal turned if wanted; and how many there are."""
    surfaces = load_surfaces(name_or_path)
    if not 1 <= number <= len(surfaces):
        raise InputError(f"--number {number}: {name_or_path} holds {len(surfaces)} surface(s)")
    surface = surfaces[number - 1]
    return (replace(surface, flip=not surface.flip) if flip else surface), len(surfaces)


def read_mills(name_or_path: str) -> NDArray:
    """A catalogue of end mills (R, r) [mm]: ``khan``, ``metric``, or a file with R and r in every line."""
    if name_or_path in ("khan", "metric"):
        return khan_mills() if name_or_path == "khan" else metric_mills()
    mills: list[list[float]] = []
    for number, line in enumerate(read_input(Path(name_or_path), "catalogue").splitlines(), 1):
        words = line.partition("#")[0].replace(",", " ").replace(";", " ").split()
        if not words or (not mills and not _is_number(words[0])):
            continue
        pair = [_number(w) for w in words]
        if len(pair) != 2 or not 0.0 <= pair[1] <= pair[0] or not pair[0] > 0.0:
            raise InputError(
                f"{name_or_path}, line {number}: expected shank radius R and corner radius r in mm with "
                f"0 <= r <= R, got {line.strip()!r}"
            )
        mills.append(pair)
    if not mills:
        raise InputError(f"{name_or_path}: no mills in this catalogue; each line holds R and r in mm, like 10, 2")
    return ranked(np.array(mills))


def _number(text: str) -> float:
    return float(text) if _is_number(text) else float("nan")


def _is_number(text: str) -> bool:
    try:
        return bool(np.isfinite(float(text)))
    except ValueError:
        return False
