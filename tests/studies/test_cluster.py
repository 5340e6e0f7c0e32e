"""Studies on a real Dask scheduler with two workers, whose jobs are quick stand-ins."""

import dataclasses
import os
import signal
import sys
import time
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from gearsim.errors import InputError
from gearsim.studies import cluster as clusters
from gearsim.studies.cluster import ClusterError, quiet, run_cluster
from gearsim.studies.progress import Silent
from gearsim.studies.reading import read_study
from gearsim.studies.store import Store
from gearsim.studies.worker import errand, keep_chunk
from tests.studies.fakes import BAD, FAKE, RAISES, data, fake_chunk, fake_study
from tests.studies.kills import ROOT, WORKERS, Cluster, begun, compute, run_apart

pytest.importorskip("distributed")
CHUNKS = 10


class After(Silent):
    """Does something once so many jobs are done."""

    def __init__(self, jobs, action):
        self._left, self._action = jobs, action

    def advance(self, jobs, verdicts):
        self._left -= jobs
        if 0 >= self._left > -jobs:
            self._action()


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    with Cluster(tmp_path_factory.mktemp("cluster")) as running:
        yield running


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """The data set of a study computed in this process."""
    store = Store.create(tmp_path_factory.mktemp("undisturbed"), read_study(fake_study(2 * CHUNKS, 2)))
    return data(locally(store))


def locally(store):
    """Compute what is left of a study in this process."""
    for chunk in sorted(set(range(store.study.chunks)) - store.done()):
        store.put(chunk, *fake_chunk(store.study, store.study.jobs_of(chunk)))
    store.finish()
    return store.folder


