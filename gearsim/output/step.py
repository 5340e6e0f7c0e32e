"""B-spline surfaces as STEP (AP 214), by Open CASCADE (the extra ``cad``)."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError, written
from gearsim.surfaces.nurbs import NurbsSurface

_EDGE_MM = 1e-6


def write_step(surfaces: Sequence[NurbsSurface], file: Path, notes: Sequence[str] = ()) -> None:
    """Write surfaces as the faces of one STEP file, in mm, their control nets as they are, to 1e-11 mm.

    ``notes`` are the description in the file's header, a text each.
    Raises InputError where Open CASCADE is missing, a surface is no face to it, or the file cannot be written.
    """
    if find_spec("OCP") is None:
        raise InputError(f"writing {file} needs Open CASCADE: install gearsim[cad] (cadquery-ocp-novtk, 380 MB)")
    from OCP.BRep import BRep_Builder
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.Interface import Interface_Static
    from OCP.Message import Message
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer
    from OCP.TopoDS import TopoDS_Compound

    Message.DefaultMessenger_s().ChangePrinters().Clear()  # it talks to the screen
    builder, whole = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(whole)
    for surface in surfaces:
        builder.Add(whole, _face(surface))
    writer = STEPControl_Writer()
    Interface_Static.SetCVal_s("write.step.unit", "MM")
    writer.Transfer(whole, STEPControl_StepModelType.STEPControl_AsIs)
    _describe(writer, notes)
    with written(file, "STEP file") as scratch:
        if writer.Write(str(scratch)) != IFSelect_ReturnStatus.IFSelect_RetDone:
            raise OSError("Open CASCADE cannot write it; is the disk full?")


def _describe(writer: Any, notes: Sequence[str]) -> None:
    from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
    from OCP.collections import HArray1_TCollection_HAsciiString
    from OCP.TCollection import TCollection_HAsciiString

    if not notes:
        return
    texts = HArray1_TCollection_HAsciiString(1, len(notes))
    for k, note in enumerate(notes, 1):
        texts.SetValue(k, TCollection_HAsciiString(note.encode("ascii", "replace").decode()))
    APIHeaderSection_MakeHeader(writer.Model()).SetDescription(texts)


def _face(surface: NurbsSurface) -> Any:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.collections import Array2_double, Array2_gp_Pnt
    from OCP.Geom import Geom_BSplineSurface
    from OCP.gp import gp_Pnt

    rows, columns = surface.points.shape[:2]
    poles, weights = Array2_gp_Pnt(1, rows, 1, columns), Array2_double(1, rows, 1, columns)
    for i, j in np.ndindex(rows, columns):
        poles.SetValue(i + 1, j + 1, gp_Pnt(*surface.points[i, j].tolist()))
        weights.SetValue(i + 1, j + 1, float(surface.weights[i, j]))
    (knots_u, often_u), (knots_v, often_v) = (_knots(k) for k in (surface.knots_u, surface.knots_v))
    degrees = surface.degree_u, surface.degree_v
    made = BRepBuilderAPI_MakeFace(
        Geom_BSplineSurface(poles, weights, knots_u, knots_v, often_u, often_v, *degrees), _EDGE_MM
    )
    if not made.IsDone():
        raise InputError(
            f"{surface.name}: Open CASCADE makes no face of it; a side of the surface is a point or closed"
        )
    face = made.Face()
    return face.Reversed() if surface.flip else face


def _knots(full: NDArray) -> tuple[Any, Any]:
    """Different knots and how often each stands."""
    from OCP.collections import Array1_double, Array1_int

    values, often = np.unique(full, return_counts=True)
    knots, counts = Array1_double(1, len(values)), Array1_int(1, len(values))
    for i, (value, count) in enumerate(zip(values.tolist(), often.tolist(), strict=True), 1):
        knots.SetValue(i, value)
        counts.SetValue(i, count)
    return knots, counts
