"""``python -m tests.builds OLD NEW [SCENE ...]``: compare what two builds' runs left behind.

OLD and NEW are folders with a run a scene in each (report.json, samples.parquet), or gearsim executables, which then
run all scenes into scratch folders.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from gearsim.scene import scene_names
from tests.builds.compare import compare_runs

_SHOWN = 12


def main(old: str, new: str, scenes: list[str]) -> int:
    worst = 0
    with tempfile.TemporaryDirectory() as scratch:
        for scene in scenes or list(scene_names()):
            folders = [_run(build, scene, Path(scratch) / str(i)) for i, build in enumerate((old, new))]
            if not all((folder / "report.json").exists() for folder in folders):
                print(f"{scene}: not in both")
                worst = 1
                continue
            compared, differ, lost = compare_runs(*folders)
            largest = max((abs(d.old - d.new) for d in differ), default=0.0)
            print(f"{scene}: {compared:,} numbers, {len(differ)} differ (largest {largest:.3g}), {len(lost)} not found")
            for d in differ[:_SHOWN]:
                print(f"    {d.name}: {d.old!r} -> {d.new!r}")
            for name in lost[:_SHOWN]:
                print(f"    not found: {name}")
            worst = max(worst, int(bool(differ or lost)))
    return worst


def _run(build: str, scene: str, scratch: Path) -> Path:
    if Path(build).is_dir():
        return Path(build) / scene
    folder = scratch / scene
    subprocess.run([build, "run", scene, "--out", str(folder)], stdout=subprocess.DEVNULL, check=False)
    return folder


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], sys.argv[3:]))
