"""B-spline surfaces of IGES and STEP files, by Open CASCADE (the extra ``cad``).

It runs in a process of its own (`cad_reader.py`): a file that crashes it costs a message, not the session.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from gearsim.errors import InputError

CAD_SUFFIXES = (".igs", ".iges", ".stp", ".step")
_LIMIT_S = 600.0
_SECTIONS = "SGDPT"
_NUMBER = re.compile(r"([+-]?(\d+\.?\d*|\.\d+)([EeDd][+-]?\d+)?)?")


def read_cad(file: Path) -> list[dict[str, Any]]:
    """The surfaces of all faces, in mm, as JSON objects of `surfaces.nurbs_file`.

    Faces on B-spline surfaces give the whole surface, without their trimming curves; other kinds are converted
    exactly over the face's range of parameters. ``flip`` follows the face's orientation. Raises InputError.
    """
    try:
        data = file.read_bytes()
    except OSError as error:
        raise InputError(f"cannot read {file}: {error.strerror}") from error
    check = _check_step if file.suffix.lower() in (".stp", ".step") else _check_iges
    check(data.decode("latin-1"), str(file))
    if find_spec("OCP") is None:
        raise InputError(
            f"reading {file} needs Open CASCADE: install gearsim[cad] (cadquery-ocp-novtk, 380 MB), or give the "
            "control net as JSON (gearsim.surfaces.nurbs_file)"
        )
    return _read_apart(file)


def _read_apart(file: Path) -> list[dict[str, Any]]:
    reader = Path(__file__).with_name("cad_reader.py")
    with TemporaryDirectory() as folder:
        out = Path(folder) / "surfaces.json"
        command = [sys.executable, "-P", str(reader), str(file.resolve()), str(out)]
        try:
            done = subprocess.run(command, capture_output=True, timeout=_LIMIT_S, check=False, cwd=folder)
        except subprocess.TimeoutExpired as error:
            raise InputError(f"cannot read {file}: no end after {_LIMIT_S:g} s") from error
        if done.returncode or not out.exists():
            said = done.stderr.decode("utf-8", "replace").strip().splitlines()
            why = said[-1] if done.returncode == 1 and said else "the file is damaged; Open CASCADE broke down on it"
            raise InputError(f"cannot read {file}: {why}")
        surfaces: list[dict[str, Any]] = json.loads(out.read_text("utf-8"))
    return surfaces


def _check_iges(text: str, name: str) -> None:
    """80 columns, sections in order, and at least one entry in the directory."""
    lines = text.splitlines()
    order = -1
    for number, line in enumerate(lines, 1):
        letter = line[72:73]
        if len(line.rstrip()) > 80 or letter not in _SECTIONS or not letter:
            raise InputError(
                f"{name}, line {number}: no IGES in fixed ASCII format, whose lines have 80 columns with one of "
                f"S, G, D, P, T in column 73; got {line[:80].strip()[:40]!r}"
            )
        if _SECTIONS.index(letter) < order:
            raise InputError(f"{name}, line {number}: section {letter} stands after {_SECTIONS[order]}")
        order = _SECTIONS.index(letter)
    if order != len(_SECTIONS) - 1:
        raise InputError(f"{name}: the file ends after line {len(lines)} without its T section: it is cut off")
    if not any(line[72] == "D" for line in lines):
        raise InputError(f"{name}: no entities; expected B-spline surfaces (entity 128)")
    _check_numbers(lines, name)


def _check_numbers(lines: list[str], name: str) -> None:
    """Numbers only in entity 128, written as IGES wants them: Open CASCADE takes others for 0."""
    head = "".join(line[:72] for line in lines if line[72] == "G")
    first = re.match(r"1H(.)\1(?:1H(.))?", head)
    comma, end = (first[1], first[2] or ";") if first else (",", ";")
    pointer, wanted = "", False
    for number, line in enumerate(lines, 1):
        if line[72] != "P":
            continue
        if line[64:72] != pointer:
            pointer, wanted = line[64:72], line.split(comma)[0].strip() == "128"
        values, *rest = line[:64].split(end)
        for value in values.split(comma) if wanted else []:
            if not _NUMBER.fullmatch(value.strip()):
                raise InputError(f"{name}, line {number}: entity 128 wants numbers, got {value.strip()!r}")
        wanted = wanted and not rest


def _check_step(text: str, name: str) -> None:
    if not text.lstrip().startswith("ISO-10303-21;"):
        raise InputError(f"{name}, line 1: no STEP file, which begins with ISO-10303-21; got {text[:40]!r}")
    if not re.search(r"END-ISO-10303-21\s*;\s*$", text):
        raise InputError(f"{name}: the file ends without END-ISO-10303-21; it is cut off")
