import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
import zarr

from gearsim.errors import InputError
from gearsim.metrology.deviation import Crossing
from gearsim.studies.opened import DataSet
from gearsim.studies.records import Asked, Outcome, Parameter
from gearsim.studies.store import Store
from tests.studies.stored import BAD, fill, outcome, study, surface_map


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A data set of 20 jobs and its folder's study."""
    folder = tmp_path_factory.mktemp("studies")
    store = fill(Store.create(folder / "out", study(folder)))
    assert store.finish(exr=True) == {"unchecked": 9, "error": 3, "fail": 8}
    return store


def test_rerun_resumed_and_in_any_order_it_is_the_same_bit_by_bit(made, tmp_path):
    out = tmp_path / "out"
    Store.create(out, made.study)
    for chunk in (3, 1, 0):
        fill(Store.open(out), (chunk,))
    torn = Store.open(out).part(1)
    torn.write_bytes(torn.read_bytes()[:100])
    again = Store.create(out, made.study)
    fill(again, set(range(4)) - again.done())
    again.finish(exr=True)
    first, second = ((folder / "manifest.json").read_bytes() for folder in (made.folder, out))
    assert first == second
    DataSet(out).verify()
    again.finish()
    assert (out / "manifest.json").read_bytes() == second


def test_the_rows_do_not_depend_on_how_many_jobs_a_chunk_has(made, tmp_path):
    other = fill(Store.create(tmp_path / "out", replace(made.study, chunk=7)))
    other.finish()
    assert (other.folder / "jobs.parquet").read_bytes() == (made.folder / "jobs.parquet").read_bytes()


def test_failures_are_rows(made):
    rows = pq.read_table(made.folder / "jobs.parquet").to_pylist()
    assert [r["job"] for r in rows] == list(range(20))
    assert {r["job"]: r["error"] for r in rows if r["verdict"] == "error"} == BAD
    assert rows[3] == {
        "job": 3, "cutter.taper_deg": 14.9 + 0.03, "toolpath.points": 9, "toolpath.mode": "free-form",
        "verdict": "error", "status": None, "error": BAD[3], "cross_checked": False, "convex.min_um": None,
        "convex.samples": None, "iso.F_alpha.right_um": None, "iso.class": None,
    }  # fmt: skip
    maps = zarr.open_group(made.folder / "maps.zarr", mode="r")
    for job in range(20):
        crossing, deviation = (maps[f"concave_{k}"][job] for k in ("crossing", "deviation_um"))
        if job in BAD:
            assert (crossing == Crossing.ABSENT).all()
            assert np.isnan(deviation).all()
        else:
            np.testing.assert_array_equal(crossing, outcome(job).maps["concave"].crossing)
            np.testing.assert_array_equal(deviation, outcome(job).maps["concave"].deviation_um)


def test_columns_say_their_units_and_the_file_its_conventions(made):
    schema = pq.read_schema(made.folder / "jobs.parquet")
    assert schema.field("cutter.taper_deg").metadata[b"unit"] == b"deg"
    assert schema.field("iso.F_alpha.right_um").metadata[b"unit"] == b"um"
    assert b"positive = material left" in schema.metadata[b"gearsim.sign"]
    assert json.loads(schema.metadata[b"gearsim.columns"])["verdict"]["meaning"].startswith("pass, fail")
    assert [str(schema.field(k).type) for k in ("toolpath.points", "toolpath.mode", "convex.samples", "iso.class")] == [
        "int64", "string", "int64", "string",
    ]  # fmt: skip


