import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from gearsim.cli import main
from gearsim.errors import InputError
from gearsim.studies.compare import Noise, change_of, compare
from gearsim.studies.records import Outcome, Parameter
from gearsim.studies.store import Store
from tests.studies.stored import fill, outcome, study

ORDER = [k for k in range(19, -1, -1) if k != 5]


def run(folder, moved_um=0.0, **changed):
    """A run's folder of the files that are compared, some of its numbers moved."""
    folder.mkdir(parents=True)
    report = {
        "scene": {"scene": {"name": "a"}, "toolpath": {"points": 9}}, "program": "program", "verdict": "pass",
        "timings_s": {"total": float(np.random.default_rng().random())},
        "findings": [{"kind": "root_cut"}],
        "measurements": {"convex": {
            "deviation_um": {"min": -1.0 + moved_um, "samples": 6, "max": None},
            "worst_at": {"deviation_um": -1.0, "row": 0},
            "place_mm": [1.0, 2.0 + 1e-3 * moved_um],
        }},
    }  # fmt: skip
    (folder / "report.json").write_text(json.dumps(report | changed))
    columns = {
        "surface": ["convex"] * 6, "row": [0, 0, 0, 1, 1, 1], "column": [0, 1, 2] * 2,
        "program_um": [0.0, 1.0, None, 3.0, 4.0, 5.0 + moved_um], "program_crossing": ["measured"] * 6,
    }  # fmt: skip
    pq.write_table(pa.table(columns), folder / "samples.parquet")
    (folder / "toolpath.cl").write_text("PARTNO a\nGOTO/0,0,0\n")
    return folder


def names(found):
    return {c.name: c for c in found.changes}


def test_noise_is_at_most_so_much_or_that_share():
    a = np.array([0.0, 100.0, 1e6, np.nan, 0.0, np.inf])
    b = np.array([1e-6, 100.0 + 1e-6 - 1e-10, 1e6 + 5e-4, np.nan, 0.0, np.inf])
    assert not Noise().exceeded(a, b, "um").any()
    a = np.array([0.0, 100.0, 1e6, np.nan, np.inf, np.inf, np.nan])
    b = np.array([1.1e-6, 100.0 + 1.1e-6, 1e6 + 2e-3, 0.0, 1.0, -np.inf, np.inf])
    assert Noise().exceeded(a, b, "um").all()
    assert Noise().exceeded(b, a, "um").all()
    assert Noise(1.0).exceeded(np.array([0.0, 0.0]), np.array([1e-3, 1.1e-3]), "mm").tolist() == [False, True]
    assert Noise(0.0, 0.0).exceeded(np.array([1.0]), np.array([np.nextafter(1.0, 2.0)]), "um").all()


def test_the_largest_change_is_among_those_of_two_numbers():
    a, b = np.array([np.inf, np.nan, 1.0, 2.0, np.inf]), np.array([1.0, 2.0, 1.5, 5.0, np.inf])
    found = change_of("x_um", a, b, str, Noise())
    assert (found.changed, found.largest, found.where, found.a, found.b) == (4, 3.0, "3", 2.0, 5.0)
    found = change_of("x_um", a[:2], b[:2], str, Noise())
    assert (found.changed, found.largest, found.where, found.a, found.b) == (2, None, "0", None, 1.0)
    assert change_of("x_um", a[:0], b[:0], str, Noise()) is None
    assert change_of("x", np.array(["a", None], dtype=object), np.array([np.nan, np.nan]), str, Noise()).changed == 1


def test_runs_that_differ_by_noise_are_the_same(tmp_path):
    found = compare(run(tmp_path / "a"), run(tmp_path / "b", moved_um=9e-7))
    assert found.same
    assert found.compared == 9 + 12  # of report.json: all but times, scene and where the worst lies


def test_runs_that_differ_say_what_and_where(tmp_path):
    a = run(tmp_path / "a")
    b = run(tmp_path / "b", moved_um=0.5, verdict="fail", findings=[], scene={"scene": {"name": "a"}, "toolpath": 3})
    (b / "toolpath.cl").write_text("PARTNO a\nGOTO/0,0,1\n")
    found = compare(a, b)
    changes = names(found)
    assert changes["verdict"].a == "pass"
    assert changes["verdict"].largest is None
    assert changes["samples: program_um"].largest == 0.5
    assert (changes["samples: program_um"].changed, changes["samples: program_um"].compared) == (1, 6)
    assert changes["samples: program_um"].where == "convex, row 1, column 2"
    assert changes["measurements.convex.deviation_um.min"].unit == "um"
    assert changes["measurements.convex.place_mm.1"].unit == "mm"
    assert changes["toolpath.cl"].where == "from line 2"
    assert found.alone == ("report.json: findings only in A",)
    assert "scene.toolpath" in found.notes[0]
    assert len(changes) == 5
    assert {c.name for c in compare(a, b, Noise(0.6)).changes} == {"verdict", "toolpath.cl"}


def test_samples_are_matched_by_their_places(tmp_path):
    a, b = run(tmp_path / "a"), run(tmp_path / "b")
    table = pq.read_table(b / "samples.parquet")
    pq.write_table(table.take([4, 3, 2, 1, 0]).append_column("other", pa.array(range(5))), b / "samples.parquet")
    assert compare(a, b).alone == (
        "samples.parquet: 1 samples only in A", "samples.parquet: column other only in B",
    )  # fmt: skip
    assert compare(a, b).changes == ()


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("finished")
    store = fill(Store.create(folder / "a", study(folder)))
    store.finish()
    return store.folder


