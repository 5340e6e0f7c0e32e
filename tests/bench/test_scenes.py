"""Suite `scenes`: the smallest scene, what a command took, the table's arithmetic; no assertion on time."""

import os
import sys
from pathlib import Path

import pytest
import warp as wp

from gearsim.bench import scenes
from gearsim.bench.builds import Build, build_in
from gearsim.bench.children import Usage, watched
from gearsim.bench.suites import run_suite
from gearsim.errors import InputError, NumericalError
from gearsim.output.screen import print_bench

SMALLEST = "gouge-verification"
GREEDY = """
import subprocess, sys, time
held = bytearray(b"x") * {size}
if len(sys.argv) == 1:
    subprocess.run([sys.executable, __file__, "child"], check=True)
else:
    time.sleep(1.0)
sys.exit(3 if len(sys.argv) == 1 else 0)
"""


def usage(seconds=1.0, cpu_s=2.0, largest=3_000_000, together=4_000_000, exit_code=0):
    return Usage(exit_code, seconds, cpu_s, largest, together, "")


def test_the_smallest_scene_by_the_installed_command(monkeypatch, capsys):
    """Kernels come from the cache that the tests use."""
    wp.init()
    monkeypatch.setattr(scenes, "README", SMALLEST)
    monkeypatch.setattr(scenes, "NAMED", ())
    monkeypatch.setattr(scenes, "REPEATS", {"small": 1})
    monkeypatch.setattr(scenes, "_kernels", lambda build: Path(wp.config.kernel_cache_dir).parent)
    monkeypatch.setattr(scenes, "_cold", lambda device, build: usage())
    report = run_suite("scenes", "cpu")
    warm, _ = report["rows"]
    assert (warm["build"], warm["runs"], warm["exit"]) == ("this", 1, "0")
    assert 50.0 < warm["MB, largest"] <= warm["MB"]
    assert all(set(report["columns"]) <= set(row) for row in report["rows"])
    print_bench(report)
    assert "README's first command, warm" in capsys.readouterr().out


def test_a_command_is_watched_with_what_it_starts(tmp_path):
    size = 100_000_000
    script = tmp_path / "greedy.py"
    script.write_text(GREEDY.format(size=size))
    took = watched([sys.executable, str(script)], tmp_path, os.environ)
    assert took.exit_code == 3
    assert took.cpu_s > 0.0
    assert size < took.largest < 1.9 * size
    assert took.together > 2 * size


def test_a_command_too_short_to_be_seen_has_a_peak_still(tmp_path):
    took = watched(["/bin/sh", "-c", "echo wrong >&2; exit 2"], tmp_path, os.environ)
    assert (took.exit_code, took.said) == (2, "wrong")
    assert took.together >= took.largest > 0


def test_builds_take_turns_and_lead_in_turn():
    called = []

    def run(build):
        called.append(build)
        return usage(seconds=len(called))

    first, second = scenes._turns(["a", "b"], 3, run)
    assert called == ["a", "b", "b", "a", "a", "b"]
    assert [u.seconds for u in first] == [1, 4, 5]
    assert [u.seconds for u in second] == [2, 3, 6]


def test_a_run_that_had_to_compile_is_made_again(tmp_path):
    class Compiling:
        folder, runs = tmp_path, 0

        def run(self, scene, device, kernels):
            self.runs += 1
            (kernels / "1.0" / f"wp_{scene}_0").mkdir(parents=True, exist_ok=True)
            return type("Run", (), {"usage": usage(seconds=self.runs)})

    build = Compiling()
    assert scenes._warm("cpu", "one", build).seconds == 2
    assert scenes._warm("cpu", "one", build).seconds == 3
    assert scenes._warm("cpu", "another", build).seconds == 5


def test_rows_have_medians_and_the_others_over_ours():
    ours = [usage(seconds=s, cpu_s=1.0, largest=10**8) for s in (2.0, 1.0, 9.0)]
    theirs = [usage(seconds=s, cpu_s=3.0, largest=10**8, exit_code=1) for s in (8.0, 8.0, 1.0)]
    this, other, ratio = scenes._case("case", [ours, theirs])
    assert (this["seconds"], other["seconds"], ratio["seconds"], ratio["CPU s"]) == (2.0, 8.0, 4.0, 3.0)
    assert (this["exit"], other["exit"], this["runs"], this["spread"]) == ("0", "1", 3, 4.0)
    assert this["MB, largest"] == pytest.approx(100.0)
    assert scenes._case("case", [ours]) == [this]


def test_scenes_one_after_another_add_times_and_keep_the_highest_peak():
    cases = [
        scenes._case("a", [[usage(1.0, 2.0, 10**8, 3 * 10**8)], [usage(3.0)]]),
        scenes._case("b", [[usage(2.0, 2.0, 2 * 10**8, 2 * 10**8)], [usage(6.0)]]),
    ]
    this, other, ratio = scenes._one_after_another(cases)
    assert this["case"] == "all 2 scenes one after another"
    assert (this["seconds"], other["seconds"], ratio["seconds"], this["CPU s"]) == (3.0, 9.0, 3.0, 4.0)
    assert (this["MB"], this["MB, largest"]) == pytest.approx((300.0, 200.0))
    assert [row["seconds"] for row in scenes._one_after_another([case[:1] for case in cases])] == [3.0]


def test_the_large_size_runs_all_scenes_that_both_builds_have(monkeypatch):
    asked = []
    monkeypatch.setattr(Build, "scenes", lambda build: [scenes.README, "b", "a"] if build.folder.name == "this"
                        else ["a", scenes.README])  # fmt: skip
    monkeypatch.setattr(Build, "version", lambda build: "gearsim 1")
    monkeypatch.setattr(scenes, "_cold", lambda device, build: usage())
    monkeypatch.setattr(scenes, "_warm", lambda device, scene, build: asked.append(scene) or usage())
    report = scenes.scenes("cpu", "large", Path(sys.prefix))
    assert [row["case"] for row in report["rows"][6::3]] == ["a", "all 2 scenes one after another"]
    assert asked == [scenes.README] * 10 + ["a"] * 2
    assert "left out, not in both builds: b" in report["notes"]
    assert f"other: gearsim 1 in {sys.prefix}" in report["notes"]


def test_what_is_no_build_is_told(tmp_path):
    with pytest.raises(InputError, match="no program bin/gearsim in it"):
        build_in(tmp_path, tmp_path)
    with pytest.raises(InputError, match="--against"):
        scenes.scenes("cpu", "small", tmp_path)


def test_a_run_without_a_report_is_told(tmp_path):
    program = tmp_path / "gearsim"
    program.write_text("#!/bin/sh\necho Traceback >&2\nexit 1\n")
    program.chmod(0o755)
    build = Build(program, tmp_path)
    with pytest.raises(NumericalError, match="ended with exit code 1: Traceback"):
        build.run("any", "cpu", tmp_path)
    with pytest.raises(NumericalError, match="--version ended with exit code 1"):
        build.version()
