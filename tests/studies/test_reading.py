import copy
import re
import tomllib
from pathlib import Path

import pytest

from gearsim.errors import InputError
from gearsim.scene import check_scene, load_scene, scene_text
from gearsim.scene.study_files import study_names
from gearsim.studies.chunk import tables_of
from gearsim.studies.reading import read_study
from tests.sweep.scenes import to_toml

TEXT = """
[study]
name = "wear"
scene = "helical-external"
method = "monte-carlo"
samples = 20
measure = ["maps", "iso"]
set = { metrology.rows = 5, "metrology.columns" = 7 }

[[vary]]
key = "errors.pivot_um.2"
distribution = "normal"
mean = 0.0
deviation = 3.0
"""


@pytest.fixture
def tables():
    return tomllib.loads(TEXT)


def refused(tables, *overrides):
    with pytest.raises(InputError) as caught:
        read_study(tables, overrides=overrides)
    return str(caught.value)


@pytest.mark.parametrize("name", study_names())
def test_built_in_studies_are_read_and_their_last_job_is_a_scene(name):
    study = read_study(name)
    assert study.name == name
    assert len(study) >= 10
    assert len(study.summary) > 20
    check_scene(tables_of(study, len(study) - 1), name)


def test_the_documented_study_is_read():
    text = (Path(__file__).parent.parent.parent / "docs" / "batch.md").read_text()
    assert len(read_study(tomllib.loads(re.search(r"```toml\n(.*?)```", text, re.DOTALL)[1]))) == 256


def test_a_study_has_the_scene_s_tables_under_what_is_fixed_and_its_jobs_differ_in_what_varies(tables):
    study = read_study(tables)
    assert (len(study), study.method, study.seed, study.chunk) == (20, "monte-carlo", 1, 32)
    assert study.asked.measure == ("maps", "iso")
    assert (study.tables["metrology"]["rows"], study.tables["metrology"]["columns"]) == (5, 7)
    assert study.source == tables
    first, last = tables_of(study, 0), tables_of(study, 19)
    assert [t["errors"].pop("pivot_um") for t in (first, last)] == [
        [0.0, 0.0, study.parameters[0].values[k]] for k in (0, 19)
    ]
    assert first == last
    again = read_study(study.source)
    assert (again.tables, again.parameters[0].values) == (study.tables, study.parameters[0].values)


def test_keys_lead_into_lists_and_tables_that_the_scene_s_file_leaves_out(tables, tmp_path):
    left_out = tomllib.loads(scene_text("spur-internal")[0])
    del left_out["errors"]
    (tmp_path / "mine.toml").write_text(to_toml(left_out))
    tables["study"]["scene"] = "mine.toml"
    tables["study"]["set"] = {"errors.pivot_um.1": 2.5}
    tables["vary"].append({"key": "surface.modification.helix_crowning_um", "low": 0.0, "high": 5.0})
    tables["vary"].append({"key": "tools.0.diameter_mm", "low": 3.0, "high": 3.1})
    study = read_study(tables, tmp_path)
    assert "modification" not in study.tables["surface"]
    scene = check_scene(tables_of(study, 7), "job")
    values = study.values_of(7)
    assert scene.surface.modification.helix_crowning_um == values["surface.modification.helix_crowning_um"]
    assert scene.tools[0].diameter_mm == values["tools.0.diameter_mm"]
    assert scene.errors.pivot_um == (0.0, 2.5, values["errors.pivot_um.2"])


def test_a_scene_s_path_begins_at_the_study_s_file(tmp_path, monkeypatch):
    (tmp_path / "gears").mkdir()
    (tmp_path / "gears" / "mine.toml").write_text(scene_text("helical-external")[0])
    (tmp_path / "study.toml").write_text(TEXT.replace('"helical-external"', '"gears/mine.toml"'))
    monkeypatch.chdir("/")
    assert read_study(tmp_path / "study.toml").folder == tmp_path / "gears"


def test_overrides_change_the_study_or_all_its_jobs(tables):
    study = read_study(tables, overrides=("study.samples=3", "metrology.rows=4", "errors.pivot_um.0=2.5"))
    assert len(study) == 3
    assert study.tables["metrology"]["rows"] == 4
    assert study.tables["errors"]["pivot_um"] == [2.5, 0.0, 0.0]
    assert "study.sampels: unknown key; did you mean 'samples'?" in refused(tables, "study.sampels=3")
    assert "expected table.key=value" in refused(tables, "samples=3")


