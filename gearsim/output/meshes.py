"""Meshes for 3D pictures and tooth.vtp, as VTK holds them: points, polygons, lines, values at points."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray


def mesh(
    points: NDArray, faces: Sequence[NDArray] = (), lines: NDArray | None = None, values: Mapping[str, NDArray] = {},
    cells: Mapping[str, NDArray] = {},
) -> Any:  # fmt: skip
    """Points [mm], shape (n, 3); faces, arrays of point numbers (m, corners); lines, shape (k, 2); n values each.

    ``cells``: values of lines and faces, in this order. Coordinates are kept in the precision that they come in.
    """
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkPolyData

    out, at = vtkPolyData(), vtkPoints()
    at.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    out.SetPoints(at)
    if faces:
        out.SetPolys(_cells(faces))
    if lines is not None:
        out.SetLines(_cells([lines]))
    for data, given in ((out.GetPointData(), values), (out.GetCellData(), cells)):
        for name, value in given.items():
            array = numpy_to_vtk(np.ascontiguousarray(value), deep=True)
            array.SetName(name)
            data.AddArray(array)
    return out


def _cells(groups: Sequence[NDArray]) -> Any:
    """Cells of some corners each, given as arrays (cells, corners) of point numbers."""
    from vtkmodules.util.numpy_support import numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonDataModel import vtkCellArray

    sizes = np.concatenate([np.full(len(group), group.shape[1]) for group in groups])
    ends = np.append(0, np.cumsum(sizes)).astype(np.int64)
    corners = np.concatenate([np.ravel(group) for group in groups]).astype(np.int64)
    cells = vtkCellArray()
    cells.SetData(numpy_to_vtkIdTypeArray(ends, deep=True), numpy_to_vtkIdTypeArray(corners, deep=True))
    return cells


def quads(points: NDArray, values: Mapping[str, NDArray] = {}) -> Any:
    """A mesh of quads between neighbours of a grid of points, (rows, columns, 3), that all exist, with their values."""
    rows, columns = points.shape[:2]
    index = np.arange(rows * columns).reshape(rows, columns)
    faces = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    flat = points.reshape(-1, 3)
    faces = faces[np.isfinite(flat[faces]).all(axis=(1, 2))]
    used, faces = np.unique(faces, return_inverse=True)
    kept = {name: value.reshape(rows * columns, *value.shape[2:])[used] for name, value in values.items()}
    return mesh(flat[used], [faces.reshape(-1, 4)], values=kept)


def segments(starts: NDArray, ends: NDArray) -> Any:
    """One mesh of straight lines from points to points, both shape (n, 3)."""
    n = len(starts)
    return mesh(np.concatenate([starts, ends]), lines=np.column_stack([np.arange(n), n + np.arange(n)]))


def joined(parts: Iterable[Any]) -> Any:
    """Several meshes as one; their points are not merged, values are kept that all have."""
    from vtkmodules.vtkFiltersCore import vtkAppendPolyData

    append = vtkAppendPolyData()
    for part in parts:
        append.AddInputData(part)
    return run(append)


def points_of(shape: Any) -> NDArray:
    """A mesh's points, shape (n, 3)."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    return np.asarray(vtk_to_numpy(shape.GetPoints().GetData()))


def values_of(shape: Any, name: str) -> NDArray:
    """Values at a mesh's points."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    return np.asarray(vtk_to_numpy(shape.GetPointData().GetArray(name)))


def triangles_of(shape: Any) -> NDArray:
    """A mesh's faces as triangles, point numbers, shape (m, 3)."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersCore import vtkTriangleFilter

    triangles = vtkTriangleFilter()
    triangles.SetInputData(shape)
    triangles.PassLinesOff()
    triangles.PassVertsOff()
    return np.asarray(vtk_to_numpy(run(triangles).GetPolys().GetConnectivityArray())).reshape(-1, 3)


def run(made_by: Any) -> Any:
    """What a VTK filter makes."""
    made_by.Update()
    return made_by.GetOutput()


def write_vtp(shape: Any, notes: Mapping[str, str], file: Path) -> None:
    """Write a mesh as VTK's XML, notes as its field data under ``gearsim.``.

    The text is VTK's, but Python writes it: VTK's own writing ends the process where the disk takes no more.
    """
    from vtkmodules.vtkCommonCore import vtkStringArray
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    for key, text in notes.items():
        note = vtkStringArray()
        note.SetName(f"gearsim.{key}")
        note.InsertNextValue(text)
        shape.GetFieldData().AddArray(note)
    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(shape)
    writer.SetDataModeToBinary()
    writer.WriteToOutputStringOn()
    writer.Write()
    file.write_text(writer.GetOutputString(), encoding="ascii")
