"""Reads an IGES or STEP file with Open CASCADE and writes its faces as JSON: ``cad_reader.py FILE OUT``.

Run by `surfaces.cad_file` in a process of its own; imports nothing of gearsim. Exit code 1 with one line of reason.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from typing import Any

from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve2d
from OCP.BRepTools import BRepTools, BRepTools_WireExplorer
from OCP.collections import Array1_double
from OCP.Geom import Geom_BSplineSurface, Geom_OffsetSurface, Geom_RectangularTrimmedSurface
from OCP.GeomAbs import GeomAbs_CurveType, GeomAbs_Shape
from OCP.GeomConvert import GeomConvert
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.IGESControl import IGESControl_Reader
from OCP.Interface import Interface_Static
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

_STEPS = 192
"""Steps of a bent boundary curve; a straight one, and every piece of it, has a few, where joins are looked at."""
_FEWEST = 16
_NAMELESS = "(name) not a quoted String"
"""What Open CASCADE calls a failure where a name is left out ($), as Rhino does."""


def read(file: Path) -> tuple[Any, list[str]]:
    """The shape of a file, scaled to mm, and what is wrong with entities that were left out."""
    step = file.suffix.lower() in (".stp", ".step")
    reader = STEPControl_Reader() if step else IGESControl_Reader()
    Interface_Static.SetIVal_s("read.iges.bspline.continuity", 0)  # surfaces with edges inside stay whole
    if reader.ReadFile(str(file)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        sys.exit("Open CASCADE finds it damaged")
    failures = list(damaged(reader.WS(), step))
    if step and failures:
        sys.exit("; ".join(failures[:3]))
    if not reader.TransferRoots():
        sys.exit("; ".join(failures[:3]) or "it has no shape that Open CASCADE can build; expected surfaces")
    return reader.OneShape(), failures


def damaged(session: Any, step: bool) -> Iterator[str]:
    """What is wrong with a STEP file's syntax or with geometry: the reader itself only leaves such entities out."""
    checks, model = session.ModelCheckList(), session.Model()
    checks.Start()
    while checks.More():
        number, check = checks.Number(), checks.Value()
        entity: Any = model.Value(number) if number else None
        kind = entity.DynamicType().Name() if number else ""
        said = [check.CFail(k).replace(" %d", "") for k in range(1, check.NbFails() + 1)]
        said = [s for s in said if _NAMELESS not in s]
        if said and (kind.startswith(("IGESGeom", "StepGeom")) or (step and not number)):
            where = f"entity {entity.TypeNumber()}, D line {model.DNum(entity)}: " if kind.startswith("IGES") else ""
            where = f"{kind.removeprefix('StepGeom_')}: " if kind.startswith("Step") else where
            yield where + "; ".join(said)
        checks.Next()


def faces(shape: Any) -> Iterator[tuple[Any, bool]]:
    """All faces, and whether they bound a solid, so that their material side is known."""
    seen: dict[int, list[Any]] = {}
    for container, solid in [(c, True) for c in parts(shape, TopAbs_ShapeEnum.TopAbs_SOLID)] + [(shape, False)]:
        for face in parts(container, TopAbs_ShapeEnum.TopAbs_FACE):
            same = seen.setdefault(hash(face), [])
            if not any(face.IsSame(other) for other in same):
                same.append(face)
                yield TopoDS.Face(face), solid


def parts(shape: Any, kind: Any) -> Iterator[Any]:
    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def b_spline(face: Any) -> tuple[Any, bool]:
    """The face's surface as an open B-spline surface, and whether it keeps the parameters of the boundary curves."""
    surface = BRep_Tool.Surface_s(face)
    own = isinstance(surface, Geom_BSplineSurface)
    if isinstance(surface, Geom_OffsetSurface):
        raise ValueError("an offset surface has no exact B-spline form")
    if not own:
        u0, u1, v0, v1 = BRepTools.UVBounds_s(face)
        u0, u1 = clipped(u0, u1, surface.UPeriod() if surface.IsUPeriodic() else None, surface.Bounds()[:2])
        v0, v1 = clipped(v0, v1, surface.VPeriod() if surface.IsVPeriodic() else None, surface.Bounds()[2:])
        surface = GeomConvert.SurfaceToBSplineSurface_s(Geom_RectangularTrimmedSurface(surface, u0, u1, v0, v1))
    if surface.IsUPeriodic():
        surface.SetUNotPeriodic()
    if surface.IsVPeriodic():
        surface.SetVNotPeriodic()
    return surface, own


