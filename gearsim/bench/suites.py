"""The suites by name, and the report of one run: its table, the machine, the versions."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from time import perf_counter
from typing import Any

import gearsim
from gearsim.bench.batch import batch
from gearsim.bench.code import code
from gearsim.bench.end_to_end import end_to_end
from gearsim.bench.envelope import envelope
from gearsim.bench.goals import goals
from gearsim.bench.gouging import gouging
from gearsim.bench.peers import peers
from gearsim.bench.program import program
from gearsim.bench.removal import removal
from gearsim.bench.scaling import scaling
from gearsim.bench.scenes import scenes
from gearsim.bench.stock import stock
from gearsim.errors import InputError
from gearsim.simulation.removal import device_name

Suite = Callable[[str, str], dict[str, Any]]


SIZES = ("small", "large")
SUITES: dict[str, Suite] = {
    "removal": removal, "envelope": envelope, "end-to-end": end_to_end, "goals": goals, "scaling": scaling,
    "peers": peers, "code": code, "program": program, "gouging": gouging,
    "scenes": scenes, "stock": stock, "batch": batch,
}  # fmt: skip


def run_suite(name: str, device: str, size: str = "small", against: Path | None = None) -> dict[str, Any]:
    """Run a suite and return its table with the machine it ran on.

    ``size`` is ``small`` (under 45 s on two cores; whole scenes take minutes) or ``large``; ``against`` is a virtual
    environment with another build, for suite ``scenes``. Raises InputError for what is unknown or does not go together.
    """
    if name not in SUITES:
        raise InputError(f"no benchmark suite {name!r}; there are {', '.join(SUITES)}")
    if size not in SIZES:
        raise InputError(f"no size {size!r}; there are {', '.join(SIZES)}")
    if against is None:
        return run_report(name, device, lambda: SUITES[name](device, size), size)
    if name != "scenes":
        raise InputError(f"--against runs another build's scenes: gearsim bench scenes --against VENV, not {name}")
    return run_report(name, device, lambda: scenes(device, size, against), size)


def run_report(name: str, device: str, measure: Callable[[], dict[str, Any]], size: str = "small") -> dict[str, Any]:
    """What ``measure`` returns (columns, rows, notes), with the machine, the versions and the time it took."""
    began, started = datetime.now(UTC).isoformat(timespec="seconds"), perf_counter()
    report = measure()
    total = perf_counter() - started
    return {"suite": name, "size": size, "began": began, "machine": machine(device), "total_s": total, **report}


def machine(device: str) -> dict[str, Any]:
    """Device, cores, system, and the versions that decide speed."""
    return {
        "device": device_name(device),
        "cores": os.cpu_count(),
        "processor": _processor(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "gearsim": gearsim.__version__,
        **{name: version(name) for name in ("warp-lang", "numpy")},
    }


def _processor() -> str:
    """The processor's name as Linux tells it, else what Python knows."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next(line.split(":", 1)[1].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor()
