"""What ``gearsim gouge`` is asked to look at: faces of a file, a catalogue of mills."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError, read_input
from gearsim.gouging.check import Asked
from gearsim.gouging.standard_mills import khan_mills, metric_mills, ranked
from gearsim.gouging.verdict import some
from gearsim.surfaces.face import Face
from gearsim.surfaces.nurbs_file import load_faces


def read_faces(name_or_path: str, number: int | None = None, flip: Sequence[str] | None = None) -> Asked:
    """The faces of a file or of a shipped net: all, or one by its number; ``flip`` turns some by name, or all ([])."""
    found = load_faces(name_or_path)
    if number is not None and number not in found.faces:
        lost = [s for s in found.skipped if s.startswith(f"face {number}:")]
        why = f"; skipped: {lost[0]}" if lost else ""
        raise InputError(f"--number {number}: {name_or_path} holds {len(found.faces)} surface(s){why}")
    faces = _flipped(list(found.faces.values()), flip)
    assumed = [f.name for f in faces if f.side == "assumed"]
    chosen = faces if number is None else [faces[list(found.faces).index(number)]]
    notes = []
    mine = [f.name for f in chosen if f.side == "assumed"]
    if mine:
        turned = "as --flip turns it" if flip is not None else "behind the normal that the file's parameters give"
        notes.append(
            f"the material side of {some(mine)} is assumed, {turned}: the file has no solid there. "
            "--flip turns all faces, --flip NAME one"
        )
    name = chosen[0].name if len(faces) == 1 and not assumed and chosen[0].side == "stated" else str(name_or_path)
    return Asked(name, tuple(chosen), found.skipped, len(faces) - len(chosen), tuple(notes))


def _flipped(faces: list[Face], names: Sequence[str] | None) -> list[Face]:
    if names is None:
        return faces
    known = [f.name for f in faces]
    for name in names:
        if name not in known:
            near = get_close_matches(name, known, n=1, cutoff=0.0)[0]
            raise InputError(f"--flip {name!r}: no such face; the nearest is {near!r}")
    return [
        replace(f, surface=replace(f.surface, flip=not f.surface.flip)) if not names or f.name in names else f
        for f in faces
    ]


def read_mills(name_or_path: str) -> NDArray:
    """A catalogue of end mills (R, r) [mm]: ``khan``, ``metric``, or a file with R and r in every line."""
    if name_or_path in ("khan", "metric"):
        return khan_mills() if name_or_path == "khan" else metric_mills()
    mills: list[list[float]] = []
    for number, line in enumerate(read_input(Path(name_or_path), "catalogue").splitlines(), 1):
        words = line.partition("#")[0].replace(",", " ").replace(";", " ").split()
        if not words or (not mills and not _is_number(words[0])):
            continue
        pair = [_number(w) for w in words]
        if len(pair) != 2 or not 0.0 <= pair[1] <= pair[0] or not pair[0] > 0.0:
            raise InputError(
                f"{name_or_path}, line {number}: expected shank radius R and corner radius r in mm with "
                f"0 <= r <= R, got {line.strip()!r}"
            )
        mills.append(pair)
    if not mills:
        raise InputError(f"{name_or_path}: no mills in this catalogue; each line holds R and r in mm, like 10, 2")
    return ranked(np.array(mills))


def _number(text: str) -> float:
    return float(text) if _is_number(text) else float("nan")


def _is_number(text: str) -> bool:
    try:
        return bool(np.isfinite(float(text)))
    except ValueError:
        return False
