"""Benchmark suite `end-to-end`: the README's first command as a user runs it, kernels compiled anew and reused."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from gearsim.bench.builds import this_build
from gearsim.bench.timing import Times

SCENE = "spiral-bevel-flank"
REPEATS = {"small": 1, "large": 3}
STAGES = ("compile", "plan", "kernel", "total")
_COLUMNS = ("case", "runs", "seconds", "spread", *(f"{stage} s" for stage in STAGES))


def end_to_end(device: str, size: str) -> dict[str, Any]:
    """The README's first command in a process of its own: cold (an empty kernel cache) and warm."""
    runs: dict[str, list[dict[str, float]]] = {"cold": [], "warm": []}
    for _ in range(REPEATS[size]):
        with TemporaryDirectory() as folder:
            for kind in runs:
                runs[kind].append(_run(Path(folder), device))
    rows = [_row(kind, of) for kind, of in runs.items()]
    notes = [
        f"gearsim run {SCENE} by the installed command, wall time from start to exit, medians. cold: Warp's kernel "
        "cache is an empty folder; warm: the next run with that folder. Stages as the run's own report.json has them: "
        "compile (cold) or load (warm) the kernels, plan, launches of the removal kernels, and all between start and "
        "the writing of files.",
    ]
    return {"columns": list(_COLUMNS), "rows": rows, "notes": notes}


def _run(folder: Path, device: str) -> dict[str, float]:
    """One run with its kernel cache in a folder; seconds, in all and by stage."""
    run = this_build(folder).run(SCENE, device, folder / "kernels")
    return {"seconds": run.usage.seconds, **{stage: run.stages[stage] for stage in STAGES}}


def _row(kind: str, runs: list[dict[str, float]]) -> dict[str, Any]:
    times = Times(tuple(r["seconds"] for r in runs))
    stages = {f"{stage} s": Times(tuple(r[stage] for r in runs)).median for stage in STAGES}
    return {
        "case": f"README's first command, {kind}",
        "runs": len(runs),
        "seconds": times.median,
        "spread": times.spread,
        "all seconds": times.all,
        **stages,
    }
