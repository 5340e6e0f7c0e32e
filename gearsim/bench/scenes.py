"""Benchmark suite `scenes`: whole runs of built-in scenes as a user makes them, beside another build."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

from gearsim.bench.builds import Build, build_in, this_build
from gearsim.bench.children import Usage
from gearsim.bench.timing import Times

README = "spiral-bevel-flank"
NAMED = ("hypoid-pinion-phoenix", "spiral-bevel-flank-conventional", "helical-internal", "gouge-free-form-dropped")
REPEATS = {"small": 3, "large": 5}
_MEASURES: dict[str, Callable[[Usage], float]] = {
    "seconds": lambda u: u.seconds,
    "CPU s": lambda u: u.cpu_s,
    "MB": lambda u: 1e-6 * u.together,
    "MB, largest": lambda u: 1e-6 * u.largest,
}
_ADDED = ("seconds", "CPU s")
_WHO = ("this", "other")
_COLUMNS = ("case", "build", "runs", "exit", "spread", *_MEASURES)
_NOTES = (
    "gearsim run SCENE by the installed command, all files written, from start to exit; medians, spread: (slowest - "
    "fastest)/median of the seconds. Builds take turns. cold kernels: Warp's cache is empty; all else is warm: a run "
    "that compiled is made again. CPU s: all processes of a run. other / this: above 1 this build is better.",
    "MB: the most that the processes of a run (drawing has its own) hold at one time, pages that they share counted in "
    "each; MB, largest: the peak of the one that holds most.",
)


def scenes(device: str, size: str, against: Path | None = None) -> dict[str, Any]:
    """Scenes as a user runs them: wall and CPU time, peak memory; with --against VENV another build beside.

    ``size`` large runs all scenes, small the README's and four others. Raises InputError where ``against`` holds no
    build, NumericalError where a run leaves no report.
    """
    with TemporaryDirectory() as scratch:
        builds = _builds(Path(scratch), against)
        known = [build.scenes() for build in builds]
        asked = known[0] if size == "large" else NAMED
        common = [scene for scene in asked if all(scene in names for names in known)]
        cold = _turns(builds, REPEATS[size], partial(_cold, device))
        warm = _turns(builds, REPEATS[size], partial(_warm, device, README))
        first = _case("README's first command, warm", warm)
        others = [_case(s, _turns(builds, 1, partial(_warm, device, s))) for s in common if s != README]
        cases = [first, _case("README's first command, cold kernels", cold), *others]
        if size == "large":
            cases.append(_one_after_another([first, *others]))
        notes = [*_NOTES, *_about(builds, [scene for scene in asked if scene not in common])]
    return {"columns": list(_COLUMNS), "rows": [row for case in cases for row in case], "notes": notes}


def _builds(scratch: Path, against: Path | None) -> list[Build]:
    folders = [scratch / name for name in _WHO]
    for folder in folders:
        folder.mkdir()
    return [this_build(folders[0])] + ([build_in(against, folders[1])] if against else [])


def _turns(builds: Sequence[Build], repeats: int, run: Callable[[Build], Usage]) -> list[list[Usage]]:
    """Runs of each build, the builds taking turns and leading in turn, so that nothing favours one."""
    usages: list[list[Usage]] = [[] for _ in builds]
    places = list(range(len(builds)))
    for _ in range(repeats):
        for i in places:
            usages[i].append(run(builds[i]))
        places.reverse()
    return usages


def _cold(device: str, build: Build) -> Usage:
    kernels = _kernels(build)
    shutil.rmtree(kernels, ignore_errors=True)
    return build.run(README, device, kernels).usage


def _warm(device: str, scene: str, build: Build) -> Usage:
    """A run that compiles nothing: one that had to is made again."""
    kernels = _kernels(build)
    before = _modules(kernels)
    run = build.run(scene, device, kernels)
    return run.usage if _modules(kernels) == before else build.run(scene, device, kernels).usage


def _kernels(build: Build) -> Path:
    return build.folder / "kernels"


def _modules(kernels: Path) -> set[Path]:
    return set(kernels.rglob("wp_*"))


def _case(case: str, usages: Sequence[Sequence[Usage]]) -> list[dict[str, Any]]:
    """A row for each build, the medians of its runs, and the ratio."""
    rows = []
    for who, of in zip(_WHO, usages, strict=False):
        times = Times(tuple(u.seconds for u in of))
        codes = ",".join(str(code) for code in sorted({u.exit_code for u in of}))
        told = {"case": case, "build": who, "runs": len(of), "exit": codes, "spread": times.spread}
        medians = {name: median(map(measure, of)) for name, measure in _MEASURES.items()}
        rows.append({**told, **medians, "all seconds": times.all, "all CPU s": [u.cpu_s for u in of]})
    return rows + _ratio(rows)


def _ratio(rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """The other build's figures over this one's, where there are two."""
    if len(rows) < 2:
        return []
    this, other = rows
    ratios = {name: other[name] / this[name] for name in _MEASURES}
    return [{**dict.fromkeys(_COLUMNS, "-"), "case": this["case"], "build": "other / this", **ratios}]


def _one_after_another(cases: Sequence[Sequence[dict[str, Any]]]) -> list[dict[str, Any]]:
    """All scenes: times added, peaks of memory the highest."""
    rows = []
    for same in zip(*(case[: len(_WHO)] for case in cases), strict=True):
        figures = {name: (sum if name in _ADDED else max)(row[name] for row in same) for name in _MEASURES}
        told = {"case": f"all {len(same)} scenes one after another", "build": same[0]["build"], "runs": 1}
        rows.append({**dict.fromkeys(_COLUMNS, "-"), **told, **figures})
    return rows + _ratio(rows)


def _about(builds: Sequence[Build], missing: Sequence[str]) -> list[str]:
    lines = [
        f"{who}: {build.version()} in {build.gearsim.parent.parent}" for who, build in zip(_WHO, builds, strict=False)
    ]
    return lines + ([f"left out, not in both builds: {', '.join(missing)}"] if missing else [])
