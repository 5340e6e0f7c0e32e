"""Surfaces' files as other programs read them."""

import json
import re
import shutil
import subprocess
from zipfile import ZipFile

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.triangles import TriangleMesh
from gearsim.output.solid_files import SolidSurface, solid_surface, write_solid
from gearsim.simulation.contour.surface import contour
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.normals import EndNormals
from gearsim.simulation.stock import blank_stock, cut_stock
from gearsim.simulation.workshop import Workshop
from tests.limits import files_no_larger_than
from tests.simulation.test_contour import CUTS, PLATE

NAMES = ("move",) * 3


def make_stock():
    """A plate with a slot, a groove and a hole, in a box whose lattice is square with nothing."""
    box = DexelBox(Rigid(np.eye(3), np.zeros(3)), PLATE.lower - 0.37, PLATE.upper + 0.51, 0.7)
    return cut_stock(blank_stock(box, PLATE), CUTS, Workshop("cpu"))


@pytest.fixture(scope="module")
def surface():
    stock = make_stock()
    return solid_surface(contour(stock, EndNormals(PLATE, CUTS, "cpu")).mesh, stock)


def vtk_read(reader, file):
    from vtkmodules.util.numpy_support import vtk_to_numpy

    reader.SetFileName(str(file))
    reader.Update()
    data = reader.GetOutput()
    triangles = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return data, vtk_to_numpy(data.GetPoints().GetData()), triangles


