"""Faces of IGES and STEP files, by Open CASCADE (the extra ``cad``).

It runs in a process of its own (`cad_reader.py`): a file that crashes it costs a message, not the session.
"""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from gearsim.errors import InputError, read_input_bytes
from gearsim.surfaces.cad_text import check_iges, check_step, clean, without_blank_lines

CAD_SUFFIXES = (".igs", ".iges", ".stp", ".step")
_LIMIT_S = 600.0


def read_cad(file: Path) -> dict[str, Any]:
    """All faces, in mm: ``faces`` with ``surface`` (as `surfaces.nurbs_file` writes it), ``loops``, ``solid``.

    Surfaces other than B-splines are converted exactly over the face's range of parameters; a boundary curve of such
    a face has its points beside its old parameters. ``flip`` follows the face's orientation. ``skipped`` are pairs of
    names and reasons. Raises InputError for a file of which nothing can be used.
    """
    text = clean(read_input_bytes(file, "CAD file"))
    if file.suffix.lower() in (".stp", ".step"):
        check_step(text, str(file))
    else:
        check_iges(text, str(file))
        text = without_blank_lines(text)
    if find_spec("OCP") is None:
        raise InputError(
            f"reading {file} needs Open CASCADE: install gearsim[cad] (cadquery-ocp-novtk, 380 MB), or give the "
            "control net as JSON (gearsim.surfaces.nurbs_file)"
        )
    return _read_apart(file, text)


def _read_apart(file: Path, text: str) -> dict[str, Any]:
    reader = Path(__file__).with_name("cad_reader.py")
    with TemporaryDirectory() as folder:
        out, copy = Path(folder) / "surfaces.json", Path(folder) / f"file{file.suffix.lower()}"
        copy.write_bytes(text.encode("latin-1"))
        command = [sys.executable, "-P", str(reader), str(copy), str(out)]
        try:
            done = subprocess.run(command, capture_output=True, timeout=_LIMIT_S, check=False, cwd=folder)
        except subprocess.TimeoutExpired as error:
            raise InputError(f"cannot read {file}: no end after {_LIMIT_S:g} s") from error
        if done.returncode or not out.exists():
            said = done.stderr.decode("utf-8", "replace").strip().splitlines()
            why = said[-1] if done.returncode == 1 and said else "the file is damaged; Open CASCADE broke down on it"
            raise InputError(f"cannot read {file}: {why}")
        found: dict[str, Any] = json.loads(out.read_text("utf-8"))
    return found
