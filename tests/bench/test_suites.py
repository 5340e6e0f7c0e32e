"""The suites' reports at tiny sizes, their arithmetic, and their command; no assertion on time."""

import json
import subprocess
import sys
from math import sqrt
from types import SimpleNamespace

import numpy as np
import pytest

from gearsim.bench import ceiling, end_to_end, goals, memory, removal, roofline, scaling, suites, workloads
from gearsim.bench.timing import Times, timed_cuts, timed_row
from gearsim.cli import main
from gearsim.cutters.catalogue import ball, conical
from gearsim.errors import InputError, NumericalError
from gearsim.output.screen import print_bench
from gearsim.output.summary import write_json
from gearsim.simulation.removal import cut, cut_jobs


@pytest.fixture
def tiny(monkeypatch):
    """Every workload cut down to some hundred rays; no subprocess, no measured ceiling."""
    few = {"small": (10, 40), "large": (10, 40)}
    case = workloads.pass_over_dexels()._replace(name="normals, continuous", rays=workloads.about_dexels(300))
    monkeypatch.setattr(removal, "base_cases", lambda: [case])
    monkeypatch.setattr(removal, "_RAY_SHAPES", {"small": ((2, 5), (4, 5))})
    monkeypatch.setattr(removal, "_BLOCK_SHARE", {"small": 2e-3})
    monkeypatch.setattr(removal, "_SEGMENTS", (2, 20))
    monkeypatch.setattr(removal, "poses_evaluated", lambda device, tolerances: {f"{case.name} @ 1e-09": 100_000})
    for module in (removal, roofline):
        monkeypatch.setattr(module, "ceiling", lambda device: ceiling.Ceiling(1e10, 1e10))
    monkeypatch.setattr(goals, "flank_cases", lambda: [case])
    monkeypatch.setattr(goals, "SAMPLES", (3, 7))
    monkeypatch.setattr(goals, "ENVELOPE_SAMPLES", (3, 7))
    monkeypatch.setattr(goals, "BLOCK_SHARE", {"small": 1e-4})
    monkeypatch.setattr(goals, "pass_over_dexels", lambda: case)
    monkeypatch.setattr(scaling, "RAYS", few)
    monkeypatch.setattr(scaling, "SEGMENTS", few)
    monkeypatch.setattr(scaling, "JOBS", {"small": (1, 3), "large": (1, 3)})
    monkeypatch.setattr(scaling, "BLOCK_SHARE", {"small": 2e-3, "large": 2e-3})
    monkeypatch.setattr(scaling, "growth", lambda kind, size: (100.0, 2e8))
    monkeypatch.setattr(scaling, "peak_of", lambda *job: memory.Peak(1, 1000, 276, 10**9, 2.0, 3.0))
    monkeypatch.setattr(end_to_end, "_run", lambda folder, device: dict.fromkeys(("seconds", *end_to_end.STAGES), 2.0))


@pytest.mark.parametrize("name", ["removal", "goals", "scaling", "end-to-end"])
def test_a_report_fits_its_columns_its_screen_and_json(name, tiny, tmp_path, capsys):
    report = suites.run_suite(name, "cpu")
    assert report["suite"] == name
    assert report["size"] == "small"
    assert {"device", "gearsim", "warp-lang", "numpy", "python", "cores"} <= set(report["machine"])
    assert report["rows"]
    assert all(set(report["columns"]) <= set(row) for row in report["rows"])
    print_bench(report)
    assert report["columns"][0] in capsys.readouterr().out
    write_json(report, tmp_path / "report.json")
    assert json.loads((tmp_path / "report.json").read_text())["rows"] == json.loads(json.dumps(report["rows"]))


def test_the_removal_suite_covers_tolerances_threads_and_decades(tiny):
    rows = removal.removal("cpu", "small")["rows"]
    assert {row["mm"] for row in rows} == {1e-6, 1e-9}
    assert {row["threads"] for row in rows} >= {1}
    assert {row["rays"] for row in rows if row["case"].startswith("more rays")} == {10, 20}
    assert {row["segments"] for row in rows if row["case"].startswith("more segments")} == {2, 20}
    counted = [row for row in rows if row["poses/pair"] != "-"]
    assert {row["mm"] for row in counted} == {1e-9}


def test_a_goal_is_met_from_its_own_side():
    assert goals.figure("rate", 8.0, 0.0, 8.0)["met"] == "yes"
    assert goals.figure("rate", 7.9, 0.0, 8.0)["met"] == "no"
    assert goals.figure("ratio", 1.1, 0.0, 1.2, at_most=True)["met"] == "yes"
    assert goals.figure("ratio", 1.3, 0.0, 1.2, at_most=True)["met"] == "no"


