"""Fetches and runs Debian's linuxcnc-uspace: its stand-alone interpreter prints canonical machining functions."""

from __future__ import annotations

import os
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

from tests.peers.linuxcnc.control import Control

VERSION = "2.9.0~pre1+git20230208.f1270d6ed7-1+deb12u2"
PACKAGES = (f"linuxcnc-uspace={VERSION}", "libboost-python1.74.0", "libpython3.11", "libedit2")


@dataclass(frozen=True)
class Answer:
    """What the peer said to one program: its canonical calls, and its error (empty: none)."""

    calls: list[str]
    error: str


def fetch(folder: Path) -> Path:
    """The interpreter's folder, unpacked there if it is not: 22 MB to load, without the 1.4 GB it depends on."""
    binary = folder / "usr/bin/rs274-nine"
    if not binary.exists():
        folder.mkdir(parents=True, exist_ok=True)
        subprocess.run(["apt-get", "download", *PACKAGES], cwd=folder, check=True)
        for package in folder.glob("*.deb"):
            subprocess.run(["dpkg", "-x", package, folder], check=True)
        # Nine decimals instead of four: the formats have the same length, nothing else changes.
        binary.write_bytes((folder / "usr/bin/rs274").read_bytes().replace(b"%.4f", b"%.9f"))
        binary.chmod(0o755)
    return folder


class Peer:
    """The interpreter in ``folder``; ``work`` is for its files."""

    def __init__(self, folder: Path, work: Path):
        self.binary, self.work = fetch(folder) / "usr/bin/rs274-nine", work
        places = [str(folder / "usr/lib"), str(folder / "usr/lib/x86_64-linux-gnu")]
        # The peer keeps its tool table in a file at home, which a second one beside it would change.
        self.environment = {**os.environ, "LD_LIBRARY_PATH": ":".join(places), "HOME": str(work)}

    def run(self, program: str, control: Control) -> Answer:
        """Run a program."""
        files = {"p.ngc": program, "p.var": control.parameter_file(), "p.tbl": control.tool_table()}
        for name, text in files.items():
            (self.work / name).write_bytes(text.encode("latin-1"))
        (self.work / "p.out").unlink(missing_ok=True)
        command = [self.binary, "-g", "-v", "p.var", "-t", "p.tbl", *(["-b"] if control.block_delete else [])]
        try:
            done = subprocess.run(
                [*command, "p.ngc", "p.out"], cwd=self.work, env=self.environment, capture_output=True, timeout=5
            )
        except subprocess.TimeoutExpired:
            return Answer([], "the program does not end")
        output = self.work / "p.out"
        calls = output.read_bytes().decode("latin-1").splitlines() if output.exists() else []
        told = done.stderr.decode("latin-1").replace("executing\n", "", 1).strip()
        return Answer(list(filter(None, map(_call, calls))), (told or "no reason given") if done.returncode else "")


def _call(line: str) -> str:
    found = re.match(r"\s*\d+ N[\d.]*\s*(?=[A-Z])(.*)", line)
    return found[1] if found else ""
