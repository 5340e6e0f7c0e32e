"""Faces of IGES and STEP files, and triangles of solids, by Open CASCADE (the extra ``cad``).

It runs in a process of its own (`cad_reader.py`, `cad_mesher.py`): a file that crashes it costs a message, not the
session.
"""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError, read_input_bytes
from gearsim.surfaces.cad_text import check_iges, check_step, clean, without_blank_lines

STEP_SUFFIXES = (".stp", ".step")
CAD_SUFFIXES = (".igs", ".iges", *STEP_SUFFIXES)
_LIMIT_S = 600.0


def read_cad(file: Path) -> dict[str, Any]:
    """All faces, in mm: ``faces`` with ``surface`` (as `surfaces.nurbs_file` writes it), ``loops``, ``solid``.

    Surfaces other than B-splines are converted exactly over the face's range of parameters; a boundary curve of such
    a face has its points beside its old parameters. ``flip`` follows the face's orientation. ``skipped`` are pairs of
    names and reasons. Raises InputError for a file of which nothing can be used.
    """
    return _read_apart(file, _checked(file, "give the control net as JSON (gearsim.surfaces.nurbs_file)"))


def mesh_step(file: Path, chord: float) -> dict[str, NDArray]:
    """The triangles of a STEP file's solids, in mm: ``corners`` (m, 3, 3), and ``chord`` [mm], how far their middles
    and those of their edges are off the true surface at most; no farther than it is asked for.

    Raises InputError for another file, one that holds no solid, or where the chord is not reached.
    """
    if file.suffix.lower() not in STEP_SUFFIXES:
        raise InputError(f"{file}: a solid is read from {', '.join(STEP_SUFFIXES)}")
    reader = Path(__file__).with_name("cad_mesher.py")
    data = _run_apart(file, _checked(file, "give the solid as STL"), reader, ".npz", repr(chord))
    with np.load(BytesIO(data), allow_pickle=False) as found:
        return dict(found)


def _checked(file: Path, instead: str) -> str:
    """The text of a file that Open CASCADE may read; ``instead`` is what to do where it is not there."""
    text = clean(read_input_bytes(file, "CAD file"))
    if file.suffix.lower() in STEP_SUFFIXES:
        check_step(text, str(file))
    else:
        check_iges(text, str(file))
        text = without_blank_lines(text)
    if find_spec("OCP") is None:
        raise InputError(
            f"reading {file} needs Open CASCADE: install gearsim[cad] (cadquery-ocp-novtk, 380 MB), or {instead}"
        )
    return text


def _read_apart(file: Path, text: str) -> dict[str, Any]:
    data = _run_apart(file, text, Path(__file__).with_name("cad_reader.py"), ".json")
    found: dict[str, Any] = json.loads(data.decode("utf-8"))
    return found


def _run_apart(file: Path, text: str, reader: Path, suffix: str, *options: str) -> bytes:
    """What a reader writes of a file's text, run in a process of its own."""
    with TemporaryDirectory() as folder:
        out, copy = Path(folder) / f"out{suffix}", Path(folder) / f"file{file.suffix.lower()}"
        copy.write_bytes(text.encode("latin-1"))
        command = [sys.executable, "-P", str(reader), str(copy), str(out), *options]
        try:
            done = subprocess.run(command, capture_output=True, timeout=_LIMIT_S, check=False, cwd=folder)
        except subprocess.TimeoutExpired as error:
            raise InputError(f"cannot read {file}: no end after {_LIMIT_S:g} s") from error
        if done.returncode or not out.exists():
            said = done.stderr.decode("utf-8", "replace").strip().splitlines()
            why = said[-1] if done.returncode == 1 and said else "the file is damaged; Open CASCADE broke down on it"
            raise InputError(f"cannot read {file}: {why}")
        return out.read_bytes()
