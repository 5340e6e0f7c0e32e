"""``gearsim inspect``: sections, distances, points and STEP surfaces of what a run has left."""

import csv
import json
import re

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from matplotlib.image import imread

from gearsim.cli import main
from gearsim.geometry.grid_sections import cut_grid
from gearsim.output.plane_section import read_plane
from gearsim.output.run_folder import RunFolder
from gearsim.simulation.stock_file import load_stock
from gearsim.surfaces.fitted import whole_block
from tests.surfaces.test_fitted import flank, off_flank

AREA = 60.0 * 40.0 - np.pi * (6.0 * 3.0**2 + 3.0 * 2.5**2)  # of the plate 5 mm below its top: six holes and three


@pytest.fixture(scope="module")
def plate(tmp_path_factory):
    out = tmp_path_factory.mktemp("plate")
    only = ["--no-pictures", "--only", "report.json,part.vtp,stock.parquet"]
    assert main(["run", "drill-grid", "--set", "stock.pitch_mm=1.0", "--out", str(out), *only]) == 0
    return out


@pytest.fixture
def tooth(tmp_path):
    """A run's folder that holds samples of one flank: an involute, machined 3 um too high in the middle."""
    grid = flank(17, 21)
    along, up = np.gradient(grid, axis=1), np.gradient(grid, axis=0)
    normal = np.cross(along, up)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    row, column = np.indices(grid.shape[:2])
    um = 3.0 * np.sin(np.pi * row / 16) * np.sin(np.pi * column / 20)
    um[:, 0] = np.nan
    columns = {"surface": np.full(um.size, "left"), "row": row.ravel(), "column": column.ravel()}
    columns |= {f"{k}_mm": grid[..., i].ravel() for i, k in enumerate("xyz")}
    columns |= {f"n{k}": normal[..., i].ravel() for i, k in enumerate("xyz")}
    pq.write_table(pa.table(columns | {"program_um": pa.array(um.ravel(), mask=np.isnan(um.ravel()))}),
                   tmp_path / "samples.parquet")  # fmt: skip
    (tmp_path / "report.json").write_text(json.dumps(
        {"scene": {"scene": {"name": "tooth"}}, "program": "program", "verdict": "pass"}))  # fmt: skip
    return tmp_path


def asked(folder, *arguments):
    assert main(["inspect", str(folder), *map(str, arguments)]) == 0


def test_without_options_it_says_what_there_is(plate, tooth, capsys):
    asked(plate)
    told = capsys.readouterr().out
    assert "drill-grid, verdict pass" in told
    assert "after through holes, blind holes, slot (--points)" in told
    asked(tooth)
    assert "left: 17 x 21 samples (--section, --step)" in capsys.readouterr().out


def test_a_section_of_the_plate_is_what_was_drilled(plate, tmp_path, capsys):
    files = {kind: tmp_path / f"cut.{kind}" for kind in ("csv", "vtp", "svg", "png")}
    asked(plate, *(text for file in files.values() for text in ("--section", "z=-5", file)))
    told = capsys.readouterr().out
    area = float(re.search(r"material ([\d.]+) mm2 in 10 loops", told)[1])
    assert area == pytest.approx(AREA, rel=2e-3)
    rows = list(csv.DictReader(files["csv"].open()))
    outer = np.array([[float(r["x_mm"]), float(r["y_mm"])] for r in rows if r["name"] == "outer"])
    assert np.allclose([outer.min(axis=0), outer.max(axis=0)], [[0.0, 0.0], [60.0, 40.0]], atol=1e-9)
    assert {r["z_mm"] for r in rows} == {"-5.0"}
    first = np.array([[float(r["x_mm"]), float(r["y_mm"])] for r in rows if r["curve"] == rows[-1]["curve"]])
    radius = np.linalg.norm(first - first.mean(axis=0), axis=1)
    assert np.abs(radius - 3.0).max() < 0.07 or np.abs(radius - 2.5).max() < 0.07
    assert '<VTKFile type="PolyData"' in files["vtp"].read_text()[:200]
    assert "<svg" in files["svg"].read_text()
    picture = imread(files["png"])
    assert 0.1 < (np.abs(picture[..., :3] - [0.851, 0.867, 0.890]).max(axis=-1) < 0.01).mean() < 0.9