def otherwise(folder, changed, order=ORDER):
    """The same study with its jobs in another order, some of whose outcomes changed."""
    made = study(folder)
    taken = tuple(replace(p, values=tuple(p.values[k] for k in order)) for p in made.parameters)
    store = Store.create(folder / "b", replace(made, parameters=taken, chunk=7))
    for chunk in range(store.study.chunks):
        jobs = store.study.jobs_of(chunk)
        store.put(chunk, [replace(changed(outcome(order[j])), job=j) for j in jobs], {})
    store.finish()
    return store.folder


def test_jobs_are_matched_by_their_values(finished, tmp_path):
    found = compare(finished, otherwise(tmp_path, lambda o: o))
    assert found.changes == ()
    assert found.alone == ("1 jobs only in A: 5",)


def test_what_changed_in_a_study_is_told_with_its_job(finished, tmp_path):
    def changed(o):
        if o.job == 7:
            return Outcome(7, "error", error="no longer")
        if o.job != 6:
            return o
        deviation = o.maps["convex"].deviation_um.copy()
        deviation[2, 3] += 0.5
        deviation[1, 1] += 1e-7
        maps = {**o.maps, "convex": replace(o.maps["convex"], deviation_um=deviation)}
        figures = {**o.figures, "convex.min_um": o.figures["convex.min_um"] - 0.25}
        return replace(o, verdict="fail", maps=maps, figures=figures)

    found = compare(finished, otherwise(tmp_path, changed))
    assert [(c.a, c.b, c.changed) for c in found.changes if c.name == "verdict"] == [
        ("unchecked", "error", 1), ("unchecked", "fail", 1),
    ]  # fmt: skip
    changes = names(found)
    assert changes["convex.min_um"].largest == pytest.approx(-0.25)
    assert changes["convex.min_um"].changed == 2
    assert changes["convex.min_um"].where.startswith("job 6 (13 in B): cutter.taper_deg = 14.96")
    assert changes["map of convex"].largest == pytest.approx(0.5)
    assert changes["map of convex"].changed == 1 + 23  # and all that were measured in job 7
    assert changes["map of convex"].where.startswith("row 2, column 3, job 6 ")
    assert changes["map of concave"].largest is None
    assert changes["crossing of concave"].changed == 24
    assert changes["error"].b == "no longer"


def test_a_key_that_is_fixed_in_one_study_is_matched_all_the_same(finished, tmp_path):
    made = study(tmp_path, tables={**study(tmp_path).tables, "cutter": {"taper_deg": 14.9}})
    store = Store.create(tmp_path / "b", replace(made, parameters=tuple(
        Parameter(p.key, p.values[:1]) for p in made.parameters[1:]
    )))  # fmt: skip
    store.put(0, [outcome(0)], {})
    store.finish()
    found = compare(finished, store.folder)
    assert found.changes == ()
    assert found.alone[0].startswith("19 jobs only in A: 1, 2, 3")
    other = Store.create(tmp_path / "c", study(tmp_path, parameters=(Parameter("blank.bore_mm", (1.0,)),)))
    other.put(0, [outcome(0)], {})
    other.finish()
    with pytest.raises(InputError, match=r"blank.bore_mm is varied in one study, but .* does not state it"):
        compare(finished, other.folder)


def test_maps_of_other_shapes_or_in_one_alone_are_named(finished, tmp_path):
    found = compare(finished, otherwise(tmp_path, lambda o: replace(
        o, maps={s: m for s, m in o.maps.items() if s == "convex"}
    ), range(20)))  # fmt: skip
    assert found.alone == ("maps of concave only in A",)


def test_the_command_tells_and_returns_whether_they_are_the_same(finished, tmp_path, capsys):
    a, b = run(tmp_path / "a"), run(tmp_path / "b", moved_um=0.5)
    assert main(["compare", str(a), str(a)]) == 0
    assert "the same: 21 values" in capsys.readouterr().out
    assert main(["compare", str(a), str(b), "--out", str(tmp_path / "changes.json")]) == 1
    shown = capsys.readouterr().out
    assert "samples: program_um" in shown
    assert "convex, row 1, column 2" in shown
    told = json.loads((tmp_path / "changes.json").read_text())
    assert told["same"] is False
    assert max(c["largest"] for c in told["changes"]) == 0.5
    assert main(["compare", str(a), str(b), "--beyond", "0.6"]) == 0
    assert main(["compare", str(finished), str(finished)]) == 0


def test_bad_input_is_told(finished, tmp_path, capsys):
    a = run(tmp_path / "a")
    (tmp_path / "going").mkdir()
    (tmp_path / "going/study.json").write_text("{}")
    for other, message in (
        (finished, "two runs or two studies can be compared"),
        (Path("nowhere"), "is no folder; expected a run's, with report.json, or a study's, with study.json"),
        (tmp_path, "holds neither report.json of a run nor study.json of a study"),
        (tmp_path / "going", "the study is not finished (no manifest.json); run it again to go on"),
    ):
        assert main(["compare", str(a), str(other)]) == 2
        assert message in capsys.readouterr().err
    (a / "samples.parquet").write_bytes(b"torn")
    assert main(["compare", str(a), str(a)]) == 2
    assert "cannot read" in capsys.readouterr().err
    (a / "report.json").write_text("[1]")
    assert main(["compare", str(a), str(a)]) == 2
    assert "it is no report of a run" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main(["compare", str(a), str(a), "--beyond", "-1"])
