"""What a whole part leaves behind: files that agree with one another, a picture and shapes for the view."""

import json

import numpy as np
import pyarrow.parquet as pq
import pytest

from gearsim.cli import main
from gearsim.output.canvas import Canvas
from gearsim.output.whole_part import draw_whole, looked_at, whole_shapes
from gearsim.simulation.stock_file import load_stock


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    out = tmp_path_factory.mktemp("plate")
    assert main(["run", "drill-grid", "--set", "stock.pitch_mm=1.0", "--out", str(out)]) == 0
    return out


@pytest.fixture(scope="module")
def figures(folder):
    return json.loads((folder / "report.json").read_text())["measurements"]["part"]["program"]["stock"]


def test_all_files_are_there_and_nothing_is_left_of_the_work(folder):
    names = {f.name for f in folder.iterdir()}
    solids = {"part.stl", "part.3mf", "part.vtp", "part.png"}
    assert names == solids | {"stock.parquet", "operations.parquet", "report.json", "report.md", "report.html"}


def test_the_stock_in_the_file_is_the_one_in_the_report(folder, figures):
    stock, job = load_stock(folder / "stock.parquet")
    assert job == "drill-grid"
    assert list(stock.volumes) == pytest.approx(figures["left_mm3"], rel=1e-15)
    assert [d.name for d in stock.done] == ["through holes", "blind holes", "slot"]
    assert figures["bytes_a_ray"] <= 48.0


def test_rows_add_up_to_their_operations(folder, figures):
    rows = pq.read_table(folder / "operations.parquet").to_pydict()
    for k, told in enumerate(figures["operations"]):
        own = np.array(rows["operation"]) == k
        assert own.sum() == told["rows"]
        volume = np.array(rows["volume_mm3"])[own]
        assert volume.sum() == pytest.approx(np.mean(told["removed_mm3"]), rel=1e-6)  # as many rays as the coarse look
        fed = own & (np.array(rows["rapid"]) == 0)
        assert np.array(rows["seconds"], dtype=float)[fed].sum() == pytest.approx(told["feed_s"])
    meta = pq.read_schema(folder / "operations.parquet").field("volume_mm3").metadata
    assert b"first to take" in meta[b"meaning"]


def test_the_surface_is_closed_and_encloses_what_is_told(folder, figures):
    data = (folder / "part.stl").read_bytes()
    row = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    corners = np.frombuffer(data[84:], row)["corners"].astype(float)
    assert len(corners) == figures["surface"]["triangles"]
    a, b, c = corners.transpose(1, 0, 2)
    volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0
    assert volume == pytest.approx(figures["surface"]["volume_mm3"], rel=1e-5)
    assert abs(volume - figures["left_mm3"][2]) < figures["surface"]["volume_bound_mm3"]
    assert np.abs(0.5 * np.cross(b - a, c - a).sum(axis=0)).max() < 1e-2  # area vectors of a closed surface


def test_the_report_tells_of_every_operation_and_holds_the_view(folder):
    text = (folder / "report.md").read_text()
    assert "## The whole part" in text
    for name in ("through holes", "blind holes", "slot"):
        assert f"| {name} |" in text
    html = (folder / "report.html").read_text()
    assert "whole part, measured faces" in html
    assert '"tool mark"' in html


def data_of(deviation):
    """Two triangles, one looking down that was cut, one of the blank."""
    points = np.array([[0, 0, 0], [0, 1, 0], [1, 0, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1.0]])
    return {
        "whole:points": points, "whole:triangles": np.array([[0, 1, 2], [3, 4, 5]]), "whole:tag": np.array([12, -1]),
        "whole:operation": np.array([0, -1]), "whole:names": np.array(["slot"]), "whole:tools": np.array(["flat"]),
        "whole:deviation_um": np.array(deviation), "whole:limit_um": np.array(5.0),
    }  # fmt: skip


def test_faces_without_a_value_are_steel_and_the_eye_sees_what_was_cut():
    nan = np.nan
    data = data_of([1.0, 2.0, -3.0, nan, nan, nan])
    measured, other = whole_shapes(data)
    assert measured.colours["deviation"].value.tolist() == [1.0, 2.0, -3.0]
    assert measured.colours["tool mark"].number.tolist() == [3]
    assert "deviation" not in other.colours
    assert other.colours["operation"].names == ("blank", "slot")
    assert other.colours["operation"].number.tolist() == [0]
    way, up = looked_at(data)
    assert way[2] < 0.0
    assert up[2] == -1.0
    assert [s.name for s in whole_shapes(data_of([nan] * 6))] == ["whole part, other faces"]


def test_a_part_of_which_nothing_is_left_is_drawn_as_that(tmp_path):
    data = data_of([]) | {
        "whole:points": np.empty((0, 3)), "whole:triangles": np.empty((0, 3), dtype=int),
        "whole:tag": np.empty(0, dtype=int), "whole:operation": np.empty(0, dtype=int),
    }  # fmt: skip
    canvas = Canvas()
    draw_whole(data, {}, canvas)
    canvas.save(tmp_path / "part.png")
    assert (tmp_path / "part.png").stat().st_size > 1000
    assert whole_shapes(data) == []