def runs(process):
    """Whether there is such a process; one that nobody has waited for has ended all the same."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_a_worker_killed_loses_nothing(cluster, undisturbed, tmp_path):
    out, counted = tmp_path / "out", tmp_path / "counted"
    kill = After(6, lambda: os.kill(begun(counted)[-1][1], signal.SIGKILL))
    assert compute(out, counted, cluster.address, kill, 2 * CHUNKS) == {"pass": 2 * CHUNKS}
    assert data(out) == undisturbed
    assert CHUNKS <= len(begun(counted)) <= CHUNKS + WORKERS


def test_a_run_killed_goes_on_where_it_was(cluster, undisturbed, tmp_path):
    out, counted = tmp_path / "out", tmp_path / "counted"
    run = run_apart(out, counted, cluster.address, 2 * CHUNKS)
    while len(begun(counted)) < 4:
        assert run.poll() is None, run.stderr.read()
        time.sleep(0.01)
    run.kill()
    run.communicate()
    assert compute(out, counted, cluster.address, None, 2 * CHUNKS) == {"pass": 2 * CHUNKS}
    assert data(out) == undisturbed
    assert CHUNKS <= len(begun(counted)) <= CHUNKS + WORKERS


def test_a_chunk_that_raises_is_done_job_by_job(cluster, tmp_path):
    store = Store.create(tmp_path, read_study(fake_study(8, 2, special=(BAD, 120, RAISES))))
    run_cluster(store, range(4), Silent(), scheduler=cluster.address, compute=FAKE)
    assert store.finish() == {"error": 2, "pass": 6}
    rows = pq.read_table(tmp_path / "jobs.parquet").to_pylist()
    errors = {row["job"]: row["error"] for row in rows if row["error"]}
    assert errors == {0: "the tool does not fit", 2: "RuntimeError: nobody has thought of this"}


def test_a_chunk_in_which_workers_died_is_kept_job_by_job(cluster, tmp_path):
    store = Store.create(tmp_path, read_study(fake_study(4, 2, special=(BAD, 120))))
    with clusters._client(None, cluster.address) as (client, gone):
        clusters._Flow(client, Silent(), gone).job_by_job(errand(store, "cpu", FAKE), 0, store)
    assert store.done() == {0}
    store.put(1, *fake_chunk(store.study, store.study.jobs_of(1)))
    assert store.finish() == {"error": 1, "pass": 3}


def test_a_job_of_which_workers_die_says_so():
    from distributed.scheduler import KilledWorker

    assert clusters._told(KilledWorker("key", None, 3)).startswith("4 workers died of it, one after the other")


def test_ctrl_c_leaves_the_cluster_and_what_was_kept(cluster, undisturbed, tmp_path):
    def interrupt():
        raise KeyboardInterrupt

    out, counted = tmp_path / "out", tmp_path / "counted"
    with pytest.raises(KeyboardInterrupt):
        compute(out, counted, cluster.address, After(6, interrupt), 2 * CHUNKS)
    assert len(begun(counted)) < CHUNKS
    assert compute(out, counted, cluster.address, None, 2 * CHUNKS) == {"pass": 2 * CHUNKS}
    assert data(out) == undisturbed


def test_a_scheduler_killed_is_told_and_what_was_kept_stays(cluster, undisturbed, tmp_path):
    """The last one that has this cluster."""
    out, counted = tmp_path / "out", tmp_path / "counted"
    with pytest.raises(ClusterError, match=r"the Dask scheduler was lost; what was kept so far is whole: the same"):
        compute(out, counted, cluster.address, After(6, cluster.kill_scheduler), 2 * CHUNKS)
    store = Store.create(out, read_study(fake_study(2 * CHUNKS, 2, counted=counted)))
    assert 3 <= len(store.done()) < CHUNKS
    assert data(locally(store)) == undisturbed


def test_workers_of_this_machine_end_with_the_study(undisturbed, tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    counted = tmp_path / "counted"
    store = Store.create(tmp_path / "out", read_study(fake_study(2 * CHUNKS, 2, counted=counted)))
    run_cluster(store, range(CHUNKS), Silent(), workers=1, compute=FAKE)
    store.finish()
    assert data(tmp_path / "out") == undisturbed
    processes = {process for _, process in begun(counted)}
    assert os.getpid() not in processes
    assert not any(map(runs, processes))


def test_workers_that_cannot_start_are_told(tmp_path, monkeypatch):
    monkeypatch.setattr("gearsim.studies.local_workers._OPTIONS", ("--no-such-option",))
    store = Store.create(tmp_path, read_study(fake_study(4, 2)))
    with pytest.raises(ClusterError, match=r"all workers have ended; the last one's last word was: .*no-such-option"):
        run_cluster(store, range(2), Silent(), workers=1, compute=FAKE)


def test_a_scheduler_that_does_not_answer_is_told(tmp_path, monkeypatch):
    monkeypatch.setattr(clusters, "_CONNECT_S", 0.3)
    store = Store.create(tmp_path, read_study(fake_study(4, 2)))
    with pytest.raises(ClusterError, match=r"no Dask scheduler answers at tcp://127\.0\.0\.1:9"):
        run_cluster(store, range(2), Silent(), scheduler="tcp://127.0.0.1:9", compute=FAKE)


@pytest.mark.parametrize("address", ["nonsense", "nonsense://x:1", "tcp://host", "tcp://host:port"])
def test_a_scheduler_s_address_that_is_none_is_told(tmp_path, address):
    store = Store.create(tmp_path, read_study(fake_study(4, 2)))
    with pytest.raises(InputError, match=f"scheduler '{address}': .*; expected an address like tcp://HOST:8786"):
        run_cluster(store, range(2), Silent(), scheduler=address, compute=FAKE)


def test_dask_that_is_not_installed_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r"pip install 'gearsim\[batch\]'"):
        quiet()


@pytest.fixture
def asked(tmp_path):
    return errand(Store.create(tmp_path, read_study(fake_study(4, 2))), "cpu", FAKE)


def test_a_worker_computes_no_chunk_that_is_kept(asked):
    assert keep_chunk(asked, 1) == {"pass": 2}
    assert keep_chunk(asked, 1) == {}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"folder": "/no/such/folder"}, r"does not see the study's folder /no/such/folder .*same path"),
        ({"digest": "0" * 64}, "sees another study in"),
        ({"versions": (("gearsim", "0.0.0"), ("python", "2.7"))}, "is computed by gearsim 0.0.0, python 2.7: install"),
    ],
)
def test_a_worker_that_cannot_take_part_says_why(asked, change, message):
    with pytest.raises(InputError, match=message):
        keep_chunk(dataclasses.replace(asked, **change), 0)