@pytest.mark.parametrize("chunk", [1, 3, 6])
@pytest.mark.parametrize(
    ("values", "kind", "kept"),
    [
        ((None, 1, 2.5, np.float32(0.5), float("inf"), -0.0), "double", [None, 1.0, 2.5, 0.5, None, -0.0]),
        ((True, False, None, True, np.True_, False), "bool", [True, False, None, True, True, False]),
        ((True, 3, None, np.int32(2), 0, False), "string", ["true", "3", None, "2", "0", "false"]),
        ((1.0, True, 2, None, "A5", 0.1), "string", ["1", "true", "2", None, "A5", "0.1"]),
        ((None,) * 6, "double", [None] * 6),
    ],
)
def test_a_figure_has_one_type_over_all_chunks(tmp_path, chunk, values, kind, kept):
    store = Store.create(tmp_path / "out", study(tmp_path, jobs=6, chunk=chunk))
    for k in range(store.study.chunks):
        store.put(k, [Outcome(job, "pass", figures={"x": values[job]}) for job in store.study.jobs_of(k)], {})
    store.finish()
    column = pq.read_table(tmp_path / "out/jobs.parquet").column("x")
    assert (str(column.type), column.to_pylist()) == (kind, kept)
    assert not (tmp_path / "out/maps.zarr").exists()


@pytest.mark.parametrize(
    ("values", "kind", "kept"),
    [
        ((1, 2.5), "double", [1.0, 2.5]),
        ((True, False), "bool", [True, False]),
        ((True, 1), "string", ["true", "1"]),
        ((1, "a"), "string", ["1", "a"]),
        ((2**70, 1), "string", [str(2**70), "1"]),
    ],
)
def test_values_of_any_kind_are_kept(tmp_path, values, kind, kept):
    store = Store.create(tmp_path / "out", study(tmp_path, parameters=(Parameter("a.b", values),)))
    store.put(0, [Outcome(k, "pass", maps={"convex": surface_map(k)}) for k in range(2)], {})
    store.finish()
    column = pq.read_table(tmp_path / "out/jobs.parquet").column("a.b")
    assert (str(column.type), column.to_pylist()) == (kind, kept)
    assert zarr.open_array(tmp_path / "out/maps.zarr/a.b", mode="r")[...].tolist() == kept


def test_pandas_polars_and_duckdb_see_the_same(made):
    pandas, polars, duckdb = (pytest.importorskip(name) for name in ("pandas", "polars", "duckdb"))
    file = str(made.folder / "jobs.parquet")
    by_pandas, by_polars = pandas.read_parquet(file), polars.read_parquet(file)
    by_duckdb = duckdb.sql(
        f"""SELECT count("convex.min_um"), max("iso.F_alpha.right_um"), count(error) FROM '{file}'
        WHERE "toolpath.mode" = 'ruled'"""
    ).fetchall()[0]
    ruled = by_pandas[by_pandas["toolpath.mode"] == "ruled"]
    chosen = by_polars.filter(polars.col("toolpath.mode") == "ruled")
    names = ("convex.min_um", "iso.F_alpha.right_um", "error")
    assert (ruled[names[0]].count(), ruled[names[1]].max(), ruled[names[2]].count()) == by_duckdb == (10, 27.0, 0)
    assert (chosen[names[0]].count(), chosen[names[1]].max(), chosen[names[2]].count()) == by_duckdb
    assert by_pandas["job"].dtype == "int64"
    assert by_polars["cross_checked"].dtype == polars.Boolean


def test_xarray_reads_the_maps_with_their_coordinates(made):
    xarray = pytest.importorskip("xarray")
    with xarray.open_zarr(made.folder / "maps.zarr", chunks=None) as maps:
        deviation = maps["convex_deviation_um"]
        assert deviation.dims == ("job", "row", "column")
        assert deviation.attrs["units"] == "um"
        assert "positive = material left" in deviation.attrs["convention"]
        assert {"job", "convex_u", "convex_v"} <= set(deviation.coords)
        assert maps["convex_point_mm"].dims == ("row", "column", "xyz")
        assert maps["convex_crossing"].dtype == np.uint8
        assert maps["convex_crossing"].attrs["flag_meanings"] == "measured uncut through absent"
        sharp = deviation.where(maps["cutter.taper_deg"] > 15.0, drop=True)
        assert sharp.sizes["job"] == 9
        assert float(deviation.sel(job=19).max()) == np.nanmax(outcome(19).maps["convex"].deviation_um)
        assert maps["toolpath.mode"].values.tolist() == list(made.study.parameters[2].values)