VARIED = [
    ({"key": "errors.pivt_um.2"}, "vary.0 (errors.pivt_um.2): errors.pivt_um: unknown key; did you mean 'pivot_um'?"),
    ({"key": "erors.pivot_um.2"}, "vary.0 (erors.pivot_um.2): erors: unknown key; did you mean 'errors'?"),
    ({"key": "errors.pivot_um.3"}, "errors.pivot_um.3: 3 is no place in a list of 3; its entries are 0 to 2"),
    ({"key": "errors.pivot_um.02"}, "errors.pivot_um.02: 02 is no place in a list of 3; its entries are 0 to 2"),
    ({"key": "surface", "values": [1.0, 2.0]}, "vary.0 (surface): surface.kind: missing"),
    ({"key": "errors.pivot_um.2.x"}, "errors.pivot_um.2 is a value, not a table"),
    ({"key": "machine.kind", "values": ["no-such"]}, "machine.kind: got no-such; expected 'table-table-bc'"),
    ({"low": 1.0, "high": 2e4}, "input should be less than or equal to 10000 (7 of 20 jobs, first in job 2)"),
    ({"low": 1.0, "high": 1.0}, "vary.0: low 1 is not below high 1; give the smaller one first"),
    ({"low": 2.0, "high": 1.0}, "vary.0: low 2 is not below high 1"),
    ({"low": 0.0, "high": 1.0, "scale": "log"}, "vary.0: low: got 0; a logarithmic scale begins above 0"),
    ({"values": []}, "vary.0: values: the list is empty"),
    ({"values": [1, "a"]}, "values of errors.pivot_um.2: got numbers and texts; expected one kind"),
    ({"values": [1, True]}, "got numbers and truths; expected one kind"),
    ({"values": [float("nan")]}, "values of errors.pivot_um.2: got nan; expected numbers"),
    ({"values": ["a"]}, "errors.pivot_um.2: got 'a'; expected a number (all 20 jobs)"),
    ({"key": "errors.pivot_um", "values": [[1, 2, 3]]}, "vary its entries, each by its place: errors.pivot_um.0"),
    ({"key": "metrology.points", "low": 9.0, "high": 99.0}, "expected a whole number"),
    ({"distribution": "normal", "mean": 0.0}, "vary.0: deviation: missing; distribution = 'normal' has"),
    ({"distribution": "normal", "mean": 0.0, "deviation": 0.0}, "deviation: got 0; expected more than 0"),
    ({"distribution": "normal", "mean": 0, "deviation": 1, "low": 2}, "vary.0: low: not of this distribution"),
    ({"distribution": "normal", "mean": 0, "deviation": 1, "lower": 2, "upper": 1}, "lower 2 is not below upper 1"),
    ({"distribution": "normal", "mean": 0, "deviation": 1, "lower": 50}, "the distribution has nothing"),
    ({"distribution": "triangular", "low": 0, "mode": 2, "high": 1}, "mode 2 is not below high 1"),
    ({"distribution": "tolerance", "nominal": 0, "tolerance": -1}, "tolerance: got -1; expected more than 0"),
    ({"distribution": "norml", "mean": 0}, "vary.0.distribution: got 'norml'"),
    ({"low": float("inf"), "high": 1.0}, "vary.0.low: got inf"),
    ({"lo": 1.0, "high": 2.0}, "vary.0.lo: unknown key; did you mean 'low'?"),
    ({}, "vary.0: nothing says its values"),
    ({"low": 0.0, "high": 1.0, "count": 3}, "vary.0: count: even steps are for grid and list"),
    ({"keys": ["a.b", "c.d"], "key": None, "values": [[1, 2], [3]]}, "values.1: got [3]; expected a list of 2"),
    ({"keys": ["a.b", "c.d"], "values": [[1, 2]]}, "vary.0: give key"),
]  # fmt: skip


@pytest.mark.parametrize(("vary", "message"), VARIED)
def test_what_cannot_vary_so_is_told_before_the_first_job(tables, vary, message):
    form = {} if len(vary) != 1 or "key" not in vary else {"low": 0.0, "high": 1.0}
    entry = {"key": "errors.pivot_um.2", **form, **vary}
    tables["vary"] = [{k: v for k, v in entry.items() if v is not None}]
    assert message in refused(tables)


@pytest.mark.parametrize("key", ["metrology.rows", "metrology.columns"])
def test_maps_of_all_jobs_have_one_size(tables, key):
    del tables["study"]["set"]
    tables["vary"] = [{"key": key, "values": [5, 6]}]
    assert f"vary.0: {key} varies, and the maps of all jobs are one array" in refused(tables)
    assert len(read_study(tables, overrides=('study.measure=["iso"]',))) == 20


