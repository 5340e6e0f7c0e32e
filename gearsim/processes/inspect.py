"""The command ``gearsim inspect``."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry.nearest import Span, span
from gearsim.metrology.stock_check import StockInspection
from gearsim.output.files import PART, STOCK
from gearsim.output.plane_section import cut_part, read_plane, told
from gearsim.output.point_cloud import require_cloud, write_points
from gearsim.output.run_folder import MeasuredGrid, RunFolder
from gearsim.output.screen import print_line
from gearsim.output.section_files import require_section, write_section
from gearsim.output.step import write_step
from gearsim.processes.run import plan
from gearsim.scene.loading import check_scene
from gearsim.simulation.ends import material_ends
from gearsim.simulation.removal import open_device
from gearsim.simulation.sequence import end_normals
from gearsim.simulation.stock_file import load_stock
from gearsim.surfaces.cad_file import STEP_SUFFIXES
from gearsim.surfaces.fitted import Fitted, fit_grid, whole_block

_DEVICE = "cpu"
_FARTHEST = 1e6  # mm


def inspect(options: argparse.Namespace) -> int:
    """Answer what is asked of a run's folder; returns the exit code. Raises InputError for anything that is missing."""
    run = RunFolder(options.run)
    asked = [(read_plane(plane), Path(file)) for plane, file in options.section]
    places = [(text, _places(text)) for text in options.distance]
    _require_files([file for _, file in asked], options.points, options.step)
    if not (asked or places or options.points or options.step):
        for line in _there(run):
            print_line(line)
        return 0
    part = run.part() if places or (asked and ((run.folder / PART).exists() or not run.grids())) else None
    for plane, file in asked:
        cut = cut_part(plane, part, run.grids())
        write_section(cut, file)
        print_line(f"{file}: section {plane.text} mm: " + "; ".join(told(cut)))
    for text, (first, second) in places:
        assert part is not None
        print_line(f"{text}: {_distance(span(part.mesh, first, second), first, second)}")
    if options.points:
        _write_points(run, options.points)
    if options.step:
        _write_step(run, options.step)
    return 0


def _require_files(sections: list[Path], points: Path | None, step: Path | None) -> None:
    """Raise InputError, before any is written, where a name ends in no format or two answers would be one file."""
    for file in sections:
        require_section(file)
    if points is not None:
        require_cloud(points)
    if step is not None and step.suffix.lower() not in STEP_SUFFIXES:
        raise InputError(f"--step {step}: the name of a STEP file ends in {', '.join(STEP_SUFFIXES)}")
    named = [file.resolve() for file in (*sections, points, step) if file is not None]
    twice = next((file for k, file in enumerate(named) if file in named[:k]), None)
    if twice is not None:
        raise InputError(f"{twice}: it is named twice; every answer has a file of its own")


def _distance(found: Span, first: NDArray, second: NDArray) -> str:
    one, other = (float(np.linalg.norm(a - b)) for a, b in ((found.first, first), (found.second, second)))
    return (
        f"{found.distance:.6f} mm between ({_numbers(found.first)}) and ({_numbers(found.second)}), the points of the "
        f"surface {one:.3g} and {other:.3g} mm from there; along x, y, z: {_numbers(found.second - found.first)} mm"
    )


def _places(text: str) -> NDArray:
    try:
        places = np.array([[float(x) for x in place.split(",")] for place in text.split()])
        if places.shape == (2, 3) and (np.abs(places) < _FARTHEST).all():
            return places
    except ValueError:
        pass
    raise InputError(
        f"--distance {text!r}: expected two places in mm, each coordinate below {_FARTHEST:g}, such as "
        "'13,8,-6 27,8,-6'"
    )


def _there(run: RunFolder) -> Iterator[str]:
    """What there is to ask for."""
    report, grids = run.report(), run.grids()
    yield f"{run.folder}: {report['scene']['scene']['name']}, verdict {report['verdict']}"
    for grid in grids:
        yield f"  {grid.name}: {grid.deviation.shape[0]} x {grid.deviation.shape[1]} samples (--section, --step)"
    if (run.folder / STOCK).exists():
        stock, _ = load_stock(run.folder / STOCK)
        done = ", ".join(d.name for d in stock.done)
        volume = float(np.mean(stock.volumes))
        yield f"  stock: {volume:,.1f} mm3, rays {stock.box.pitch:g} mm apart, after {done} (--points)"
    if (run.folder / PART).exists():
        mesh = run.part().mesh
        low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
        reach = f"from ({_numbers(low)}) to ({_numbers(high)}) mm"
        yield f"  surface: {len(mesh.triangles):,} triangles {reach} (--section, --distance)"
    elif not grids:
        yield "  neither a whole part nor surfaces measured on grids"


def _write_points(run: RunFolder, file: Path) -> None:
    """The stock's ends with their normals, which the scene as the report holds it knows."""
    stock, _ = load_stock(run.file(STOCK, "its scene has no [stock]"))
    open_device(_DEVICE)
    job = plan(check_scene(run.report()["scene"], f"of {run.folder}"))
    asked = next((i for i in job.inspections if isinstance(i, StockInspection)), None)
    if asked is None:
        raise InputError(f"{run.folder}: the scene in its report has no [stock]")
    ends = material_ends(stock, end_normals(asked.machining(job), _DEVICE, job.settings.tolerance_mm))
    write_points(ends, stock, file)
    print_line(f"{file}: {len(ends.tag):,} points with normals")


def _write_step(run: RunFolder, file: Path) -> None:
    """Every grid of samples as a face, and how far the samples are off it."""
    grids = run.grids()
    if not grids:
        raise InputError(f"{run.folder} holds no samples of surfaces measured on grids: nothing to fit")
    fits, lines = [], []
    for grid in grids:
        rows, columns = whole_block(grid.machined)
        fitted = _fitted(grid, rows, columns)
        fits.append(fitted.surface)
        part = f"rows {rows.start} to {rows.stop - 1}, columns {columns.start} to {columns.stop - 1}"
        off = f"at most {1e3 * fitted.largest:.3g} um off, rms {1e3 * fitted.rms:.3g} um"
        lines.append(f"{grid.name}: {part} of its samples, {off}")
    name = run.report()["scene"]["scene"]["name"]
    write_step(fits, file, [f"machined surfaces of {name}, mm, by gearsim; fit error at the samples:", *lines])
    for line in (f"{file}: {len(fits)} B-spline faces", *lines):
        print_line(line)


def _fitted(grid: MeasuredGrid, rows: slice, columns: slice) -> Fitted:
    """A grid's machined points fitted, its normal out of the material."""
    points, normal = grid.machined[rows, columns], grid.normal[rows, columns]
    across = np.cross(np.gradient(points, axis=0), np.gradient(points, axis=1)) if min(points.shape[:2]) > 1 else normal
    return fit_grid(points, grid.name, flip=float(np.nansum(across * normal)) < 0.0)


def _numbers(values: NDArray) -> str:
    return ", ".join(f"{x:.6f}" for x in values)