def test_stl_is_watertight_by_admesh(surface, tmp_path):
    if shutil.which("admesh") is None:
        pytest.skip("no admesh on this machine")
    write_solid(surface, tmp_path / "part.stl")
    told = subprocess.run(["admesh", "part.stl"], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    for what in ("Total disconnected facets", "Degenerate facets", "Edges fixed", "Facets reversed", "Backwards edges"):
        assert set(re.search(rf"{what} +: +(.*?)(?:  Volume.*)?\n", told)[1].split()) == {"0"}, what
    assert re.search(r"Number of parts +: +(\d+)", told)[1] == "1"
    volume = re.search(r"Volume +: +([\d.]+)", told)[1]
    assert float(volume) == pytest.approx(surface.mesh.volume, rel=1e-5)


def test_stl_holds_the_triangles_in_single_precision(surface, tmp_path):
    from vtkmodules.vtkIOGeometry import vtkSTLReader

    write_solid(surface, tmp_path / "part.stl")
    data, _, _ = vtk_read(vtkSTLReader(), tmp_path / "part.stl")
    assert data.GetNumberOfCells() == len(surface.mesh.triangles)
    raw = np.fromfile(tmp_path / "part.stl", dtype=np.dtype([("f", "<f4", (4, 3)), ("a", "<u2")]), offset=84)
    corners = surface.mesh.points[surface.mesh.triangles]
    assert np.array_equal(raw["f"][:, 1:], corners.astype(np.float32))
    area = surface.mesh.area_vectors
    size = np.linalg.norm(area, axis=1)
    assert np.allclose(raw["f"][:, 0][size > 0], (area / size[:, None])[size > 0], atol=1e-6)


def test_ply_holds_points_and_tags_exactly(surface, tmp_path):
    from vtkmodules.vtkIOPLY import vtkPLYReader

    write_solid(surface, tmp_path / "part.ply")
    _, points, triangles = vtk_read(vtkPLYReader(), tmp_path / "part.ply")
    assert np.array_equal(points, surface.mesh.points.astype(points.dtype))
    assert np.array_equal(triangles, surface.mesh.triangles)
    head, body = (tmp_path / "part.ply").read_bytes().split(b"end_header\n", 1)
    assert head.count(b"comment operation") == 4
    points = np.frombuffer(body, dtype="<f8", count=3 * len(surface.mesh.points))
    assert np.array_equal(points.reshape(-1, 3), surface.mesh.points)
    row = np.dtype([("n", "u1"), ("v", "<i4", 3), ("tag", "<i4"), ("operation", "<i4")])
    faces = np.frombuffer(body, dtype=row, offset=points.nbytes)
    assert np.array_equal(faces["tag"], surface.mesh.tag)
    assert np.array_equal(faces["operation"], surface.operation)


def test_vtp_holds_everything(surface, tmp_path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    write_solid(surface, tmp_path / "part.vtp")
    data, points, triangles = vtk_read(vtkXMLPolyDataReader(), tmp_path / "part.vtp")
    assert np.array_equal(points, surface.mesh.points)
    assert np.array_equal(triangles, surface.mesh.triangles)
    for name, values in (("tag", surface.mesh.tag), ("operation", surface.operation)):
        assert np.array_equal(vtk_to_numpy(data.GetCellData().GetArray(name)), values)
    notes = {
        name: data.GetFieldData().GetAbstractArray(f"gearsim.{name}").GetValue(0) for name in ("unit", "operations")
    }
    assert notes["unit"] == "mm"
    assert tuple(json.loads(notes["operations"])) == NAMES


def test_3mf_is_read_by_lib3mf(surface, tmp_path):
    lib3mf = pytest.importorskip("lib3mf")
    named = SolidSurface(surface.mesh, surface.operation, ('Nut "A" <1>', "rück & seite\x07", "c"))
    write_solid(named, tmp_path / "part.3mf")
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(tmp_path / "part.3mf"))
    assert reader.GetWarningCount() == 0
    assert model.GetUnit() == lib3mf.ModelUnit.MilliMeter
    meshes = model.GetMeshObjects()
    assert meshes.MoveNext()
    mesh = meshes.GetCurrentMeshObject()
    assert mesh.IsManifoldAndOriented()
    points = np.array([list(v.Coordinates) for v in mesh.GetVertices()])
    assert np.array_equal(points.astype(np.float32), points)
    assert np.allclose(points, surface.mesh.points, rtol=1e-7, atol=1e-7)
    assert np.array_equal([list(t.Indices) for t in mesh.GetTriangleIndices()], surface.mesh.triangles)
    materials = model.GetBaseMaterialGroups()
    assert materials.MoveNext()
    group = materials.GetCurrentBaseMaterialGroup()
    keys = group.GetAllPropertyIDs()
    assert [group.GetName(k) for k in keys] == ["blank", 'Nut "A" <1>', "rück & seite ", "c"]
    made = [mesh.GetTriangleProperties(i).PropertyIDs[0] for i in range(0, len(surface.operation), 50)]
    assert np.array_equal(made, np.array(keys)[surface.operation[::50] + 1])


def test_3mf_keeps_12_digits(surface, tmp_path):
    write_solid(surface, tmp_path / "part.3mf")
    text = ZipFile(tmp_path / "part.3mf").read("3D/3dmodel.model").decode()
    found = np.array(re.findall(r'<vertex x="(.*?)" y="(.*?)" z="(.*?)"', text), dtype=float)
    assert np.allclose(found, surface.mesh.points, rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("ending", [".stl", ".ply", ".vtp", ".3mf"])
def test_a_file_is_whole_or_as_it_was(surface, tmp_path, ending):
    file = tmp_path / f"part{ending}"
    file.write_text("older")
    with files_no_larger_than(20_000), pytest.raises(InputError, match=r"cannot write surface .*part"):
        write_solid(surface, file)
    assert file.read_text() == "older"
    assert list(tmp_path.iterdir()) == [file]
    nothing = SolidSurface(TriangleMesh(np.empty((0, 3)), np.empty((0, 3), dtype=int), np.empty(0, dtype=int)),
                           np.empty(0, dtype=int), ())  # fmt: skip
    write_solid(nothing, file)
    assert file.stat().st_size > 80


def test_another_ending_is_refused(surface, tmp_path):
    with pytest.raises(InputError, match=r"part\.obj: the name of a surface's file ends in \.stl, \.ply, \.vtp, \.3mf"):
        write_solid(surface, tmp_path / "part.obj")
