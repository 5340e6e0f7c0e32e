"""Solids from files: STL, binary or text, and STEP."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError, read_input_bytes
from gearsim.geometry.faceted import Faceted
from gearsim.geometry.triangles import TriangleMesh
from gearsim.surfaces.cad_file import STEP_SUFFIXES, mesh_step

_MOST = 5_000_000  # triangles
_LARGEST = 1e5  # mm
_VERTEX = re.compile(rb"\bvertex\s+(\S+)\s+(\S+)\s+(\S+)", re.IGNORECASE)
_ROW = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


class SolidFile(NamedTuple):
    """A ``solid``, and in words how its file was read."""

    solid: Faceted
    told: str


def read_solid(file: Path, chord: float, scale: float | None, at: NDArray) -> SolidFile:
    """A closed body of an STL file, or of a STEP file by triangles within ``chord`` [mm] of it, moved by ``at`` [mm].

    ``scale``: mm in a unit of the STL file, which names none. Raises InputError for a file that holds no such body.
    """
    name = f"stock.blank: {file}"
    if file.suffix.lower() in STEP_SUFFIXES:
        if scale is not None:
            raise InputError(f"{name}: a STEP file says its unit itself; remove scale")
        found = mesh_step(file, chord)
        corners, within = found["corners"], f"within {float(found['chord']):.3g} mm of the surfaces, chord_mm {chord:g}"
    elif file.suffix.lower() == ".stl":
        corners = _stl(read_input_bytes(file, "solid"), name) * (1.0 if scale is None else scale)
        within = "no unit is said in it, mm are assumed" if scale is None else f"one of its units is {scale:g} mm"
    else:
        raise InputError(f"{name}: a solid is read from .stl, {', '.join(STEP_SUFFIXES)}")
    size = float(np.abs(corners).max(initial=0.0))
    if not size < _LARGEST:
        raise InputError(f"{name}: it reaches to {size:.3g} mm; expected less than {_LARGEST:g}; is its unit mm?")
    solid = Faceted(joined(corners + at), name)
    lower, upper = solid.box
    measures = " x ".join(f"{x:.6g}" for x in upper - lower)
    return SolidFile(solid, f"{name}: {len(solid.mesh.triangles):,} triangles, {measures} mm; {within}")


def joined(corners: NDArray) -> TriangleMesh:
    """A surface of triangles given by their corners, shape (m, 3, 3): equal corners are one, flat ends are left out."""
    points, number = np.unique(corners.reshape(-1, 3) + 0.0, axis=0, return_inverse=True)
    triangles = number.reshape(-1, 3)
    triangles = triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)]
    return TriangleMesh(points, triangles, np.full(len(triangles), -1))


def _stl(data: bytes, name: str) -> NDArray:
    """Corners of an STL file's triangles, shape (m, 3, 3). Raises InputError for what is none."""
    count = int.from_bytes(data[80:84], "little")
    if len(data) >= 84 and len(data) == 84 + _ROW.itemsize * count:
        corners = np.frombuffer(data, dtype=_ROW, offset=84)["corners"].astype(float)
    elif data.lstrip()[:5].lower() == b"solid" and re.search(rb"\bendsolid\b", data[-4096:], re.IGNORECASE):
        corners = _text(data, name)
    else:
        raise InputError(
            f"{name}: no whole STL file: a text begins with solid and ends with endsolid, a binary file with "
            f"{count:,} triangles has {84 + _ROW.itemsize * count:,} bytes; it has {len(data):,}"
        )
    if len(corners) > _MOST:
        raise InputError(f"{name}: {len(corners):,} triangles; expected no more than {_MOST:,}")
    if not np.isfinite(corners).all():
        raise InputError(f"{name}: triangle {int(np.argmin(np.isfinite(corners).all(axis=(1, 2)))) + 1} is not finite")
    return corners


def _text(data: bytes, name: str) -> NDArray:
    found = _VERTEX.findall(data)
    facets = len(re.findall(rb"\bendfacet\b", data, re.IGNORECASE))
    if len(found) != 3 * facets:
        raise InputError(f"{name}: {len(found)} corners of {facets} facets; expected three of each")
    try:
        return np.array(found, dtype=float).reshape(-1, 3, 3)
    except ValueError as error:
        raise InputError(f"{name}: a corner is no number: {error}") from error