@pytest.mark.parametrize(
    ("header", "message"),
    [
        ({"scene": "helical-externl"}, "study.scene: no scene named 'helical-externl'; did you mean"),
        ({"scene": "spiral-bevel-flank"}, "study.measure: iso is for cylindrical gears"),
        ({"method": "sobl"}, "study.method: got 'sobl'"),
        ({"method": "grid"}, "samples: a grid has as many jobs as its values make; remove it"),
        ({"samples": None}, "samples: missing; a study by monte-carlo says how many jobs it has"),
        ({"samples": 0}, "study.samples: got 0"),
        ({"samples": 10**8}, "study.samples: got 100000000"),
        ({"seed": -1}, "study.seed: got -1"),
        ({"cross_checked": 1.5}, "study.cross_checked: got 1.5"),
        ({"measure": []}, "study.measure: got []"),
        ({"measure": ["maps", "maps"]}, "measure: got ['maps', 'maps']; each once"),
        ({"sample": 3}, "study.sample: unknown key; did you mean 'samples'?"),
        ({"name": "a/b"}, "study.name: got 'a/b'"),
        ({"set": {"errors.pivot_um.2": 1.0}}, "vary.0: errors.pivot_um.2 stands in study.set, too; every key once"),
        ({"set": {"errors.pivt_um": [0, 0, 0]}}, "under [study.set] of study wear: 1 mistake:\n  - errors.pivt_um"),
        ({"set": {"errors.pivot_um.5": 1.0}}, "study.set: errors.pivot_um.5: 5 is no place in a list of 3"),
    ],
)  # fmt: skip
def test_mistakes_of_the_study_s_own_table_are_told(tables, header, message):
    tables["study"] = {k: v for k, v in {**tables["study"], **header}.items() if v is not None}
    assert message in refused(tables)


def test_values_out_of_range_are_told_with_their_number(tables):
    tables["vary"] = [{"key": "errors.tool_radius_um", "values": [0.0, 1e5, 1.0, -2e4, 3e4]}]
    tables["study"] |= {"method": "grid"}
    del tables["study"]["samples"]
    message = refused(tables)
    assert (
        "errors.tool_radius_um: got 100000.0; input should be less than or equal to 10000 (2 of 5 jobs, first in job 1)"
        in message
    )
    assert "greater than or equal to -10000 (1 of 5 jobs, first in job 3)" in message


def test_of_very_many_jobs_the_ends_of_every_key_s_range_are_looked_at(tables):
    values = [0.0] * 12_001
    values[7_001] = 2e4
    tables["vary"] = [{"key": "errors.tool_radius_um", "values": values}]
    tables["study"] |= {"method": "list"}
    del tables["study"]["samples"]
    assert "got 20000.0" in refused(tables)


def test_a_key_stands_once(tables):
    tables["vary"].append(copy.deepcopy(tables["vary"][0]))
    assert "vary.1: errors.pivot_um.2 stands in vary.0, too; every key once" in refused(tables)


def test_a_study_varies_something_and_says_what_it_is(tables):
    assert "vary: missing" in refused({"study": tables["study"]})
    assert "study: missing" in refused({"vary": tables["vary"]})


def test_a_grid_that_explodes_is_refused_with_its_size(tables):
    del tables["study"]["samples"]
    tables["study"]["method"] = "grid"
    tables["vary"] = [{"key": f"errors.pivot_um.{k}", "low": 0.0, "high": 1.0, "count": 1000} for k in range(3)]
    assert "the grid has 1000 x 1000 x 1000 = 1,000,000,000 jobs; expected no more than 10,000,000" in refused(tables)


def test_files_that_are_no_studies_are_told(tmp_path):
    with pytest.raises(InputError, match="no study named 'cl-densty'; did you mean 'cl-density'"):
        read_study("cl-densty")
    file = tmp_path / "a.toml"
    file.write_text("[study\n")
    with pytest.raises(InputError, match=r"not valid TOML: .*'\[study"):
        read_study(file)
    file.write_text('[study]\nname = "a"\n')
    with pytest.raises(InputError, match="study: this file is a study, no scene; gearsim batch computes it"):
        load_scene(file)
    file.write_text('[surface]\nkind = "hypoid-pinion"\n')
    with pytest.raises(InputError, match="it is a scene, one job: gearsim run"):
        read_study(file)
