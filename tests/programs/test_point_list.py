import re
from contextlib import suppress

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.programs.point_list import COLUMNS, PointList, format_points, parse_points, read_points, write_points

HEAD = "# units: mm\n# sign: out of the material\n"
GOOD = HEAD + "x_mm,y_mm,z_mm,nx,ny,nz\n1,2,3,0,0,1\n4,5,6,0,0.6,0.8\n"


def random_list(rng, **changes):
    normal = rng.normal(size=(12, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return PointList(**{"point": 80.0 * rng.normal(size=(12, 3)), "normal": normal, "flank": "convex", **changes})


@pytest.mark.parametrize("name", ["points.csv", "points.parquet"])
@pytest.mark.parametrize("shape", [None, (3, 4)])
def test_what_is_written_is_read_back_to_the_last_digit(rng, tmp_path, name, shape):
    points = random_list(rng, shape=shape, axis="z along the gear axis, origin at the pitch apex")
    write_points(points, tmp_path / name)
    again = read_points(tmp_path / name)
    assert np.array_equal(again.point, points.point)
    assert np.allclose(again.normal, points.normal, rtol=0.0, atol=3e-16)
    assert (again.flank, again.axis, again.shape) == (points.flank, points.axis, shape)


def test_the_header_says_what_the_numbers_mean(rng):
    lines = format_points(random_list(rng, shape=(3, 4))).splitlines()
    assert lines[:7] == [
        "# units: mm", "# axis: z along the gear axis", "# flank: convex", "# sign: out of the material",
        "# rows: 3", "# columns: 4", "x_mm,y_mm,z_mm,nx,ny,nz",
    ]  # fmt: skip


@pytest.mark.parametrize(
    "change",
    [
        lambda t: t.replace(",", "; "),
        lambda t: t.replace(",", "\t"),
        lambda t: t.replace("_mm", ""),
        lambda t: t.replace("x_mm,y_mm,z_mm,nx,ny,nz\n", ""),
        lambda t: "# made by hand\n\n" + t,
    ],
)
def test_separators_and_column_names_are_read_as_people_write_them(change):
    points = parse_points(change(GOOD), "p")
    assert np.array_equal(points.point, [[1, 2, 3], [4, 5, 6]])
    assert np.array_equal(points.normal, [[0, 0, 1], [0, 0.6, 0.8]])


def test_a_byte_order_mark_and_free_comments_do_not_stop_it():
    assert len(parse_points("\ufeff" + GOOD.replace("1,2,3", "# remark: colour\n1,2,3"), "p").point) == 2


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("# colums: 2", "p, line 1: unknown key 'colums'; did you mean 'columns'?"),
        ("# unit: mm", "p, line 1: unknown key 'unit'; did you mean 'units'?"),
        ("# units: inch", "p, line 2: units 'mm' contradicts 'inch' above"),
    ],
)
def test_a_misspelt_or_contradicted_key_is_refused(line, message):
    with pytest.raises(InputError, match=re.escape(message)):
        parse_points(line + "\n" + GOOD, "p")


def test_normals_into_the_material_are_turned():
    assert np.array_equal(parse_points(GOOD.replace("out of", "into"), "p").normal[0], [0, 0, -1])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (GOOD.replace("5", "five"), r"p.csv, line 5, column 2 \(y_mm\): 'five' is not a number"),
        (GOOD.replace(",5", ","), r"line 5, column 2 \(y_mm\): '' is not a number"),
        (GOOD.replace("6", "nan", 1), r"line 5, column 3 \(z_mm\): nan is not a finite number"),
        (GOOD.replace("0.6", "6"), r"line 5, columns 4 to 6: the normal has length 6.05"),
        (GOOD.replace(",0.8", ""), r"line 5: 5 columns; expected 6"),
        (GOOD.replace("nx,ny", "ny,nx"), r"line 3: columns x_mm, y_mm, z_mm, ny, nx, nz; expected x_mm"),
        (GOOD.replace("mm\n# s", "in\n# s"), "units 'in'; point lists are read in mm"),
        (GOOD.replace("# units: mm\n", ""), "no '# units: mm' in its header"),
        (GOOD.replace("out of the", "away from"), "'out of the material' or 'into the material'"),
        (GOOD.replace("# sign: out of the material\n", ""), "no '# sign:' in its header"),
        ("# rows: 2\n# columns: 3\n" + GOOD, "2 rows of 3 columns are 6 points; it holds 2"),
        ("# rows: 2\n" + GOOD, "whole numbers for both"),
        (HEAD, "no points"),
    ],
)
def test_a_malformed_file_is_told_by_line_and_column(tmp_path, text, message):
    (tmp_path / "p.csv").write_text(text)
    with pytest.raises(InputError, match=message):
        read_points(tmp_path / "p.csv")


def test_a_malformed_parquet_file_is_told(rng, tmp_path):
    file = tmp_path / "p.parquet"
    file.write_bytes(b"no parquet")
    with pytest.raises(InputError, match="not a Parquet file"):
        read_points(file)
    with pytest.raises(InputError, match="cannot read point list"):
        read_points(tmp_path / "none.parquet")
    pq.write_table(pa.table({c: [1.0] for c in COLUMNS[:-1]}), file)
    with pytest.raises(InputError, match="no column nz"):
        read_points(file)
    keys = {"gearsim.units": "mm", "gearsim.sign": "out of the material"}
    pq.write_table(pa.table({c: ["a"] for c in COLUMNS}).replace_schema_metadata(keys), file)
    with pytest.raises(InputError, match="column x_mm: it does not hold numbers"):
        read_points(file)
    rows = {c: [0.0, 1.0 if c == "nx" else 0.0] for c in COLUMNS} | {"ny": [1.0, None]}
    pq.write_table(pa.table(rows).replace_schema_metadata(keys), file)
    with pytest.raises(InputError, match=r"row 2, column 5 \(ny\): nan is not a finite number"):
        read_points(file)


@settings(max_examples=200, deadline=None)
@given(st.text("# units:mrowscl0123456789.-+e,; \nxyz_nai", max_size=80))
def test_any_text_is_read_or_refused_with_a_message(text):
    with suppress(InputError):
        parse_points(HEAD + text, "p")
