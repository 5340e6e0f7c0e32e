#!/bin/sh
# Dask distributed 2026.8: after its scheduler is lost and back at the same address, no worker comes back, and results
# that were finished and lie in the workers' memory are cancelled.
#
# A worker and its nanny end by themselves within seconds, although the scheduler is there again; the client reconnects
# to a cluster without workers. A future that was finished, and whose value had been fetched, is "cancelled"
# at once, and its result() raises.
#
# Expected: "The workers and clients will all reconnect to the scheduler after it comes back online but records of ongoing
# computations will be lost" (docs, resilience, scheduler failure). Who runs for hours needs a supervisor that starts
# workers again, and results in files. Exits 0 while this is so.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q dask==2026.8.0 distributed==2026.8.0 >/dev/null 2>&1 ||
    { echo "the packages cannot be fetched"; exit 2; }
venv/bin/python - 2>/dev/null <<'END'
import socket
import subprocess
import sys
import time

import distributed
from distributed import Client

print("distributed", distributed.__version__)
with socket.socket() as free:
    free.bind(("127.0.0.1", 0))
    port = str(free.getsockname()[1])
address = f"tcp://127.0.0.1:{port}"


def start(what, *arguments):
    command = [sys.executable, "-m", f"distributed.cli.dask_{what}", *arguments, "--no-dashboard"]
    return subprocess.Popen([*command, "--dashboard-address", "127.0.0.1:0"], stderr=subprocess.DEVNULL)


def until(true, seconds):
    """Wait until something is true; whether it became so."""
    end = time.monotonic() + seconds
    while not true() and time.monotonic() < end:
        time.sleep(0.02)
    return bool(true())


scheduler = start("scheduler", "--host", "127.0.0.1", "--port", port)
worker = start("worker", address, "--nworkers", "1", "--nthreads", "1")
client = Client(address, timeout=60)
client.wait_for_workers(1, timeout=60)
future = client.submit(pow, 2, 10)
print("before:", future.result(), future.status)
scheduler.kill()
scheduler.wait()
scheduler = start("scheduler", "--host", "127.0.0.1", "--port", port)
cancelled = until(lambda: future.status == "cancelled", 10)
client_back = until(lambda: client.status == "running", 30)
worker_left = until(lambda: worker.poll() is not None, 60)
workers = len(client.scheduler_info()["workers"]) if client_back else None
print(f"scheduler back; expected: client and worker reconnect; seen: client {client.status}, {workers} workers,", end=" ")
print(f"the worker's process {'has ended' if worker_left else 'runs'}; the finished future is {future.status}")
as_before = cancelled and client_back and worker_left and workers == 0
print("as before" if as_before else "CHANGED", flush=True)
client.close(timeout=5)
for process in (worker, scheduler):
    if process.poll() is None:
        process.terminate()
    process.wait()
sys.exit(not as_before)
END