def test_samples_that_lie_elsewhere_in_each_job_stand_once_a_job(tmp_path):
    store = fill(Store.create(tmp_path / "out", study(tmp_path)), moved=True)
    store.finish()
    store.forget(2)
    fill(store, (2,), moved=True)
    store.finish()
    maps = zarr.open_group(tmp_path / "out/maps.zarr", mode="r")
    points = maps["convex_point_mm"]
    assert points.metadata.dimension_names == ("job", "row", "column", "xyz")
    for job in range(20):
        expected = np.nan if job in BAD else outcome(job, moved=True).maps["convex"].point
        np.testing.assert_array_equal(points[job], np.broadcast_to(expected, (4, 6, 3)))
    DataSet(tmp_path / "out").verify()


def test_surfaces_of_two_sizes_have_dimensions_of_their_own(tmp_path):
    store = Store.create(tmp_path / "out", study(tmp_path, jobs=2))
    small = surface_map(0)
    small = replace(small, **{
        k: getattr(small, k)[:2] for k in ("deviation_um", "crossing", "u", "point", "normal")
    })  # fmt: skip
    store.put(0, [Outcome(k, "pass", maps={"the root": small, "convex": surface_map(k)}) for k in range(2)], {})
    store.finish()
    maps = zarr.open_group(tmp_path / "out/maps.zarr", mode="r")
    assert maps["the_root_deviation_um"].metadata.dimension_names == ("job", "the_root_row", "the_root_column")
    assert maps["the_root_deviation_um"].shape == (2, 2, 6)


def test_a_job_of_another_shape_is_refused_and_says_which(tmp_path):
    store = fill(Store.create(tmp_path / "out", study(tmp_path)), (0,))
    small = surface_map(6)
    small = replace(small, **{
        k: getattr(small, k)[:2] for k in ("deviation_um", "crossing", "u", "point", "normal")
    })  # fmt: skip
    with pytest.raises(InputError, match=r"convex: expected maps of shape \[4, 6\] as in the other jobs, got \[2, 6\]"):
        store.put(1, [Outcome(k, "pass", maps={"convex": small}) for k in range(6, 12)], {})
    with pytest.raises(InputError, match=r"convex has maps of \(2, 6\) and of \(4, 6\)"):
        store.put(
            1, [Outcome(k, "pass", maps={"convex": small if k < 9 else surface_map(k)}) for k in range(6, 12)], {}
        )
    assert store.done() == {0}


def test_places_that_chunks_share_stand_on_the_disk_once(tmp_path):
    store = Store.create(tmp_path / "out", study(tmp_path, jobs=12))

    def put(one, chunk):
        one.put(chunk, [Outcome(k, "pass", maps={"convex": surface_map(k)}) for k in one.study.jobs_of(chunk)], {})
        return [(tmp_path / f"out/parts/grids/convex_point_mm/c/{k}/0/0/0").stat().st_ino for k in range(chunk + 1)]

    put(store, 0)
    shared = put(store, 1)
    assert shared[0] == shared[1]
    store.forget(1)
    apart = put(Store.open(tmp_path / "out"), 1)  # by another worker, who has written none before
    assert apart[0] != apart[1]
    store.finish()
    DataSet(tmp_path / "out").verify()