def test_a_law_is_found_again_and_prolonged():
    sizes = np.array([10.0, 100.0, 1000.0, 10000.0])
    law = scaling.fitted(sizes, 3e-6 * sizes**1.25)
    assert law.exponent == pytest.approx(1.25, abs=1e-12)
    assert law.factor == pytest.approx(3e-6)
    assert law.last == pytest.approx(1.25, abs=1e-12)
    assert law.predict(1e6) == pytest.approx(3e-6 * 1e6**1.25)


def test_a_constant_part_flattens_the_fit_but_not_the_last_decade():
    sizes = np.array([1.0, 10.0, 100.0, 1e6, 1e7])
    law = scaling.fitted(sizes, 1e-3 + 1e-6 * sizes)
    assert law.exponent < 0.8
    assert law.last == pytest.approx(1.0, abs=1e-3)


def test_the_largest_job_fills_the_memory(tiny):
    """Bytes taken by the predicted number of rays, the tile and the process add up to the limit."""
    report = scaling.scaling("cpu", "large")
    for row in report["rows"]:
        each = max(row["B each"], row["B each, counted"])
        assert row["fits 80 GB"] * each + 2e8 + memory.tile_bytes() == pytest.approx(80e9, rel=1e-6)
    assert report["big"]["peak"] == 10**9
    assert "the law says" in report["notes"][-1]


def test_medians_and_spreads():
    times = Times((3.0, 1.0, 2.0))
    assert (times.median, times.spread) == (2.0, 1.0)


def test_rates_follow_from_the_time(tiny):
    case = workloads.pass_over_dexels()._replace(rays=workloads.about_dexels(200))
    coarse, fine = timed_cuts("cpu", case, 1, (1e-6, 1e-9), repeats=2)
    assert len(coarse.wall.all) == len(fine.cpu.all) == 2
    assert coarse.last.candidates == fine.last.candidates
    row = timed_row(case, 1, 1e-9, fine)
    assert row["Mcand/s"] * row["seconds"] == pytest.approx(1e-6 * fine.last.candidates)


def test_the_blocks_path_keeps_its_density_and_stays_on_the_block():
    for share in (0.001, 0.01):
        path = workloads.block_path(share)
        assert path.pieces == pytest.approx(share * workloads.BLOCK_SEGMENTS, rel=0.05)
        size = sqrt(share) * np.array([100.0, 60.0])
        assert np.all((path.tips[:, :2] > -1e-9) & (path.tips[:, :2] < size + 1e-9))
        assert np.degrees(np.arccos(path.axes[:, 2].min())) < 15.01
        turning = np.linalg.norm(np.diff(path.axes, axis=0), axis=1)
        rising = np.abs(np.diff(path.tips[:, 2]))
        assert np.median(turning) > 1e-4  # five axes
        assert np.median(rising) > 1e-3  # ramps


def test_a_path_compiled_in_stretches_is_the_same(monkeypatch):
    path, cutter = workloads.block_path(2e-4), ball(6.0, 40.0)
    whole = workloads.compiled(path, cutter)
    monkeypatch.setattr(workloads, "COMPILED_AT_ONCE", 7)
    parts = workloads.compiled(path, cutter)
    assert len(parts) == len(whole)
    assert np.array_equal(parts.tip, whole.tip)


def test_small_jobs_cut_together_are_the_jobs_cut_alone():
    jobs = workloads.inspections(3)
    assert [len(job.rays) for job in jobs] == [45, 45, 45]
    assert not np.array_equal(jobs[0].table.tip, jobs[1].table.tip)
    for job, done in zip(jobs, cut_jobs(jobs), strict=True):
        assert np.array_equal(done.removed.lo, cut(*job).removed.lo)


def test_the_memory_of_jobs_counts_all_their_rays_and_segments():
    peak = memory._cut("jobs", 2, memory.SMALL_TILE)
    assert (peak.jobs, peak.rays, peak.segments) == (2, 90, 2 * len(workloads.inspections(1)[0].table))


def test_a_tri_dexel_of_about_so_many_rays():
    assert len(workloads.about_dexels(1000)) == pytest.approx(1000, rel=0.15)


class Counted(float):
    """A number that counts the operations made with it."""

    done = 0

    def _made(self, value):
        Counted.done += 1
        return Counted(value)

    def __add__(self, other):
        return self._made(float(self) + float(other))

    def __sub__(self, other):
        return self._made(float(self) - float(other))

    def __mul__(self, other):
        return other * self if isinstance(other, Vector) else self._made(float(self) * float(other))

    def __neg__(self):
        return Counted(-float(self))

    def __truediv__(self, other):
        return self._made(float(self) / float(other))

    __radd__, __rmul__ = __add__, __mul__


class Vector(tuple):
    """Three of them."""

    def __add__(self, other):
        return Vector(a + b for a, b in zip(self, other, strict=True))

    def __sub__(self, other):
        return Vector(a - b for a, b in zip(self, other, strict=True))

    def __mul__(self, number):
        return Vector(Counted(a) * number for a in self)

    __rmul__ = __mul__


