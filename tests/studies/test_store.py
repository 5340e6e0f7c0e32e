import os
import subprocess
import sys
from dataclasses import replace

import pytest
import zarr

from gearsim.errors import InputError
from gearsim.studies.records import Outcome, Parameter
from gearsim.studies.store import Store
from tests.studies.stored import fill, outcome, study, surface_map


def test_a_study_is_read_back_as_it_was(tmp_path):
    made = study(tmp_path)
    store = Store.create(tmp_path / "out", made)
    assert store.done() == set()
    assert repr(Store.open(tmp_path / "out").study.parameters) == repr(made.parameters)
    assert replace(Store.open(tmp_path / "out").study, parameters=()) == replace(made, parameters=())


def test_chunks_are_done_once_they_are_put(tmp_path):
    store = fill(Store.create(tmp_path / "out", study(tmp_path)), (2, 0))
    assert store.done() == {0, 2}
    assert Store.open(tmp_path / "out").done() == {0, 2}
    fill(store, (2,))
    assert store.done() == {0, 2}
    assert len(list((tmp_path / "out/parts").glob("*.parquet"))) == 2


def test_a_part_that_is_torn_or_whose_map_is_missing_is_not_done(tmp_path):
    store = fill(Store.create(tmp_path / "out", study(tmp_path)))
    store.part(1).write_bytes(store.part(1).read_bytes()[:-5])
    store.part(2).write_bytes(b"")
    (tmp_path / "out/maps.zarr/convex_deviation_um/c/3/0/0").unlink()
    assert store.done() == {0}


def test_another_study_is_refused_with_what_differs(tmp_path):
    made = study(tmp_path)
    Store.create(tmp_path / "out", made)
    Store.create(tmp_path / "out", replace(made, summary="in other words", folder=tmp_path / "elsewhere"))
    other = replace(
        made, seed=2, tables={**made.tables, "metrology": {"rows": 5, "columns": 6}},
        parameters=(*made.parameters[:1], Parameter("toolpath.points", (9,) * 20)),
    )  # fmt: skip
    with pytest.raises(InputError) as told:
        Store.create(tmp_path / "out", other)
    message = str(told.value)
    assert "seed (1 there, 2 here)" in message
    assert "metrology.rows (4 there, 5 here)" in message
    assert "the values of toolpath.points" in message
    assert "toolpath.mode is varied in one alone" in message
    assert "taper" not in message


def test_a_changed_file_that_the_scene_names_makes_its_parts_stale(tmp_path):
    (tmp_path / "path.cl").write_text("GOTO/0,0,0")
    made = study(tmp_path, tables={"toolpath": {"file": "path.cl"}, "list": [{"file": "absent.cl"}]})
    store = fill(Store.create(tmp_path / "out", made))
    assert len(store.done()) == 4
    (tmp_path / "path.cl").write_text("GOTO/0,0,1")
    again = Store.create(tmp_path / "out", made)
    assert again.done() == set()
    fill(again, (1,))
    assert again.done() == {1}
    assert len(list((tmp_path / "out/parts").glob("*.parquet"))) == 4


def test_a_file_named_by_a_value_counts_for_its_own_chunk(tmp_path):
    (tmp_path / "b.cl").write_text("b")
    values = ("a.cl",) * 6 + ("b.cl",) * 14
    made = study(tmp_path, parameters=(Parameter("toolpath.file", values),))
    fill(Store.create(tmp_path / "out", made))
    (tmp_path / "b.cl").write_text("c")
    assert Store.create(tmp_path / "out", made).done() == {0}


def test_other_sources_are_refused_to_workers_and_make_parts_stale(tmp_path, monkeypatch):
    made = study(tmp_path)
    fill(Store.create(tmp_path / "out", made))
    monkeypatch.setattr("gearsim.studies.study_file.sources", lambda: "other")
    monkeypatch.setattr("gearsim.studies.store.sources", lambda: "other")
    with pytest.raises(InputError, match="every worker needs the same gearsim"):
        Store.open(tmp_path / "out")
    assert Store.create(tmp_path / "out", made).done() == set()
    assert Store.open(tmp_path / "out").done() == set()


def test_maps_of_another_gearsim_may_have_had_another_shape(tmp_path, monkeypatch):
    made = study(tmp_path)
    fill(Store.create(tmp_path / "out", made))
    monkeypatch.setattr("gearsim.studies.study_file.sources", lambda: "other")
    small = replace(surface_map(0), **{
        k: getattr(surface_map(0), k)[:2] for k in ("deviation_um", "crossing", "u", "point", "normal")
    })  # fmt: skip
    again = Store.create(tmp_path / "out", made)
    for chunk in range(made.chunks):
        again.put(chunk, [Outcome(k, "pass", maps={"convex": small}) for k in made.jobs_of(chunk)], {})
    assert again.finish() == {"pass": 20}
    assert zarr.open_group(tmp_path / "out/maps.zarr", mode="r")["convex_crossing"].shape == (20, 2, 6)
    assert "concave_crossing" not in zarr.open_group(tmp_path / "out/maps.zarr", mode="r")


