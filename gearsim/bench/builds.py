"""Installed builds of gearsim, whose command runs scenes in processes of their own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from gearsim.bench.children import Usage, watched
from gearsim.errors import InputError, NumericalError


class SceneRun(NamedTuple):
    """One run of a scene: what it took, and the stages' times [s] as its report.json has them."""

    usage: Usage
    stages: dict[str, float]


class Build(NamedTuple):
    """A gearsim executable, with a folder for what its runs write."""

    gearsim: Path
    folder: Path

    def run(self, scene: str, device: str, kernels: Path) -> SceneRun:
        """Run a scene, all files written, ``kernels`` being Warp's cache.

        Out of tolerance is a result like any; raises NumericalError where the run left no report.
        """
        with TemporaryDirectory(dir=self.folder) as out:
            command = [str(self.gearsim), "run", scene, "--out", f"{out}/run", "--device", device]
            usage = watched(command, self.folder, _environment(WARP_CACHE_PATH=str(kernels)))
            report = Path(out) / "run" / "report.json"
            if not report.exists():
                raise NumericalError(
                    f"{self.gearsim} run {scene} ended with exit code {usage.exit_code}: {usage.said or 'no report'}"
                )
            return SceneRun(usage, json.loads(report.read_text(encoding="utf-8"))["timings_s"])

    def scenes(self) -> list[str]:
        """Names of its built-in scenes."""
        return [line.split()[0] for line in self._answer("scenes").splitlines() if line.strip()]

    def version(self) -> str:
        """What it calls itself."""
        return self._answer("--version").strip()

    def _answer(self, question: str) -> str:
        done = subprocess.run(
            [str(self.gearsim), question], cwd=self.folder, env=_environment(), capture_output=True, text=True
        )
        if done.returncode:
            raise NumericalError(f"{self.gearsim} {question} ended with exit code {done.returncode}: {done.stderr}")
        return done.stdout


def this_build(folder: Path) -> Build:
    """The build that is running."""
    return Build(Path(sys.executable).with_name("gearsim"), folder)


def build_in(venv: Path, folder: Path) -> Build:
    """The build installed in a virtual environment; raises InputError where there is none."""
    gearsim = venv.absolute() / "bin" / "gearsim"
    if not os.access(gearsim, os.X_OK):
        raise InputError(
            f"--against {venv}: no program bin/gearsim in it; give the folder of a virtual environment that another "
            "build is installed in"
        )
    return Build(gearsim, folder)


def _environment(**more: str) -> dict[str, str]:
    """Ours, without what would lead one build's Python to another's modules."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONPATH"} | more
