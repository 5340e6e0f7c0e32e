"""What other programs read of samples.parquet and deviation.exr: the same numbers, and what they mean."""

import json
from dataclasses import replace

import numpy as np
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pytest

from gearsim.metrology.deviation import Crossing
from gearsim.metrology.grid import DENSE
from gearsim.output.columns import CAUSES, CLASSES, CROSSINGS, DECISIONS, Column, known, segment_key, words
from gearsim.output.grid_columns import sample_columns
from gearsim.output.table import write_columns
from gearsim.surfaces.patch import SIDES

STATISTICS = ("count", "min", "max", "mean")


def by_pyarrow(file, names):
    table = pq.read_table(file)
    return {n: [getattr(pc, s)(table[n]).as_py() for s in STATISTICS] for n in names}


def by_footer(file, names):
    """What the file's own statistics say, the mean left out."""
    found, footer = {}, pq.read_metadata(file)
    assert footer.num_row_groups == 1
    for column in map(footer.row_group(0).column, range(footer.num_columns)):
        if column.path_in_schema in names:
            s = column.statistics
            found[column.path_in_schema] = [s.num_values, *((s.min, s.max) if s.has_min_max else (None, None))]
    return found


def by_pandas(file, names):
    frame = pytest.importorskip("pandas").read_parquet(file)
    return {n: [frame[n].count(), *map(nothing, (frame[n].min(), frame[n].max(), frame[n].mean()))] for n in names}


def by_polars(file, names):
    frame = pytest.importorskip("polars").read_parquet(file)
    return {n: [getattr(frame[n], s)() for s in STATISTICS] for n in names}


def by_duckdb(file, names):
    duckdb = pytest.importorskip("duckdb")
    asked = ", ".join(f'{s}("{n}")' for n in names for s in ("count", "min", "max", "avg"))
    row = duckdb.connect().execute(f"SELECT {asked} FROM '{file}'").fetchone()
    return {n: list(row[4 * i : 4 * i + 4]) for i, n in enumerate(names)}


def nothing(x):
    return None if np.isnan(x) else x  # pandas says nan for the greatest of no numbers


READERS = [by_footer, by_pandas, by_polars, by_duckdb]


def same(seen, expected):
    assert set(seen) == set(expected)
    for name, values in expected.items():
        for mine, right in zip(seen[name], values, strict=False):
            assert mine == (right if right is None else pytest.approx(right, rel=1e-12, abs=1e-15)), name


@pytest.fixture(scope="module")
def holes(result, tmp_path_factory):
    """A table with every kind of hole, and the statistics of what is left."""
    file = tmp_path_factory.mktemp("holes") / "samples.parquet"
    first = {
        "surface": Column(np.array(["a"] * 4), "name of the surface"),
        "nan_um": Column(np.array([1.0, np.nan, 3.0, -1.0]), "one is not a number"),
        "inf_per_mm": Column(np.array([np.inf, 2.0, -np.inf, 5.0]), "infinite curvature"),
        "none_um": Column(np.full(4, np.nan), "none at all"),
        "first_segment": Column(known([-1, 3, 0, -1]), "a row of the motion"),
        "first_crossing": Column(words(CROSSINGS, np.array([0, 1, 2, 3])), "a code"),
    }
    second = {"surface": Column(np.array(["b"]), "name of the surface"), "second_mm": Column(np.array([7.0]), "alone")}
    write_columns([first, second], result, file)
    return file, {
        "nan_um": [3, -1.0, 3.0, 1.0], "inf_per_mm": [2, 2.0, 5.0, 3.5], "none_um": [0, None, None, None],
        "first_segment": [2, 0, 3, 1.5], "second_mm": [1, 7.0, 7.0, 7.0],
    }  # fmt: skip


@pytest.mark.parametrize("read", [by_pyarrow, *READERS])
def test_holes_count_in_no_statistic(holes, read):
    file, expected = holes
    same(read(file, list(expected)), expected)


@pytest.mark.parametrize("read", READERS)
def test_readers_agree_on_the_statistics_of_a_run(folder, read):
    file = folder / "samples.parquet"
    names = [f.name for f in pq.read_schema(file) if str(f.type) in ("double", "int64")]
    assert len(names) > 20
    same(read(file, names), by_pyarrow(file, names))


def test_every_column_says_what_it_means(folder, result):
    schema = pq.read_schema(folder / "samples.parquet")
    told = {f.name: {k.decode(): v.decode() for k, v in f.metadata.items()} for f in schema}
    assert all(told[name]["meaning"] for name in schema.names)
    units = {"program_um": "um", "x_mm": "mm", "intended_k1_per_mm": "1/mm"}
    assert {name: told[name]["unit"] for name in units} == units
    assert not any("unit" in told[name] for name in ("row", "nx", "program_crossing"))
    together = json.loads(schema.metadata[b"gearsim.columns"])
    assert {n: json.loads(t["key"]) for n, t in told.items() if "key" in t} == {
        n: t["key"] for n, t in together.items() if "key" in t
    }
    assert {n: t["meaning"] for n, t in together.items()} == {n: t["meaning"] for n, t in told.items()}
    whole = result.job.variant("program")
    assert json.loads(told["program_segment"]["key"]) == segment_key(whole)
    assert list(json.loads(told["theory_segment"]["key"])) == list(SIDES)  # each flank has a motion of its own


