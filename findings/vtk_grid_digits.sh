#!/bin/sh
# VTK 9.7: a binary legacy file (.vtk) of a grid keeps every bit of the values and six digits of where they are.
#
# Origin and spacing stand in the file's text head, written with six significant digits, whatever the precision of the
# data and also in binary files. A map that begins at 1234.5678 mm moves by 2.2 um and, with 9001 columns of 1/75 mm,
# shrinks by 0.3 um, while the deviations on it stay the same bits. The XML file (.vti) of the same grid is exact.
#
# Expected: binary means lossless (docs of the format: the head is text, the data may be ASCII or binary; digits are not
# spoken of). Exits 0 while this is so.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q vtk==9.7.2 numpy==2.4.6 >/dev/null 2>&1 || { echo "the packages cannot be fetched"; exit 2; }
venv/bin/python - <<'END'
import sys

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOLegacy import vtkDataSetReader, vtkDataSetWriter
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLImageDataWriter

print("vtk", vtkVersion.GetVTKVersion())
columns = 9001
deviation = np.random.default_rng(0).normal(size=columns)
grid = vtkImageData()
grid.SetDimensions(columns, 1, 1)
grid.SetOrigin(1234.5678, 0.0, 0.0)
grid.SetSpacing(1 / 75, 1.0, 1.0)
grid.GetPointData().SetScalars(numpy_to_vtk(deviation, deep=True))


def back(writer, reader, name):
    """How far the first and the last column move in um, and whether the values are the same bits."""
    writer.SetFileName(name)
    writer.SetInputData(grid)
    writer.Write()
    reader.SetFileName(name)
    reader.Update()
    read = reader.GetOutput()
    moved = [1e3 * (read.GetPoint(i)[0] - grid.GetPoint(i)[0]) for i in (0, columns - 1)]
    return moved, np.array_equal(vtk_to_numpy(read.GetPointData().GetScalars()), deviation)


legacy = vtkDataSetWriter()
legacy.SetFileTypeToBinary()
(first, last), same = back(legacy, vtkDataSetReader(), "grid.vtk")
print(f".vtk, binary: expected 0 um; seen first column {first:+.3f} um, last {last:+.3f} um, values the same: {same}")
(xml_first, xml_last), xml_same = back(vtkXMLImageDataWriter(), vtkXMLImageDataReader(), "grid.vti")
print(f".vti: expected 0 um; seen {xml_first:+.3f} um, {xml_last:+.3f} um, values the same: {xml_same}")
with open("grid.vtk", "rb") as file:
    print(*(line.decode() for line in file.read(300).split(b"\n") if line[:4] in (b"ORIG", b"SPAC")), sep="; ")
as_before = same and abs(first - 2.2) < 0.01 and abs(last - 1.9) < 0.01 and (xml_first, xml_last) == (0, 0) and xml_same
print("as before" if as_before else "CHANGED")
sys.exit(not as_before)
END