def test_a_section_shows_the_intended_line_and_what_was_measured_along_it(tooth, tmp_path, capsys):
    asked(tooth, "--section", "z=10", tmp_path / "cut.csv", "--section", "n=0,0,2;d=10", tmp_path / "cut.png")
    first, second = capsys.readouterr().out.splitlines()
    assert first.split(": ", 2)[2] == second.split(": ", 2)[2]  # one plane
    every = list(csv.DictReader((tmp_path / "cut.csv").open()))
    rows, machined = ([r for r in every if r["kind"] == kind] for kind in ("intended", "machined"))
    assert {(r["name"], r["closed"], r["deviation_um"]) for r in machined} == {("left", "0", "")}
    off = off_flank(np.array([[float(r[f"{k}_mm"]) for k in "xyz"] for r in machined]))
    assert 1e3 * np.abs(off).max() == pytest.approx(
        3.25, rel=0.02
    )  # in the transverse plane: over the cosine of the helix angle
    points = np.array([[float(r[f"{k}_mm"]) for k in "xyz"] for r in rows])
    um = np.array([float(r["deviation_um"]) for r in rows])
    assert {(r["kind"], r["name"], r["closed"]) for r in rows} == {("intended", "left", "0")}
    assert np.abs(points[:, 2] - 10.0).max() < 1e-12
    assert np.abs(off_flank(points)).max() < 1e-9  # z = 10 is a column of the grid
    assert um.max() == pytest.approx(3.0)
    assert um.min() == pytest.approx(0.0, abs=1e-12)


def test_planes_between_grid_lines_cut_as_straight_as_the_grid_is():
    x, y = np.meshgrid(np.arange(5.0), np.arange(4.0), indexing="ij")
    grid = np.stack([x, y, x + 2.0 * y], axis=-1)
    grid[4, 3] = np.nan
    normal = np.array([0.0, 0.0, 1.0])
    ((points, values),) = cut_grid(grid, np.array([0.0, 0.0, 2.5]), normal, x - y)
    assert np.allclose(points[:, 2], 2.5, atol=1e-14)
    assert np.allclose(points[:, 0] + 2.0 * points[:, 1], 2.5, atol=1e-14)
    assert np.allclose(values, points[:, 0] - points[:, 1], atol=1e-14)
    assert cut_grid(grid, np.array([0.0, 0.0, 20.0]), normal, x) == []
    (whole, _), *_ = cut_grid(grid, np.array([0.0, 0.0, 3.0]), normal, x)  # through points of the grid
    assert np.allclose(whole[:, 0] + 2.0 * whole[:, 1], 3.0, atol=1e-14)


def test_a_cut_through_many_cells_stays_in_the_plane():
    x, y = np.meshgrid(np.linspace(0.0, 3.0, 21), np.linspace(0.0, 27.0, 257), indexing="ij")
    grid = np.stack([x, y, np.sin(0.2 * y) + 0.3 * x], axis=-1)
    normal = np.array([0.2, 0.1, 0.97]) / np.linalg.norm([0.2, 0.1, 0.97])
    count = 0
    for height in np.linspace(-0.5, 3.0, 40):  # whole numbers of rows and columns come back off by a digit
        at = np.array([0.0, 0.0, height])
        for points, value in cut_grid(grid, at, normal, x):
            assert np.abs((points - at) @ normal).max() < 1e-8
            assert np.abs(value - points[:, 0]).max() < 1e-8
            count += len(points)
    assert count > 2000


def test_distances_are_from_face_to_face(plate, capsys):
    asked(plate, "--distance", "-5,20.5,-8 66,20.5,-8", "--distance", "30,25,-20 30,25,3")
    told = capsys.readouterr().out.splitlines()
    assert [float(re.search(r": ([\d.]+) mm between", line)[1]) for line in told] == [60.0, 12.0]
    assert "of the surface 5 and 6 mm from there" in told[0]


def test_points_are_the_ends_of_all_rays(plate, tmp_path, capsys):
    files = [tmp_path / f"ends.{kind}" for kind in ("ply", "csv", "parquet")]
    for file in files:
        asked(plate, "--points", file)
    stock, _ = load_stock(plate / "stock.parquet")
    table = pq.read_table(files[2])
    assert len(table) == 2 * sum(len(k.lo) for k in stock.left)
    assert f"{files[0]}: {len(table):,} points" in capsys.readouterr().out
    head, body = files[0].read_bytes().split(b"end_header\n", 1)
    row = np.dtype([*((k, "<f8") for k in ("x", "y", "z", "nx", "ny", "nz")), ("tag", "<i4"), ("operation", "<i4")])
    cloud = np.frombuffer(body, row)
    assert b"comment operation 2: slot" in head
    assert np.array_equal(cloud["x"], table["x_mm"])
    assert np.array_equal(cloud["tag"], table["tag"].fill_null(-1))
    rows = list(csv.DictReader(files[1].open()))
    assert [float(r["z_mm"]) for r in rows] == table["z_mm"].to_pylist()
    slot = cloud[cloud["operation"] == 2]
    assert len(slot) > 100
    assert np.all((np.abs(slot["z"] + 3.0) < 1e-9) | (np.abs(np.abs(slot["y"] - 20.0) - 2.0) < 1e-9) | (slot["x"] > 59))


