"""How often the kernels evaluate a pose: counted exactly, by kernels compiled once more with a counter in it.

Runs in a process of its own (``python -m gearsim.bench.counting``), because it changes the kernels' modules.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

from gearsim.bench.workloads import base_cases
from gearsim.kernels import pose
from gearsim.kernels.pose import Motion, Pose
from gearsim.motion.segments import SegmentTable
from gearsim.simulation import removal

f64: Any = wp.float64
_pose_at = pose.pose_at
_place_at = pose.place_at


@wp.func
def counted_pose_at(motion: Motion, row: int, x: f64) -> Pose:
    """pose_at, which adds one to a counter kept behind the speeds; on a CPU that is safe on one thread only."""
    wp.atomic_add(motion.speed, motion.tip.shape[0] + row, f64(1.0))
    return _pose_at(motion, row, x)


@wp.func
def counted_place_at(motion: Motion, row: int, x: f64) -> Pose:
    """The same for place_at."""
    wp.atomic_add(motion.speed, motion.tip.shape[0] + row, f64(1.0))
    return _place_at(motion, row, x)


def poses_evaluated(device: str, tolerances: Sequence[float]) -> dict[str, int]:
    """Poses that the base cases of the removal suite evaluate, keyed ``case @ tolerance``; by a subprocess."""
    command = [sys.executable, "-m", "gearsim.bench.counting", device, *map(str, tolerances)]
    with tempfile.TemporaryDirectory() as nowhere:
        done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=nowhere)
    found: dict[str, int] = json.loads(done.stdout.splitlines()[-1])
    return found


def _count(device: str, tolerances: Sequence[float]) -> dict[str, int]:
    for name, module in list(sys.modules.items()):
        for evaluation, counted in (("pose_at", counted_pose_at), ("place_at", counted_place_at)):
            if name.startswith("gearsim.kernels") and hasattr(module, evaluation):
                vars(module)[evaluation] = counted
    counters = _count_behind_speeds()
    found = {}
    for case in base_cases():
        for tolerance in tolerances:
            removal.cut(case.rays, case.table, case.cutter, device=device, tolerance=tolerance, threads=1)
            found[key(case.name, tolerance)] = int(counters.pop().numpy()[len(case.table) :].sum())
    return found


def _count_behind_speeds() -> list[Any]:
    """Let motions carry as many counters behind their speeds as they have rows; the list gets each such array."""
    counters: list[Any] = []
    motion_data = removal.motion_data

    def with_counters(table: SegmentTable, device: str) -> Motion:
        data = motion_data(table, device)
        data.speed = wp.array(np.concatenate([table.speed, np.zeros(len(table))]), dtype=f64, device=device)
        counters.append(data.speed)
        return data

    vars(removal)["motion_data"] = with_counters
    return counters


def key(case: str, tolerance: float) -> str:
    """The name under which a count is kept."""
    return f"{case} @ {tolerance:g}"


if __name__ == "__main__":
    print(json.dumps(_count(sys.argv[1], [float(t) for t in sys.argv[2:]])))
