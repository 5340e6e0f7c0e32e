"""The suite `stock` at a tiny size; no assertion on time."""

import json

import numpy as np
import pytest

from gearsim.bench import stock_positions, stock_same_part, suites
from gearsim.bench.stock_rows import COLUMNS, against, stock_row
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.solid import Block
from gearsim.output.screen import print_bench
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.stock import blank_stock


@pytest.fixture
def tiny(monkeypatch):
    size = stock_same_part.Size((12, 4), (1.0, 2.0), (1.0, 2.0), (8, 12))
    monkeypatch.setattr(stock_same_part, "SIZES", {"small": size})
    monkeypatch.setattr(stock_positions, "SHARE", {"small": 0.002})
    monkeypatch.setattr(stock_positions, "GROWTH_SHARE", 0.002)


def test_three_representations_stand_side_by_side(tiny, capsys):
    pytest.importorskip("manifold3d")
    report = suites.run_suite("stock", "cpu")
    assert report["columns"] == list(COLUMNS)
    assert all(set(COLUMNS) <= set(row) for row in report["rows"])
    rows = {row["method"]: row for row in report["rows"] if row["case"] == stock_same_part.CASE}
    assert set(rows) == {"tri-dexel", "voxels", "manifold3d hulls"}
    for row in rows.values():
        assert row["figure"] == pytest.approx(row["seconds"] / rows["tri-dexel"]["seconds"])
        coarse, fine = row["levels"]
        assert 0.0 < fine["error"] < coarse["error"]
        assert fine["MB"] > coarse["MB"]
    assert rows["manifold3d hulls"]["goal"] == 1000.0
    print_bench(report)
    assert "manifold3d hulls" in capsys.readouterr().out
    json.dumps(report)


def test_positions_growth_and_bytes_of_a_block(tiny):
    rows, notes = stock_positions.positions("cpu", "small")
    units = ["positions/s", "positions/s by", "exponent", "exponent", "bytes a ray"]
    assert all(row["unit"].startswith(unit) for row, unit in zip(rows, units, strict=True))
    assert rows[-1]["figure"] == pytest.approx(32.0, abs=0.1)
    assert len(notes) == 1


def test_a_peer_that_is_missing_says_how_to_get_it(tiny, monkeypatch):
    monkeypatch.setattr(stock_same_part, "package", lambda name: None)
    rows, _ = stock_same_part.same_part("cpu", "small")
    assert rows[-1]["from"] == "not installed: pip install manifold3d"


def test_a_goal_is_met_from_above():
    assert against(1000.0, "times", 1000.0)["met"] == "yes"
    assert against(999.0, "times", 1000.0)["met"] == "no"
    assert stock_row("a", "b", seconds=1.0)["goal"] == "-"


def test_a_tri_dexel_is_as_far_from_a_face_as_it_is():
    block = Block(np.zeros(3), np.array([4.0, 3.0, 2.0]))
    box = DexelBox(Rigid(np.eye(3), np.zeros(3)), block.lower - 0.5, block.upper + 0.5, 0.5)
    points = np.array([[2.0, 1.5, 2.1], [4.0, 1.5, 1.0], [2.0, -0.03, 1.1]])
    normals = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    stock = blank_stock(box, block)
    for i, distance in enumerate((0.1, 0.0, 0.03)):
        found = stock_same_part.dexel_error(stock, points[i : i + 1], normals[i : i + 1])
        assert found == pytest.approx(distance, abs=1e-12)
