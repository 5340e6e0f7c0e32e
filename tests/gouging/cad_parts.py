"""Parts made with Open CASCADE, written as STEP and IGES; and its reader run in the tests' own process, for speed."""

import tempfile
from pathlib import Path

import pytest


def in_process(monkeypatch):
    """Read CAD files without a process for each; skips the test where the library is missing."""
    pytest.importorskip("OCP")
    from gearsim.surfaces import cad_file, cad_reader

    def read(file, text):
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder) / f"file{file.suffix.lower()}"
            copy.write_bytes(text.encode("latin-1"))
            return cad_reader.document(copy)

    monkeypatch.setattr(cad_file, "_read_apart", read)


def write_step(shape, file):
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

    writer = STEPControl_Writer()
    writer.Transfer(shape, STEPControl_StepModelType.STEPControl_AsIs)
    writer.Write(str(file))


def write_iges(shape, file, solid=True):
    """``solid``: as a boundary representation (186), else as trimmed surfaces (144)."""
    from OCP.IGESControl import IGESControl_Writer

    writer = IGESControl_Writer("MM", 1 if solid else 0)
    writer.AddShape(shape)
    writer.ComputeModel()
    writer.Write(str(file))


def block(x, y, z, at=(0.0, 0.0, 0.0)):
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt

    low = gp_Pnt(*at)
    return BRepPrimAPI_MakeBox(low, gp_Pnt(at[0] + x, at[1] + y, at[2] + z)).Shape()


def axis_at(at, direction=(0.0, 0.0, 1.0)):
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    return gp_Ax2(gp_Pnt(*at), gp_Dir(*direction))


def cylinder(radius, height, at, direction=(0.0, 0.0, 1.0)):
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder

    return BRepPrimAPI_MakeCylinder(axis_at(at, direction), radius, height).Shape()


def cone(bottom, top, height, at):
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone

    return BRepPrimAPI_MakeCone(axis_at(at), bottom, top, height).Shape()


def sphere(radius, at):
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere

    return BRepPrimAPI_MakeSphere(axis_at(at), radius).Shape()


def torus(major, minor, at=(0.0, 0.0, 0.0)):
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeTorus

    return BRepPrimAPI_MakeTorus(axis_at(at), major, minor).Shape()


def cut(one, other):
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

    return BRepAlgoAPI_Cut(one, other).Shape()


def fused(one, other):
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse

    return BRepAlgoAPI_Fuse(one, other).Shape()


def filleted(shape, radius, chosen):
    """All edges rounded whose two ends' points (x, y, z) ``chosen`` accepts."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp, TopExp_Explorer
    from OCP.TopoDS import TopoDS

    maker, explorer, seen = BRepFilletAPI_MakeFillet(shape), TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_EDGE), []
    while explorer.More():
        edge = TopoDS.Edge(explorer.Current())
        ends = [BRep_Tool.Pnt_s(f(edge)) for f in (TopExp.FirstVertex_s, TopExp.LastVertex_s)]
        if not any(edge.IsSame(e) for e in seen) and chosen(*((p.X(), p.Y(), p.Z()) for p in ends)):
            seen.append(edge)
            maker.Add(radius, edge)
        explorer.Next()
    return maker.Shape()


def revolved_parabola(radius, rim):
    """The open shell z = (x² + y²) / (2 radius) up to the radius ``rim``, as a surface of revolution with a pole."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeRevol
    from OCP.collections import Array1_gp_Pnt
    from OCP.Geom import Geom_BezierCurve
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt

    poles = Array1_gp_Pnt(1, 3)
    for k, p in enumerate([(0.0, 0.0, 0.0), (0.5 * rim, 0.0, 0.0), (rim, 0.0, 0.5 * rim * rim / radius)], 1):
        poles.SetValue(k, gp_Pnt(*p))
    edge = BRepBuilderAPI_MakeEdge(Geom_BezierCurve(poles)).Edge()
    return BRepPrimAPI_MakeRevol(edge, gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Shape()