def dot(a, b):
    products = [Counted(x) * y for x, y in zip(a, b, strict=True)]
    return products[0] + products[1] + products[2]


def operations(function, *arguments):
    """Operations of a kernel function's own source, run in Python on numbers that count."""
    make = lambda *of: Vector(Counted(x) for x in (of or (0.0, 0.0, 0.0)))
    warp = SimpleNamespace(dot=dot, vec3d=make)
    blank = {name: SimpleNamespace for name in ("Pose", "Contact", "ToolRay")}
    names = {"wp": warp, "f64": Counted, "range": range, **blank}
    Counted.done = 0
    type(function)(function.__code__, names)(*arguments)
    return Counted.done


def test_the_operations_of_a_pose_and_a_contact_are_those_of_the_source():
    from gearsim.kernels import contact, pose, tool_ray

    vector = Vector(Counted(x) for x in (0.1, 0.2, 0.3))
    table = {(0, k): vector for k in range(6)}
    motion = SimpleNamespace(tip=table, axis=table)
    assert operations(pose.pose_at.func, motion, 0, Counted(0.5)) == roofline.OPERATIONS["pose"]
    frame = SimpleNamespace(tip=vector, axis=vector, tip_rate=vector, axis_rate=vector)
    seen = operations(tool_ray.tool_ray.func, vector, vector, Counted(1.0), vector, vector)
    assert seen == roofline.OPERATIONS["tool ray"]
    ray = SimpleNamespace(w1=vector, dz=Counted(0.2))
    one = Counted(1.0)
    assert operations(contact.with_rates.func, frame, ray, one, one, one, vector, one, (one, one)) == 35


def test_operations_grow_with_the_tools_shape():
    cone, sphere = conical(1.0, 0.8, 0.26, 25.0), ball(6.0, 40.0)
    assert roofline.cull_operations(cone) == 53 + 25 + 20
    assert roofline.evaluation_operations(cone) == 120 + roofline.cull_operations(cone) + 55 + 40
    assert roofline.cull_operations(sphere) == roofline.cull_operations(cone)  # an arc and a line each


def test_roofline_shares_are_rates_over_ceilings(tiny):
    case = workloads.pass_over_dexels()
    row = {"candidates": 1000, "pairs": 100, "rays": 10, "seconds": 1e-3, "threads": 2}
    found = roofline.roofline("cpu", case, row, poses=1500)
    flop = 100 * roofline.cull_operations(case.cutter) + 1500 * roofline.evaluation_operations(case.cutter)
    assert found["poses/pair"] == 15.0
    assert found["flop/pair"] == pytest.approx(flop / 100)
    assert found["of flops"] == pytest.approx(flop / 1e-3 / 2e10)


def test_counted_bytes_are_those_of_the_arrays():
    case = workloads.pass_over_dexels()
    assert memory.arrays_bytes(case.rays) == 64 * len(case.rays)
    assert memory.segment_bytes(case) == 2 * (2 * 144 + 3 * 8 + 8 + 2 * 8 + 8) + 2 * 24 + 312


def test_a_failed_run_is_told(tmp_path, monkeypatch):
    monkeypatch.setattr(end_to_end, "SCENE", "nosuch")
    with pytest.raises(NumericalError, match="exit code 2: gearsim: no scene named 'nosuch'"):
        end_to_end._run(tmp_path, "cpu")


def test_poses_are_counted_by_the_kernels():
    """At least both ends of every pair; more, the finer the tolerance."""
    case = workloads.pass_over_dexels()._replace(name="cut", rays=workloads.about_dexels(200))
    script = (
        "import json\nfrom gearsim.bench import counting, workloads\n"
        "case = workloads.pass_over_dexels()._replace(name='cut', rays=workloads.about_dexels(200))\n"
        "counting.base_cases = lambda: [case]\n"
        "print(json.dumps(counting._count('cpu', [1e-3, 1e-9])))\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    poses = json.loads(done.stdout.splitlines()[-1])
    plain = cut(case.rays, case.table, case.cutter, tolerance=1e-9)
    assert 2 * plain.pairs <= poses["cut @ 0.001"] < poses["cut @ 1e-09"]


def test_the_command_lists_suites_and_refuses_nonsense(capsys):
    assert main(["bench"]) == 0
    listed = capsys.readouterr().out
    assert all(name in listed for name in suites.SUITES)
    assert main(["bench", "removal", "--size", "huge"]) == 2
    assert "no size 'huge'; there are small, large" in capsys.readouterr().err
    assert main(["bench", "removal", "--peers"]) == 2
    capsys.readouterr()
    assert main(["bench", "removal", "--against", "."]) == 2
    assert "gearsim bench scenes --against VENV, not removal" in capsys.readouterr().err
    assert main(["bench", "--against", "."]) == 2
    assert "--against goes with a suite" in capsys.readouterr().err
    with pytest.raises(InputError, match="no benchmark suite"):
        suites.run_suite("nosuch", "cpu")
