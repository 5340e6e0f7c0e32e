"""``python -m tests.studies.kills [--moments N]``: kill -9 at random moments, resume, and count what is computed twice.

In turn a worker, the scheduler and the whole run are killed, of a study on a real Dask scheduler with two workers.
Every data set must be that of an undisturbed run, bit for bit, and nothing computed twice but what was in flight.
"""

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import time
from contextlib import nullcontext
from pathlib import Path
from tempfile import TemporaryDirectory

from gearsim.errors import GearsimError
from gearsim.studies.cluster import run_cluster
from gearsim.studies.progress import Silent
from gearsim.studies.reading import read_study
from gearsim.studies.store import Store
from tests.studies.fakes import FAKE, data, fake_study

ROOT = Path(__file__).parent.parent.parent
WORKERS = 2
WHAT = ("worker", "scheduler", "run")


class Cluster:
    """``dask scheduler`` and two ``dask worker`` of one thread on loopback; use as a context."""

    def __init__(self, folder, **environment):
        self._file = Path(folder) / "scheduler.json"
        self._environment = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
        self._processes = []

    def __enter__(self):
        self._file.unlink(missing_ok=True)
        here = ("--scheduler-file", str(self._file), "--host", "127.0.0.1", "--no-dashboard")
        self._start("scheduler", "--port", "0", *here)
        for _ in range(WORKERS):
            self._start("worker", "--nthreads", "1", "--memory-limit", "0", "--death-timeout", "30", *here)
        while not self._file.exists() or not self._file.read_text():
            time.sleep(0.02)
        return self

    def __exit__(self, *error):
        for process in self._processes:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()

    @property
    def address(self):
        return json.loads(self._file.read_text())["address"]

    def kill_scheduler(self):
        self._processes[0].kill()

    def _start(self, *words):
        command = [sys.executable, "-m", "dask", *words]
        silent = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "start_new_session": True}
        self._processes.append(subprocess.Popen(command, env=self._environment, cwd=ROOT, **silent))


def compute(out, counted, address, progress=None, count=40):
    """Compute what is left of a study on a cluster, and make its data set."""
    store = Store.create(Path(out), read_study(fake_study(count, 2, counted=counted)))
    left = [chunk for chunk in range(store.study.chunks) if chunk not in store.done()]
    run_cluster(store, left, progress or Silent(), scheduler=address, compute=FAKE)
    return store.finish()


def begun(counted):
    """First job and process of every chunk that was begun."""
    return [tuple(map(int, line.split())) for line in counted.read_text().splitlines()] if counted.exists() else []


def run_apart(out, counted, address, count=40):
    """The same in a process of its own."""
    command = [sys.executable, "-m", "tests.studies.kills", "--run", str(out), str(counted), address, str(count)]
    return subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True)


def moment(what, after_s, folder, cluster):
    """Kill so long after the first chunk was begun, resume where need be; chunks that were begun more than once."""
    out, counted = folder / "out", folder / "counted.txt"
    run = run_apart(out, counted, cluster.address)
    while not begun(counted):
        time.sleep(0.01)
    time.sleep(after_s)
    if what == "worker":
        os.kill(begun(counted)[-1][1], signal.SIGKILL)
    elif what == "scheduler":
        cluster.kill_scheduler()
    else:
        run.kill()
    _, told = run.communicate(timeout=120)
    assert "Traceback" not in told, told
    if run.returncode:
        with Cluster(folder) if what == "scheduler" else nullcontext(cluster) as other:
            again = run_apart(out, counted, other.address)
            assert again.wait(120) == 0, again.stderr.read()
    chunks = [job for job, _ in begun(counted)]
    return len(chunks) - len(set(chunks))


def main():
    parser = argparse.ArgumentParser(prog="tests.studies.kills")
    parser.add_argument("--moments", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--run", nargs=4)
    options = parser.parse_args()
    if options.run:
        try:
            compute(*map(Path, options.run[:2]), options.run[2], count=int(options.run[3]))
        except GearsimError as error:
            print(error, file=sys.stderr)
            return error.exit_code
        return 0
    chance, worst = random.Random(options.seed), 0
    with TemporaryDirectory() as scratch:
        whole = Path(scratch) / "whole"
        whole.mkdir()
        with Cluster(whole) as cluster:
            compute(whole / "out", whole / "counted.txt", cluster.address)
        for number in range(options.moments):
            what, after = WHAT[number % len(WHAT)], chance.uniform(0.0, 2.0)
            folder = Path(scratch) / f"{number}"
            folder.mkdir()
            with Cluster(folder) as cluster:
                twice = moment(what, after, folder, cluster)
            same = data(folder / "out") == data(whole / "out")
            print(f"{number:3} {what:9} after {after:.2f} s: {twice} computed twice, {'same' if same else 'DIFFERS'}")
            worst = max(worst, twice if same else 1000)
    return int(worst > WORKERS)


if __name__ == "__main__":
    sys.exit(main())