def test_what_is_no_folder_of_a_study_is_told(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="is a file"):
        Store.create(tmp_path / "file", study(tmp_path))
    with pytest.raises(InputError, match="cannot write into the study's folder"):
        Store.create(tmp_path / "file/below", study(tmp_path))
    with pytest.raises(InputError, match="cannot read study"):
        Store.open(tmp_path)
    (tmp_path / "study.json").write_text("{}")
    with pytest.raises(InputError, match="it is no study"):
        Store.open(tmp_path)


def test_a_study_larger_than_the_disk_is_refused_with_both_numbers(tmp_path, monkeypatch):
    monkeypatch.setattr("gearsim.studies.store.shutil.disk_usage", lambda _: type("Usage", (), {"free": 2_000_000}))
    Store.create(tmp_path / "small", study(tmp_path))
    with pytest.raises(InputError, match=r"20 jobs need about 264 MB .* 2 MB are free"):
        Store.create(tmp_path / "out", study(tmp_path), samples=1_000_000)


def test_maps_of_several_shapes_are_refused(tmp_path):
    made = study(tmp_path)
    rows = replace(made, parameters=(Parameter("metrology.rows", (4,) * 19 + (5,)),))
    with pytest.raises(InputError, match=r"metrology\.rows is varied"):
        Store.create(tmp_path / "out", rows)
    Store.create(tmp_path / "iso", replace(rows, asked=replace(made.asked, measure=("iso",))))
    store = fill(Store.create(tmp_path / "out", made), (0,))
    small = replace(outcome(6).maps["convex"], deviation_um=outcome(6).maps["convex"].deviation_um[:2])
    with pytest.raises(ValueError, match="expected crossing to have shape"):
        store.put(1, [replace(outcome(k), maps={"convex": small}) for k in range(6, 12)], {})


def test_outcomes_of_other_jobs_are_refused(tmp_path):
    store = Store.create(tmp_path / "out", study(tmp_path))
    with pytest.raises(ValueError, match="chunk 0 has jobs"):
        store.put(0, [outcome(k) for k in range(5)], {})
    with pytest.raises(ValueError, match="of a figure and of a parameter"):
        store.put(0, [Outcome(k, "pass", figures={"toolpath.points": 1}) for k in range(6)], {})


def test_a_full_disk_is_told_and_leaves_the_chunk_undone(tmp_path, monkeypatch):
    store = fill(Store.create(tmp_path / "out", study(tmp_path)), (0,))

    replacing = os.replace
    for count in (0, 1, 5, 12):  # 12 files of maps, and the part
        left = iter([None] * count)

        def some(*names, left=left):
            if next(left, "full"):
                raise OSError(28, "No space left on device")
            replacing(*names)

        with monkeypatch.context() as patched:
            patched.setattr(os, "replace", some)
            with pytest.raises(InputError, match="No space left on device; what was kept so far is whole"):
                fill(store, (1,))
        assert store.done() == {0}
    fill(store, (1,))
    assert store.done() == {0, 1}


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_may_not_be_written_is_told(tmp_path):
    (tmp_path / "out").mkdir(mode=0o555)
    with pytest.raises(InputError, match="cannot write into the study's folder"):
        Store.create(tmp_path / "out", study(tmp_path))


def test_a_killed_workers_scratch_is_cleared_and_a_living_ones_is_not(tmp_path):
    store = fill(Store.create(tmp_path / "out", study(tmp_path)), (0,))
    living = set((tmp_path / "out").glob(".unfinished-*"))
    assert len(living) == 1
    script = (
        "import os, sys; from pathlib import Path; from gearsim.studies.store import Store\n"
        "store = Store.open(Path(sys.argv[1]))\n"
        "with store._writer.into(store.folder / 'x') as scratch: os.kill(os.getpid(), 9)"
    )
    killed = subprocess.run([sys.executable, "-c", script, str(tmp_path / "out")], check=False)
    assert killed.returncode == -9
    assert len(set((tmp_path / "out").glob(".unfinished-*")) - living) == 1
    other = fill(Store.open(tmp_path / "out"), (1,))
    assert living < set((tmp_path / "out").glob(".unfinished-*"))
    assert len(list((tmp_path / "out").glob(".unfinished-*"))) == 2
    del other, store
    assert not list((tmp_path / "out").glob(".unfinished-*"))
