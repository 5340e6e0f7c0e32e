import re
from contextlib import suppress

import numpy as np
import pyarrow as pa
import pyarrow.csv
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


def by_pyarrow(file):
    return pyarrow.csv.read_csv(file).to_pydict()


def by_pandas(file):
    return pytest.importorskip("pandas").read_csv(file).to_dict("list")


@pytest.mark.parametrize("read", [by_pyarrow, by_pandas])
def test_a_list_is_a_plain_table_that_says_what_its_numbers_mean(rng, tmp_path, read):
    points = random_list(rng, shape=(3, 4), axis="z along the gear axis, origin at the apex")
    write_points(points, tmp_path / "p.csv")
    table = read(tmp_path / "p.csv")
    assert list(table) == [*COLUMNS, "sign", "axis", "flank", "row", "column"]
    numbers = np.array([table[name] for name in COLUMNS]).T
    assert np.allclose(numbers, np.hstack([points.point, points.normal]), rtol=3e-16, atol=0.0)
    told = {name: set(table[name]) for name in ("sign", "axis", "flank")}
    assert told == {"sign": {"out of the material"}, "axis": {points.axis}, "flank": {"convex"}}
    assert table["row"] == np.repeat(range(3), 4).tolist()
    assert table["column"] == np.tile(range(4), 3).tolist()


def test_scattered_points_of_no_flank_have_no_columns_for_it(rng):
    assert format_points(random_list(rng, flank="")).splitlines()[0] == ",".join([*COLUMNS, "sign", "axis"])


def test_older_lists_with_their_keys_above_are_read():
    head = "# units: mm\n# axis: z up\n# flank: convex\n# sign: into the material\n# rows: 1\n# columns: 2\n"
    points = parse_points(head + "x_mm,y_mm,z_mm,nx,ny,nz\n1,2,3,0,0,1\n4,5,6,0,0.6,0.8\n", "p")
    assert (points.axis, points.flank, points.shape) == ("z up", "convex", (1, 2))
    assert np.array_equal(points.normal[0], [0, 0, -1])


TABLE = "x_mm,y_mm,z_mm,nx,ny,nz,sign,row,column\n1,2,3,0,0,1,out of the material,0,0\n4,5,6,0,0.6,0.8,{},{},{}\n"


@pytest.mark.parametrize(
    ("last", "message"),
    [
        (("into the material", 0, 1), "p, line 3, sign 'into the material' contradicts 'out of the material' above"),
        (("out of the material", 1, 1), "p, line 3: row '1', column '1'; expected 0, 1: row by row, from 0"),
        (("out of the material", 0, 0), "p, line 3: row '0', column '0'; expected 1, 0: row by row, from 0"),
        (("out of the material", "x", 1), "p, line 3: row 'x', column '1'; expected 0, 1"),
    ],
)
def test_columns_that_contradict_are_refused(last, message):
    assert parse_points(TABLE.format("out of the material", 0, 1), "p").shape == (1, 2)
    assert parse_points(TABLE.format("out of the material", 1, 0), "p").shape == (2, 1)
    with pytest.raises(InputError, match=re.escape(message)):
        parse_points(TABLE.format(*last), "p")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (TABLE.replace(",row,", ",colour,"), "p, line 1: columns x_mm, y_mm, z_mm, nx, ny, nz, sign, colour, column"),
        (TABLE.replace(",row,", ",sign,"), "and behind them any of sign, axis, flank, row, column"),
        (TABLE.replace(",row,", ",flank,"), "p: a grid needs both columns, row and column"),
        ("# rows: 2\n" + TABLE, "p: 1 rows by the columns, 2 by its header"),
        (
            "# sign: into the material\n" + TABLE,
            "p, line 3, sign 'out of the material' contradicts 'into the material'",
        ),
        (TABLE.replace(",0,0\n4", ",0\n4"), "p, line 2: 8 columns; expected 9: x_mm"),
    ],
)
def test_unknown_and_half_columns_are_refused(text, message):
    with pytest.raises(InputError, match=re.escape(message)):
        parse_points(text.format("out of the material", 0, 1), "p")


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
        (GOOD.replace("# units: mm\n", "").replace("_mm", ""), "no '# units: mm' in its header, no x_mm"),
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
