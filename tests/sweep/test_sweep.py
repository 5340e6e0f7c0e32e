"""A few of the sweep's changes, the same ones each time; ``python -m tests.sweep`` goes through all."""

import pytest

from tests.sweep.__main__ import run_case
from tests.sweep.judge import faults
from tests.sweep.mutations import mutations
from tests.sweep.scenes import small
from tests.sweep.worker import Outcome, Worker

PLANNED = ("gouge-cases", "gouge-vertical-cylinder", "flat-end-envelope", "spiral-bevel-formate")
EVERY = 19


@pytest.fixture(scope="module")
def worker():
    with Worker(60.0) as worker:
        yield worker


@pytest.mark.parametrize("name", PLANNED)
def test_changed_scenes_end_with_a_code_and_one_message(name, worker, tmp_path):
    cases = list(mutations(name, small(name)))[:: EVERY if len(small(name)) > 3 else 1]
    found = {str(case): faults(run_case(case, ["--dry-run"], worker, tmp_path), case.refused) for case in cases}
    assert len(found) > 15
    assert {case: told for case, told in found.items() if told} == {}


@pytest.mark.parametrize(
    ("name", "place", "kind", "code"),
    [
        ("apt-envelope", "metrology.judged", "one less", 3),  # a surface that is measured and not judged
        ("gouge-cases", "simulation", "deleted", 0),
    ],
)
def test_changed_scenes_are_cut_to_a_verdict(name, place, kind, code, worker, tmp_path):
    found = [m for m in mutations(name, small(name)) if ".".join(map(str, m.place)) == place and m.kind == kind]
    for case in found:
        outcome = run_case(case, ["--no-pictures"], worker, tmp_path)
        assert faults(outcome, case.refused) == []
        assert outcome.code == code, outcome


def test_what_is_a_fault(worker):
    assert faults(Outcome(None, "", "Traceback ..."), False)
    assert faults(Outcome(0, "", "RuntimeWarning: overflow"), False)
    assert faults(Outcome(2, "", "gearsim: one\ngearsim: two"), False)
    assert faults(Outcome(2, "", ""), True)
    assert faults(Outcome(0, "x: nan rays; nothing was cut", ""), False)
    assert faults(Outcome(0, "x: -6,000 rays; nothing was cut", ""), False)
    assert faults(Outcome(0, "x: 6 rays; nothing was cut", ""), True) == ["nonsense ended with 0"]
    assert faults(Outcome(0, "x: 6 rays; nothing was cut", ""), False) == []


def test_changes_reach_every_key_and_leave_the_scene_as_it_is():
    tables = small("spiral-bevel-flank")
    before = repr(tables)
    made = list(mutations("spiral-bevel-flank", tables))
    assert {("cutter", "taper_deg"), ("program", "machine", "pivot_mm"), ("surface",)} <= {m.place for m in made}
    assert all(repr(m.apply(tables)) != before for m in made)
    assert repr(tables) == before


def test_a_case_that_hangs_or_dies_is_none(tmp_path):
    with Worker(0.05) as slow:
        assert slow.run(["scenes"]).code is None