def test_machined_flanks_come_back_from_step_within_the_stated_error(tooth, tmp_path, capsys):
    pytest.importorskip("OCP")
    from OCP.BRep import BRep_Tool
    from OCP.GeomAPI import GeomAPI_ProjectPointOnSurf
    from OCP.gp import gp_Pnt
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    file = tmp_path / "machined.step"
    asked(tooth, "--step", file)
    stated = re.search(
        r"left: rows 0 to 16, columns 1 to 20 of its samples, at most ([\d.e-]+) um", capsys.readouterr().out
    )
    assert f"at most {stated[1]} um off" in re.sub(r"\s+", " ", file.read_text())
    reader = STEPControl_Reader()
    reader.ReadFile(str(file))
    reader.TransferRoots()
    face = TopoDS.Face(TopExp_Explorer(reader.OneShape(), TopAbs_ShapeEnum.TopAbs_FACE).Current())
    surface = BRep_Tool.Surface_s(face)
    (grid,) = RunFolder(tooth).grids()
    # a point beside the border has no foot within the face, and is nearest to an edge, which OCP does not look at
    off = np.array([GeomAPI_ProjectPointOnSurf(gp_Pnt(*p.tolist()), surface).LowerDistance()
                    for p in grid.machined[1:-1, 2:-1].reshape(-1, 3)])  # fmt: skip
    assert 0.5 < 1e3 * off.max() / float(stated[1]) < 1.001
    intended = [GeomAPI_ProjectPointOnSurf(gp_Pnt(*p.tolist()), surface).LowerDistance() for p in grid.point[8, 1:]]
    assert 1e3 * max(intended) == pytest.approx(3.0, rel=0.01)  # it is the machined surface, not the intended one


def test_borders_without_samples_are_left_out():
    grid = np.zeros((6, 8, 3))
    grid[0], grid[:, 7], grid[2, 0] = np.nan, np.nan, np.nan
    assert whole_block(grid) == (slice(1, 6), slice(1, 7))
    grid[3, 3] = np.nan
    assert whole_block(grid) == (slice(1, 6), slice(1, 7))  # a hole in the middle stays, and is refused by the fit


@pytest.mark.parametrize(
    "text",
    ["z", "w=3", "z=high", "n=1,0;d=2", "n=0,0,0;d=2", "n=1,0,0", "z=inf", "n=1,0,nan;d=1", "n=1e308,1e308,0;d=4"],
)
def test_planes_that_are_none_are_refused(text, plate, capsys):
    assert main(["inspect", str(plate), "--section", text, "cut.svg"]) == 2
    assert f"--section {text}: expected a plane such as z=-5" in capsys.readouterr().err


def test_a_planes_frame_is_right_handed():
    for text in ("x=1", "y=1", "z=1", "n=0,0,-1;d=2", "n=1,2,3;d=4", "n=-1,0,0;d=0"):
        plane = read_plane(text)
        u, v, _ = plane.frame
        assert np.allclose(np.cross(u, v), plane.normal, atol=1e-15)
    assert read_plane("n=0,3,4;d=5").point == pytest.approx([0.0, 3.0, 4.0])


def test_what_is_not_there_is_said(plate, tooth, tmp_path, capsys, monkeypatch):
    def told(folder, *arguments):
        assert main(["inspect", str(folder), *map(str, arguments)]) == 2
        return capsys.readouterr().err

    assert "is no run's folder" in told(tmp_path / "nowhere")
    assert "the plane meets nothing of the part" in told(plate, "--section", "z=50", tmp_path / "cut.svg")
    assert "ends in .svg, .pdf, .png, .csv, .vtp" in told(plate, "--section", "z=-5", tmp_path / "cut.dxf")
    assert "ends in .parquet, .csv, .ply" in told(plate, "--points", tmp_path / "ends.xyz")
    assert "expected two places in mm" in told(plate, "--distance", "1,2,3")
    assert "each coordinate below 1e+06" in told(plate, "--distance", "1e300,0,0 0,0,0")
    first = ("--section", "z=-5", tmp_path / "cut.svg")
    assert "the name of a STEP file ends in .stp, .step" in told(plate, *first, "--step", tmp_path / "tooth.igs")
    assert "ends in .parquet, .csv, .ply" in told(plate, *first, "--points", tmp_path / "ends.xyz")
    assert "cut.svg: it is named twice" in told(plate, *first, *first)
    assert not (tmp_path / "cut.svg").exists()
    assert "holds no samples of surfaces measured on grids" in told(plate, "--step", tmp_path / "tooth.step")
    assert "holds no part.vtp: its scene has no [stock]" in told(tooth, "--distance", "1,2,3 4,5,6")
    (bare := tmp_path / "bare").mkdir()
    (bare / "report.json").write_text((tooth / "report.json").read_text())
    assert "holds no part.vtp: its scene has no [stock]" in told(bare, "--section", "z=-5", tmp_path / "cut.svg")
    assert "holds no stock.parquet: its scene has no [stock]" in told(tooth, "--points", tmp_path / "ends.ply")
    monkeypatch.setattr("gearsim.output.step.find_spec", lambda _: None)
    assert "needs Open CASCADE: install gearsim[cad]" in told(tooth, "--step", tmp_path / "tooth.step")
    (tooth / "report.json").write_text("[]")
    assert "it is no report of a run" in told(tooth)
