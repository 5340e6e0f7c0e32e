"""Triangles of a STEP file's solids by Open CASCADE: ``cad_mesher.py FILE OUT CHORD``, all in mm.

Run by `surfaces.cad_file` in a process of its own, as `cad_reader.py` is, which it reads the file with. Open CASCADE's
linear deflection is what it aims at, no bound: how far triangles are off is measured, and they are made smaller until
it is within the chord. Exit code 1 with one line of reason.
"""

from __future__ import annotations

import sys
from math import dist
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.GeomAPI import GeomAPI_ProjectPointOnSurf
from OCP.gp import gp_Pnt
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopLoc import TopLoc_Location

from gearsim.surfaces.cad_reader import faces, parts, read, reason_of

_ANGLE = 0.35  # rad between neighbours
_TRIES = 6
_MOST = 2_000_000  # triangles
_WEIGHTS = np.array([[3, 3, 0], [0, 3, 3], [3, 0, 3], [2, 2, 2]]) / 6.0  # middles of edges, and of the triangle


def triangles(face: Any) -> tuple[NDArray, NDArray]:
    """Corners of a face's triangles, shape (m, 3, 3), outside seen counterclockwise; their (u, v), shape (m, 3, 2)."""
    place = TopLoc_Location()
    mesh = BRep_Tool.Triangulation_s(face, place)
    if mesh is None:
        raise ValueError("a face has no triangles")
    move = place.Transformation()
    points = [mesh.Node(i).Transformed(move) for i in range(1, mesh.NbNodes() + 1)]
    at = np.array([(p.X(), p.Y(), p.Z()) for p in points])
    uv = np.array([(p.X(), p.Y()) for p in (mesh.UVNode(i) for i in range(1, mesh.NbNodes() + 1))])
    corner = np.array([tuple(map(int, mesh.Triangle(i).Get())) for i in range(1, mesh.NbTriangles() + 1)]) - 1
    if face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED:
        corner = corner[:, ::-1]
    return at[corner], uv[corner]


def off(face: Any, corners: NDArray, uv: NDArray, enough: float) -> float:
    """How far middles of triangles are off a face's surface [mm]; those within ``enough`` by the same (u, v) pass."""
    surface, worst = BRep_Tool.Surface_s(face), 0.0
    for weights in _WEIGHTS:
        middles, places = np.einsum("k,mki->mi", weights, corners), np.einsum("k,mki->mi", weights, uv)
        for middle, place in zip(middles.tolist(), places.tolist(), strict=True):
            on = surface.Value(*place)
            away = dist(middle, (on.X(), on.Y(), on.Z()))
            if away > max(worst, enough):  # as about a pole, where (u, v) is no measure
                found = GeomAPI_ProjectPointOnSurf(gp_Pnt(*middle), surface)
                away = found.LowerDistance() if found.NbPoints() else away
            worst = max(worst, away)
    return worst


def document(file: Path, chord: float) -> dict[str, NDArray]:
    shape, _ = read(file)
    solids = list(parts(shape, TopAbs_ShapeEnum.TopAbs_SOLID))
    if not solids:
        sys.exit("it holds no solid; expected a closed body (MANIFOLD_SOLID_BREP), not surfaces alone")
    aim, worst = chord, float("inf")
    for _ in range(_TRIES):
        BRepTools.Clean_s(shape)
        BRepMesh_IncrementalMesh(shape, aim, False, _ANGLE, False)
        found = [(face, *triangles(face)) for face, solid in faces(shape) if solid]
        count = sum(len(corners) for _, corners, _ in found)
        if count > _MOST:
            sys.exit(f"chord_mm = {chord:g} makes {count:,} triangles; raise it")
        worst = max(off(*one, chord) for one in found)
        if worst <= chord:
            return {"corners": np.concatenate([corners for _, corners, _ in found]), "chord": np.array(worst)}
        aim *= 0.5
    sys.exit(f"its triangles are {worst:.3g} mm off the surface, not {chord:g} as chord_mm asks; raise it, or give STL")


def main() -> None:
    file, out, chord = Path(sys.argv[1]), Path(sys.argv[2]), float(sys.argv[3])
    try:
        found = document(file, chord)
    except Exception as error:
        sys.exit(f"Open CASCADE refuses it: {reason_of(error)}")
    np.savez(out, corners=found["corners"], chord=found["chord"])


if __name__ == "__main__":
    main()