def test_every_sample_knows_the_line_that_made_it(folder, result):
    """A record of toolpath.cl that states a point; null where nothing was measured; none of a planner's own motion."""
    table, text = pq.read_table(folder / "samples.parquet"), (folder / "toolpath.cl").read_text().splitlines()
    assert not {"theory_line", "theory_operation"} & set(table.column_names)
    columns = ("program_line", "program_operation", "program_segment", "program_um", "own_pass_line")
    lines, made, rows, um, own = (table[name].to_pylist() for name in columns)
    assert [line is None for line in lines] == [value is None for value in um] == [name is None for name in made]
    whole, checked = result.job.variant("program"), 0
    (operation,) = whole.operations
    for line, name, row in zip(lines, made, rows, strict=True):
        if line is not None:
            x, y, z = (float(word) for word in text[line - 1].removeprefix("GOTO/").split(",")[:3])
            end = operation.sources[operation.table.path[row]].tips[operation.table.piece[row] + 1]
            assert [x, y, z] == pytest.approx(end.tolist(), abs=1e-12)
            assert name == f"CL data, {operation.headings[operation.section[row]]}"
            checked += 1
    assert checked > 100
    assert any(a is not None and a == b for a, b in zip(own, lines, strict=True))
    told = table.schema.field("program_line").metadata
    assert told[b"meaning"].startswith(b"line, from 1, of the program")
    assert b"unit" not in told
    m = result.measurements["convex", "program", DENSE]
    unknown = m.deviation.segment.copy()
    unknown[0, :2] = -1
    columns = sample_columns([replace(m, deviation=replace(m.deviation, segment=unknown))])
    for name in ("program_line", "program_operation"):
        none = np.ma.getmaskarray(columns[name].values)
        assert none.sum() == 2
        assert none[0, :2].all()


def test_every_word_of_a_run_stands_in_its_key(folder):
    table = pq.read_table(folder / "samples.parquet")
    coded = [n for n in table.column_names if n.endswith(("_crossing", "_class"))]
    assert coded
    for name in coded:
        key = json.loads(table.schema.field(name).metadata[b"key"])
        assert set(table[name].drop_null().unique().to_pylist()) <= set(key)


@pytest.mark.parametrize("key", [CROSSINGS, CLASSES, CAUSES, DECISIONS])
def test_every_code_has_its_meaning(key):
    assert set(key) == set(type(next(iter(key))))


def test_words_are_missing_where_there_is_no_code():
    seen = words(CLASSES, np.array([0, 1, 4, -1, 9]))
    assert seen.tolist() == [None, "envelope", "edge", None, None]


def test_segments_have_an_owner_each(result):
    whole = result.job.variant("program")
    runs = [tuple(map(int, run.split("-"))) for run in segment_key(whole)]
    assert [row for first, last in runs for row in range(first, last + 1)] == list(range(len(whole)))


def test_a_viewer_opens_the_preview_first_and_finds_the_data_where_it_shows_them(folder, result):
    import OpenEXR

    with OpenEXR.File(str(folder / "deviation.exr"), separate_channels=True) as file:
        preview, *parts = file.parts
        colours = np.stack([preview.channels[c].pixels for c in "RGB"], axis=-1)
        windows = {p.name(): p.header["dataWindow"] for p in parts}
        assert (preview.name(), colours.dtype) == ("preview", np.float16)
        assert "red +5 um" in preview.header["gearsim.preview"]
    for surface, ((left, top), (right, bottom)) in windows.items():
        m = result.measurements[surface, "program", DENSE]
        shown = colours[top : bottom + 1, left : right + 1].astype(float)
        assert shown.shape[:2] == m.grid.shape
        um, measured = 1e3 * m.deviation.value, m.deviation.crossing == Crossing.MEASURED
        redder = shown[..., 0] - shown[..., 2]
        assert (np.sign(redder[measured & (np.abs(um) > 0.5)]) == np.sign(um[measured & (np.abs(um) > 0.5)])).all()
        assert np.ptp(shown[~measured], axis=-1).max(initial=0.0) == 0.0  # grey


def test_another_reader_sees_the_same_picture_and_the_same_numbers(folder):
    oiio = pytest.importorskip("OpenImageIO")
    import OpenEXR

    with OpenEXR.File(str(folder / "deviation.exr"), separate_channels=True) as file:
        for number, part in enumerate(file.parts):
            seen = oiio.ImageBuf(str(folder / "deviation.exr"), number, 0)
            pixels = seen.get_pixels(oiio.FLOAT)
            for k, name in enumerate(seen.spec().channelnames):
                np.testing.assert_array_equal(pixels[..., k], part.channels[name].pixels.astype(np.float32))
            assert (seen.spec().x, seen.spec().y) == tuple(part.header["dataWindow"][0])
            if number == 0:
                assert seen.spec().channelnames == ("R", "G", "B")
