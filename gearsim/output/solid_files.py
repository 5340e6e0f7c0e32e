"""Closed surfaces as files: STL, PLY, VTP and 3MF; every face with what made it, where the format can tell."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError, written
from gearsim.geometry.triangles import TriangleMesh
from gearsim.output.meshes import mesh as vtk_mesh
from gearsim.output.meshes import write_vtp
from gearsim.output.package_3mf import write_3mf
from gearsim.simulation.stock import Stock

_CHUNK = 1 << 18


@dataclass(frozen=True)
class SolidSurface:
    """A closed surface with the operations that made it.

    ``operation``, shape (m,): of each triangle, its place in ``operations``, their names; -1: the blank itself.
    """

    mesh: TriangleMesh
    operation: NDArray[np.integer]
    operations: tuple[str, ...]


def solid_surface(mesh: TriangleMesh, stock: Stock) -> SolidSurface:
    """A stock's surface with the names of what was done to it."""
    return SolidSurface(mesh, stock.operation_of(mesh.tag), tuple(done.name for done in stock.done))


def write_solid(surface: SolidSurface, file: Path) -> None:
    """Write a surface, in mm, in the format that the file's name ends in: .stl, .ply, .vtp or .3mf.

    Raises InputError for another ending, and where the file cannot be written; then an older one is as it was.
    """
    write = _WRITERS.get(file.suffix.lower())
    if write is None:
        raise InputError(f"{file}: the name of a surface's file ends in {', '.join(_WRITERS)}")
    with written(file, "surface") as scratch:
        write(surface, scratch)


def _write_stl(surface: SolidSurface, file: Path) -> None:
    """Binary STL: float32, so that points are off by up to 6e-8 of their coordinates; without units and operations."""
    mesh = surface.mesh
    row = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    with file.open("wb") as out:
        out.write(b"binary STL, mm".ljust(80) + np.array(len(mesh.triangles), dtype="<u4").tobytes())
        for part in _parts(len(mesh.triangles)):
            corners = mesh.points[mesh.triangles[part]]
            normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            length = np.linalg.norm(normal, axis=1, keepdims=True)
            rows = np.zeros(len(corners), dtype=row)
            rows["normal"], rows["corners"] = normal / np.where(length > 0.0, length, 1.0), corners
            out.write(rows.tobytes())


def _write_ply(surface: SolidSurface, file: Path) -> None:
    """Binary PLY: float64 points; ``tag`` and ``operation`` of every face, the operations' names as comments."""
    mesh = surface.mesh
    head = [
        "ply", "format binary_little_endian 1.0", "comment unit mm", "comment operation -1: the blank itself",
        *(f"comment operation {i}: {' '.join(name.split())}" for i, name in enumerate(surface.operations)),
        f"element vertex {len(mesh.points)}", *(f"property double {k}" for k in "xyz"),
        f"element face {len(mesh.triangles)}", "property list uchar int vertex_indices", "property int tag",
        "property int operation", "end_header",
    ]  # fmt: skip
    row = np.dtype([("count", "u1"), ("corners", "<i4", 3), ("tag", "<i4"), ("operation", "<i4")])
    with file.open("wb") as out:
        out.write("".join(f"{line}\n" for line in head).encode())
        out.write(mesh.points.astype("<f8").tobytes())
        for part in _parts(len(mesh.triangles)):
            rows = np.empty(len(mesh.triangles[part]), dtype=row)
            rows["count"], rows["corners"] = 3, mesh.triangles[part]
            rows["tag"], rows["operation"] = mesh.tag[part], surface.operation[part]
            out.write(rows.tobytes())


def _write_vtp(surface: SolidSurface, file: Path) -> None:
    """VTK's XML: float64 points; ``tag`` and ``operation`` of every cell; unit and operations' names as field data."""
    cells = {"tag": surface.mesh.tag.astype(np.int32), "operation": surface.operation.astype(np.int32)}
    notes = {"unit": "mm", "operations": json.dumps(surface.operations)}
    write_vtp(vtk_mesh(surface.mesh.points, [surface.mesh.triangles], cells=cells), notes, file)


def _write_3mf(surface: SolidSurface, file: Path) -> None:
    """3MF: a material for the blank and one for each operation."""
    write_3mf(surface.mesh, surface.operation + 1, ["blank", *surface.operations], file)


def _parts(count: int) -> Iterator[slice]:
    return (slice(begin, begin + _CHUNK) for begin in range(0, count, _CHUNK))


_WRITERS = {".stl": _write_stl, ".ply": _write_ply, ".vtp": _write_vtp, ".3mf": _write_3mf}
