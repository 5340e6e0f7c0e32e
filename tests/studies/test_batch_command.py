"""The command in one process, on jobs that are quick stand-ins."""

import os
import signal

import pyarrow.parquet as pq
import pytest

import gearsim
from gearsim.cli import main
from gearsim.errors import InputError
from gearsim.output.jobs_bar import told
from tests.studies.fakes import BAD, RAISES, data, fake_chunk, fake_study
from tests.sweep.scenes import to_toml


def stand_in(monkeypatch, compute):
    """Let ``compute`` do what planning and measuring a chunk would."""
    monkeypatch.setattr("gearsim.studies.local.plan_chunk", lambda study, jobs: None)
    measure = lambda study, jobs, planned, device, cores: compute(study, jobs, device, cores)
    monkeypatch.setattr("gearsim.studies.local.measure_chunk", measure)


@pytest.fixture(autouse=True)
def _quick_jobs(monkeypatch):
    stand_in(monkeypatch, fake_chunk)


@pytest.fixture
def batch(tmp_path, capsys):
    """Runs a study of stand-ins by the command; exit code, standard output, standard error."""

    def run(tables, *options):
        (tmp_path / "study.toml").write_text(to_toml(tables))
        code = main(["batch", str(tmp_path / "study.toml"), "--out", str(tmp_path / "out"), *options])
        return code, *capsys.readouterr()

    return run


def test_3_bad_jobs_of_20_leave_17_results_and_3_rows_that_say_why(batch, tmp_path):
    code, out, _ = batch(fake_study(20, 4, special=(BAD, BAD, BAD)))
    assert code == 1
    assert "3 jobs have an error, job 0 first: the tool does not fit" in out
    assert "fake: 20 jobs: " in out
    rows = pq.read_table(tmp_path / "out" / "jobs.parquet").to_pylist()
    assert [row["verdict"] for row in rows] == ["error"] * 3 + ["pass"] * 17
    assert [row["error"] for row in rows if row["error"]] == ["the tool does not fit"] * 3
    assert [row["job"] for row in rows] == list(range(20))


def test_a_fault_of_the_program_costs_its_own_job_alone(batch, tmp_path):
    code, out, _ = batch(fake_study(6, 3, special=(100, RAISES)))
    assert code == 1
    assert "1 job has an error, job 1 first: RuntimeError: nobody has thought of this" in out
    assert pq.read_table(tmp_path / "out" / "jobs.parquet")["verdict"].to_pylist() == ["pass", "error", *["pass"] * 4]


@pytest.mark.parametrize("error", [InputError("no such device"), OSError("no room")])
def test_what_is_wrong_with_the_machine_is_no_job_s_fault(batch, tmp_path, monkeypatch, error):
    def refuse(*_):
        raise error

    stand_in(monkeypatch, refuse)
    code, _, err = batch(fake_study(6, 3))
    assert (code, err) == (2, f"gearsim: {error}\n")


def test_python_does_what_the_command_does(batch, tmp_path):
    tables = fake_study(6, 4)
    assert batch(tables)[0] == 0
    result = gearsim.study(tables, tmp_path / "python")
    assert (result.exit_code, dict(result.counts), result.table.num_rows) == (0, {"pass": 6}, 6)
    assert data(tmp_path / "python") == data(tmp_path / "out")


@pytest.mark.parametrize("workers", [0, -2, 1.5, "2", True])
def test_python_refuses_workers_that_are_no_number_of_them(tmp_path, workers):
    with pytest.raises(gearsim.InputError, match=f"workers: got {workers!r}; expected a whole number above 0"):
        gearsim.study(fake_study(6, 4), tmp_path / "none", workers=workers)
    assert not (tmp_path / "none").exists()


def test_a_study_that_is_misspelt_ends_before_the_first_job(batch, tmp_path):
    code, _, err = batch(fake_study(), "--set", "simulation.interval_slot=5")
    assert code == 2
    assert "did you mean 'interval_slots'?" in err
    assert not (tmp_path / "out").exists()


def test_a_dry_run_says_what_would_be_computed(batch, tmp_path):
    code, out, _ = batch(fake_study(20, 8), "--dry-run")
    assert code == 0
    assert "fake: 20 jobs in 3 chunks" in out
    assert "simulation.interval_slots  20 values from 100 to 119" in out
    assert "0 jobs are kept" in out
    assert not (tmp_path / "out").exists()


def test_a_dry_run_is_refused_where_the_study_would_be(batch, tmp_path):
    assert batch(fake_study(6, 3))[0] == 0
    code, out, err = batch(fake_study(6, 4), "--dry-run")
    assert (code, out) == (2, "")
    assert "holds another study: chunk (3 there, 4 here)" in err


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_a_study_that_is_stopped_says_how_to_go_on_and_does(batch, tmp_path, monkeypatch, sent):
    before = signal.getsignal(signal.SIGTERM)
    begun = []

    def stopped(study, jobs, *rest):
        begun.append(jobs[0])
        if len(begun) == 3:
            os.kill(os.getpid(), sent)
        return fake_chunk(study, jobs, *rest)

    stand_in(monkeypatch, stopped)
    at_first = signal.signal(signal.SIGINT, signal.default_int_handler)  # a background shell has it ignored
    try:
        code, _, err = batch(fake_study(20, 4))
    finally:
        signal.signal(signal.SIGINT, at_first)
    assert code == 130
    assert f"stopped; 8 of 20 jobs are kept in {tmp_path / 'out'}; the same command goes on from there" in err
    assert batch(fake_study(20, 4))[0] == 0
    assert begun == [0, 4, 8, 8, 12, 16]
    stand_in(monkeypatch, fake_chunk)
    gearsim.study(fake_study(20, 4), tmp_path / "whole")
    assert data(tmp_path / "out") == data(tmp_path / "whole")
    assert signal.getsignal(signal.SIGTERM) == before


def test_another_study_in_the_folder_is_refused(batch):
    assert batch(fake_study(6))[0] == 0
    code, _, err = batch(fake_study(8))
    assert code == 2
    assert "holds another study" in err


def test_workers_and_a_scheduler_exclude_each_other(tmp_path):
    with pytest.raises(InputError, match="exclude each other"):
        gearsim.study(fake_study(), tmp_path, workers=2, scheduler="tcp://127.0.0.1:1")


def test_progress_is_told_by_jobs_with_rate_and_time_left():
    assert told(1000, 0, 0, 0, 0.0) == "0 of 1,000 jobs"
    assert told(1000, 200, 300, 2, 60.0) == "500 of 1,000 jobs, 2 with an error, 5 jobs/s, 1 min 40 s left"
    assert told(100_000, 0, 10, 0, 10.0).endswith("1 jobs/s, 27 h 46 min left")
    assert told(10, 5, 5, 0, 1.0).endswith("0 s left")
