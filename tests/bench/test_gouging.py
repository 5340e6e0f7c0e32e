"""The suite `gouging` at a tiny size; no assertion on time."""

import json

import pytest

from gearsim.bench import gouging, suites
from gearsim.output.screen import print_bench


def test_the_suite_tells_points_per_second_and_disagreements(monkeypatch, capsys):
    monkeypatch.setattr(gouging, "GRID", {"small": 12})
    monkeypatch.setattr(gouging, "PAIRS", {"small": 100})
    report = suites.run_suite("gouging", "cpu")
    rows = {row["what"]: row for row in report["rows"]}
    assert all(set(report["columns"]) == set(row) for row in report["rows"])
    assert rows["NURBS jets"]["points"] == 144
    assert rows["NURBS jets"]["result"] == "100% finite"
    assert rows["decision and clearance"]["points"] == 100
    assert rows["decision and clearance"]["result"].startswith("0 disagree")
    for row in report["rows"]:
        assert row["points/s"] == pytest.approx(row["points"] / row["seconds"])
    print_bench(report)
    assert "largest ball" in capsys.readouterr().out
    json.dumps(report)