def clipped(low: float, high: float, period: float | None, bounds: tuple[float, ...]) -> tuple[float, float]:
    """A face's range of a parameter without the tolerance by which it passes the period or the surface's ends."""
    if period is not None:
        return low, min(high, low + period)
    return max(low, bounds[0]), min(high, bounds[1])


def loops(face: Any, surface: Any, own: bool) -> list[list[list[list[float]]]]:
    """The boundary curves, each as rows (u, v) or, where the parameters changed, (u, v, x, y, z), end to end."""
    found = []
    for wire in parts(face, TopAbs_ShapeEnum.TopAbs_WIRE):
        explorer, edges = BRepTools_WireExplorer(TopoDS.Wire(wire), face), []
        while explorer.More():
            edges.append(explorer.Current())
            explorer.Next()
        if len(edges) != sum(1 for _ in parts(wire, TopAbs_ShapeEnum.TopAbs_EDGE)):
            raise ValueError("its boundary is not one closed chain of curves")
        found.append([curve(edge, face, own) for edge in edges])
    return found


def curve(edge: Any, face: Any, own: bool) -> list[list[float]]:
    """One boundary curve in the sense in which it bounds the face."""
    line = BRepAdaptor_Curve2d(edge, face)
    count = line.NbIntervals(GeomAbs_Shape.GeomAbs_C2)
    ends = Array1_double(1, count + 1)
    line.Intervals(ends, GeomAbs_Shape.GeomAbs_C2)
    straight = line.GetType() == GeomAbs_CurveType.GeomAbs_Line
    steps = _FEWEST if straight else max(_FEWEST, _STEPS // count)
    at = [ends.Value(1)]
    for k in range(1, count + 1):
        a, b = ends.Value(k), ends.Value(k + 1)
        at += [a + (b - a) * i / steps for i in range(1, steps + 1)]
    if edge.Orientation() == TopAbs_Orientation.TopAbs_REVERSED:
        at.reverse()
    places = [line.Value(t) for t in at]
    if own:
        return [[p.X(), p.Y()] for p in places]
    surface = BRep_Tool.Surface_s(face)
    return [[p.X(), p.Y(), q.X(), q.Y(), q.Z()] for p in places for q in [surface.Value(p.X(), p.Y())]]


def entry(face: Any, name: str, solid: bool) -> dict[str, Any]:
    """A face: its surface as control nets are written in JSON, its boundary, whether it bounds a solid."""
    s, own = b_spline(face)
    rows, columns = range(1, s.NbUPoles() + 1), range(1, s.NbVPoles() + 1)
    poles = [[s.Pole(i, j) for j in columns] for i in rows]
    if not all(isfinite(x) for row in poles for p in row for x in (p.X(), p.Y(), p.Z())):
        raise ValueError("its surface has no finite control points")
    return {
        "surface": {
            "name": name,
            "degree": [s.UDegree(), s.VDegree()],
            "knots": [
                [s.UKnot(i) for i in range(1, s.NbUKnots() + 1) for _ in range(s.UMultiplicity(i))],
                [s.VKnot(i) for i in range(1, s.NbVKnots() + 1) for _ in range(s.VMultiplicity(i))],
            ],
            "points": [[[p.X(), p.Y(), p.Z()] for p in row] for row in poles],
            "weights": [[s.Weight(i, j) for j in columns] for i in rows],
            "flip": face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED,
        },
        "loops": loops(face, s, own),
        "solid": solid,
    }


def document(file: Path) -> dict[str, Any]:
    """All faces of a file, and the names of those that were skipped with the reasons."""
    shape, failures = read(file)
    found, skipped, number = [], [["", reason] for reason in failures], 0
    for number, (face, solid) in enumerate(faces(shape), 1):
        try:
            found.append(entry(face, f"face {number}", solid))
        except Exception as error:
            skipped.append([f"face {number}", reason_of(error)])
    if not found and skipped:
        sys.exit("; ".join(": ".join(x for x in s if x) for s in skipped[:3]))
    if not found:
        sys.exit("it has no surface; expected faces (IGES 128 and others, STEP B_SPLINE_SURFACE and others)")
    return {"faces": found, "skipped": skipped}


def reason_of(error: Exception) -> str:
    return str(error).splitlines()[0] if str(error) else type(error).__name__


def main() -> None:
    file, out = map(Path, sys.argv[1:3])
    try:
        found = document(file)
    except Exception as error:
        sys.exit(f"Open CASCADE refuses it: {reason_of(error)}")
    out.write_text(json.dumps(found), encoding="utf-8")


if __name__ == "__main__":
    main()
