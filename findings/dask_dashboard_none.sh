#!/bin/sh
# Dask distributed 2026.8: a cluster of threads in one process, without a dashboard, serves HTTP on all addresses.
#
# LocalCluster(processes=False, dashboard_address=None) talks within its process (inproc://) and needs no port. The
# dashboard's pages are away, the server that carries them is not: it listens on 0.0.0.0 at port 8787, or where there is a
# free one. Whoever reaches the machine reads the scheduler's state (/json/identity.json, /info/main/workers.html).
# With processes=True it listens on 127.0.0.1.
#
# Expected: nothing listens (docs: Set to None to disable the dashboard), or on 127.0.0.1 alone, which
# dashboard_address="127.0.0.1:0" does. Exits 0 while this is so.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q dask==2026.8.0 distributed==2026.8.0 >/dev/null 2>&1 ||
    { echo "the packages cannot be fetched"; exit 2; }
venv/bin/python - 2>/dev/null <<'END'
import json
import sys
import urllib.request

import distributed
from distributed import LocalCluster

print("distributed", distributed.__version__)


def seen(address):
    """Where the cluster's HTTP server listens, where its scheduler does, and what is read from the first."""
    with LocalCluster(n_workers=0, processes=False, dashboard_address=address) as cluster:
        server = cluster.scheduler.http_server
        hosts = sorted(s.getsockname()[0] for s in server._sockets.values())
        url = f"http://127.0.0.1:{server.port}/json/identity.json"
        with urllib.request.urlopen(url, timeout=10) as answer:
            kind = json.load(answer)["type"]
        return hosts, cluster.scheduler.address.partition(":")[0], kind


none, local = seen(None), seen("127.0.0.1:0")
print(f"dashboard_address=None: expected no server; seen one on {none[0]}, scheduler by {none[1]}; tells of {none[2]}")
print(f"dashboard_address='127.0.0.1:0': {local[0]}")
as_before = "0.0.0.0" in none[0] and none[1:] == ("inproc", "Scheduler") and local[0] == ["127.0.0.1"]
print("as before" if as_before else "CHANGED")
sys.exit(not as_before)
END
