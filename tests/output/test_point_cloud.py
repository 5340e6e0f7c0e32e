import json

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.output.point_cloud import write_points
from gearsim.simulation.ends import material_ends
from gearsim.simulation.normals import EndNormals
from tests.limits import files_no_larger_than
from tests.output.test_solid_files import make_stock
from tests.simulation.test_contour import CUTS, PLATE


@pytest.fixture(scope="module")
def made():
    stock = make_stock()
    return stock, material_ends(stock, EndNormals(PLATE, CUTS, "cpu"))


def test_ends_lie_on_their_rays_and_look_out_of_the_material(made):
    stock, ends = made
    first = 0
    for axis, left in enumerate(stock.left):
        rays, n = stock.box.rays(axis), len(left.lo)
        points = rays.origin[left.ray] + left.hi[:, None] * rays.direction[left.ray]
        assert np.allclose(ends.point[first + n : first + 2 * n], points, atol=1e-12)
        assert np.all(ends.normal[first : first + n, axis] < 1e-9)
        assert np.all(ends.normal[first + n : first + 2 * n, axis] > -1e-9)
        assert np.all(ends.bundle[first : first + 2 * n] == axis)
        first += 2 * n
    assert len(ends.tag) == first
    assert np.allclose(np.linalg.norm(ends.normal, axis=1), 1.0, atol=1e-12)


def test_a_point_cloud_is_read_back(made, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    stock, ends = made
    write_points(ends, stock, tmp_path / "points.parquet")
    table = parquet.read_table(tmp_path / "points.parquet")
    assert np.array_equal(np.column_stack([table[f"{k}_mm"] for k in "xyz"]), ends.point)
    assert np.array_equal(np.column_stack([table[f"normal_{k}"] for k in "xyz"]), ends.normal)
    assert np.array_equal(table["tag"].fill_null(-1), ends.tag)
    names = [None if k < 0 else stock.done[k].name for k in stock.operation_of(ends.tag)]
    assert table["operation"].to_pylist() == names
    assert {None, "move"} == set(names)
    assert json.loads(table.schema.metadata[b"gearsim.columns"])["x_mm"]["unit"] == "mm"
    assert table.schema.metadata[b"gearsim.frame"] == b"that of the part"


def test_points_are_written_whole_or_not_at_all(made, tmp_path):
    stock, ends = made
    with files_no_larger_than(5_000), pytest.raises(InputError, match="cannot write points"):
        write_points(ends, stock, tmp_path / "points.parquet")
    assert list(tmp_path.iterdir()) == []
