"""Reads an IGES or STEP file with Open CASCADE and writes its surfaces as JSON: ``cad_reader.py FILE OUT``.

Run by `surfaces.cad_file` in a process of its own; imports nothing of gearsim. Exit code 1 with one line of reason.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from OCP.BRep import BRep_Tool
from OCP.BRepTools import BRepTools
from OCP.Geom import Geom_BSplineSurface, Geom_RectangularTrimmedSurface
from OCP.GeomConvert import GeomConvert
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.IGESControl import IGESControl_Reader
from OCP.Interface import Interface_Static
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS


def faces(file: Path) -> Iterator[Any]:
    """All faces of the file, scaled to mm and put in their places."""
    step = file.suffix.lower() in (".stp", ".step")
    reader = STEPControl_Reader() if step else IGESControl_Reader()
    Interface_Static.SetIVal_s("read.iges.bspline.continuity", 0)  # surfaces with edges inside stay whole
    if reader.ReadFile(str(file)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        sys.exit("Open CASCADE finds it damaged")
    failures = list(damaged(reader.WS(), step))
    if failures:
        sys.exit("; ".join(failures[:3]))
    if not reader.TransferRoots():
        sys.exit("it has no shape that Open CASCADE can build; expected B-spline surfaces")
    explorer = TopExp_Explorer(reader.OneShape(), TopAbs_ShapeEnum.TopAbs_FACE)
    while explorer.More():
        yield TopoDS.Face(explorer.Current())
        explorer.Next()


def damaged(session: Any, step: bool) -> Iterator[str]:
    """What is wrong with a STEP file's syntax or with geometry: the reader itself only leaves such entities out."""
    checks, model = session.ModelCheckList(), session.Model()
    checks.Start()
    while checks.More():
        number, check = checks.Number(), checks.Value()
        entity: Any = model.Value(number) if number else None
        kind = entity.DynamicType().Name() if number else ""
        if check.NbFails() and (kind.startswith(("IGESGeom", "StepGeom")) or (step and not number)):
            where = f"entity {entity.TypeNumber()}, D line {model.DNum(entity)}: " if kind.startswith("IGES") else ""
            where = f"{kind.removeprefix('StepGeom_')}: " if kind.startswith("Step") else where
            yield where + "; ".join(check.CFail(k).replace(" %d", "") for k in range(1, check.NbFails() + 1))
        checks.Next()


def b_spline(face: Any) -> Any:
    """The face's surface as an open B-spline surface."""
    surface = BRep_Tool.Surface_s(face)
    if not isinstance(surface, Geom_BSplineSurface):
        surface = GeomConvert.SurfaceToBSplineSurface_s(
            Geom_RectangularTrimmedSurface(surface, *BRepTools.UVBounds_s(face))
        )
    if surface.IsUPeriodic():
        surface.SetUNotPeriodic()
    if surface.IsVPeriodic():
        surface.SetVNotPeriodic()
    return surface


def entry(face: Any, number: int) -> dict[str, Any]:
    """The surface of a face as control nets are written in JSON."""
    s = b_spline(face)
    rows, columns = range(1, s.NbUPoles() + 1), range(1, s.NbVPoles() + 1)
    poles = [[s.Pole(i, j) for j in columns] for i in rows]
    return {
        "name": f"face {number}",
        "degree": [s.UDegree(), s.VDegree()],
        "knots": [
            [s.UKnot(i) for i in range(1, s.NbUKnots() + 1) for _ in range(s.UMultiplicity(i))],
            [s.VKnot(i) for i in range(1, s.NbVKnots() + 1) for _ in range(s.VMultiplicity(i))],
        ],
        "points": [[[p.X(), p.Y(), p.Z()] for p in row] for row in poles],
        "weights": [[s.Weight(i, j) for j in columns] for i in rows],
        "flip": face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED,
    }


def main() -> None:
    file, out = map(Path, sys.argv[1:3])
    try:
        found = [entry(face, n) for n, face in enumerate(faces(file), 1)]
    except Exception as error:
        sys.exit(f"Open CASCADE refuses it: {str(error).splitlines()[0] if str(error) else type(error).__name__}")
    if not found:
        sys.exit("it has no surface; expected B-spline surfaces (IGES 128, STEP B_SPLINE_SURFACE)")
    out.write_text(json.dumps(found), encoding="utf-8")


if __name__ == "__main__":
    main()