def test_every_job_that_has_maps_has_an_exr_file(made):
    exr = pytest.importorskip("OpenEXR")
    files = sorted(f.name for f in (made.folder / "exr").iterdir())
    assert files == [f"{job:06d}.exr" for job in range(20) if job not in BAD]
    with exr.File(str(made.folder / "exr/000004.exr")) as read:
        assert [p.name() for p in read.parts] == ["preview", "concave", "convex"]
        assert read.parts[2].header["gearsim.cutter.taper_deg"] == str(made.study.parameters[0].values[4])
        one = outcome(4).maps["convex"]
        for channel, values in (
            ("deviation.um", one.deviation_um), ("P.Y", one.point[..., 1]), ("crossing.id", one.crossing),
        ):  # fmt: skip
            np.testing.assert_array_equal(read.parts[2].channels[channel].pixels, values.astype(np.float32))


def test_a_chunk_that_was_changed_is_forgotten_and_computed_again(tmp_path):
    store = fill(Store.create(tmp_path / "out", study(tmp_path)))
    file = tmp_path / "out/maps.zarr/convex_deviation_um/c/2/0/0"
    good = file.read_bytes()
    file.write_bytes(good[:-1] + bytes([good[-1] ^ 1]))
    assert store.done() == {0, 1, 2, 3}
    with pytest.raises(InputError, match=r"1 chunks .* are not as they were written \(the first: 2\)"):
        store.finish()
    assert store.done() == {0, 1, 3}
    with pytest.raises(InputError, match=r"1 of the study's 4 chunks are not done \(the first: 2\)"):
        store.finish()
    fill(store, (2,))
    store.finish()
    assert file.read_bytes() == good
    DataSet(tmp_path / "out").verify()
    (tmp_path / "out/jobs.parquet").write_bytes(b"")
    with pytest.raises(InputError, match=r"not as its manifest.json says: jobs.parquet was changed \(1 of \d+ files\)"):
        DataSet(tmp_path / "out").verify()
    file.unlink()
    with pytest.raises(InputError, match=r"c/2/0/0 is gone \(2 of"):
        DataSet(tmp_path / "out").verify()


def test_a_study_all_of_whose_jobs_fail_is_a_table_of_errors(tmp_path):
    store = Store.create(tmp_path / "out", study(tmp_path, jobs=3, asked=Asked(("iso",))))
    store.put(0, [Outcome(k, "error", error="no tool") for k in range(3)], {})
    assert store.finish(exr=True) == {"error": 3}
    assert pq.read_table(tmp_path / "out/jobs.parquet").column("error").to_pylist() == ["no tool"] * 3


def test_timings_stand_apart(made):
    rows = pq.read_table(made.folder / "timings.parquet").to_pylist()
    assert rows[3] == {"chunk": 3, "first_job": 18, "jobs": 2, "device": "cpu", "kernel_s": 1.0, "planning_s": 0.5}
    assert "timings.parquet" not in json.loads((made.folder / "manifest.json").read_bytes())["files"]


def test_the_documented_ways_to_read_it_work(tmp_path, monkeypatch, capsys):
    for name in ("pandas", "polars", "duckdb", "xarray"):
        pytest.importorskip(name)
    parameters = tuple(Parameter(f"toolpath.{k}", tuple(range(9, 17))) for k in ("points", "decimals"))
    store = Store.create(tmp_path / "runs/cl-density", study(tmp_path, parameters=parameters))
    outcomes = [
        replace(o, figures={"convex.rms_um": o.job, "convex.max_um": float(o.job)}) for o in map(outcome, range(8))
    ]
    for chunk in range(2):
        store.put(chunk, [outcomes[job] for job in store.study.jobs_of(chunk)], {})
    store.finish()
    monkeypatch.chdir(tmp_path)
    text = (Path(__file__).parents[2] / "docs/data-set.md").read_text(encoding="utf-8")
    snippets = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    for snippet in snippets:
        exec(snippet, {})
    assert len(snippets) == 4
    shown = capsys.readouterr().out
    assert BAD[3] in shown
    assert f"{np.nanmax(outcome(7).maps['convex'].deviation_um)} um" in shown
    assert "(8, 4, 6) measured uncut through absent" in shown
