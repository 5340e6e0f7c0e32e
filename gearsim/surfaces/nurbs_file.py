"""Files of NURBS surfaces: control nets as JSON, read and written; IGES and STEP read (`surfaces.cad_file`).

A JSON file of control nets, in mm:

    {"units": "mm",
     "note": "what it is and where it comes from (may be left out)",
     "surfaces": [
       {"name": "bowl",                        may be left out
        "degree": [2, 1],                      of u and of v: the order less one
        "knots": [[0, 0, 0, 1, 1, 1],          of u: rows of points + degree + 1
                  [0, 0, 1, 1]],               of v: columns of points + degree + 1
        "points": [[[x, y, z], [x, y, z]],     one row for each step of u
                   [[x, y, z], [x, y, z]],
                   [[x, y, z], [x, y, z]]],
        "weights": [[1, 1], [1, 1], [1, 1]],   may be left out: all 1
        "flip": false}]}                       may be left out; false: r_u x r_v points out of the material
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from difflib import get_close_matches
from importlib.resources import files
from pathlib import Path
from typing import Any, NamedTuple

from gearsim.errors import InputError, is_file, read_input, written
from gearsim.surfaces.cad_file import CAD_SUFFIXES, read_cad
from gearsim.surfaces.face import Face, face_from_cad
from gearsim.surfaces.nurbs import NurbsSurface

_NEEDED = ("degree", "knots", "points")
_KNOWN = ("name", *_NEEDED, "weights", "flip")
_DOCUMENT = ("units", "note", "surfaces")


def surface_names() -> list[str]:
    """Names of the control nets shipped with gearsim."""
    folder = files("gearsim.scenes").joinpath("surfaces")
    return sorted(entry.name.removesuffix(".json") for entry in folder.iterdir() if entry.name.endswith(".json"))


class FaceFile(NamedTuple):
    """The faces of a file, by their numbers from 1; ``skipped``: what could not be read of it, with the reasons."""

    faces: dict[int, Face]
    skipped: tuple[str, ...]


def load_faces(name_or_path: str | Path) -> FaceFile:
    """The faces of a shipped control net or CAD file, by name, or of a file (JSON, IGES or STEP by its suffix).

    Faces of a CAD file that cannot be used are skipped and named. Raises InputError naming file and surface for
    anything else that cannot be used.
    """
    path = _beside_shipped(Path(name_or_path))
    if str(name_or_path) in surface_names() or path.suffix.lower() not in CAD_SUFFIXES:
        surfaces = _load_json(name_or_path)
        names = _distinct([s.name for s in surfaces])
        return FaceFile({k: Face(n, s) for k, (n, s) in enumerate(zip(names, surfaces, strict=True), 1)}, ())
    found = read_cad(path)
    skipped, faces = [": ".join(x for x in pair if x) for pair in found["skipped"]], {}
    for entry in found["faces"]:
        name = entry["surface"]["name"]
        try:
            surface = _surface(entry["surface"], f"{path}, {name}")
            faces[int(name.split()[-1])] = face_from_cad(entry, surface)
        except InputError as error:
            skipped.append(f"{name}: {str(error).removeprefix(f'{path}, {name}: ')}")
    if not faces:
        raise InputError(f"cannot read {path}: {'; '.join(skipped[:3])}")
    return FaceFile(faces, tuple(skipped))


def load_surfaces(name_or_path: str | Path) -> list[NurbsSurface]:
    """The surfaces of all faces, untrimmed. Raises InputError as `load_faces` and where a face was skipped."""
    return [face.surface for face in _all_faces(name_or_path).values()]


def load_untrimmed(name_or_path: str | Path) -> list[NurbsSurface]:
    """As `load_surfaces`, of faces that are their whole surfaces. Raises InputError for one that is a part of its."""
    found = _all_faces(name_or_path)
    for number, face in found.items():
        if face.loops and not face.is_whole:
            raise InputError(
                f"{name_or_path}, face {number}: its boundary leaves a part of its surface out; expected faces that "
                "reach to their surfaces' borders, split them there"
            )
    return [face.surface for face in found.values()]


def _all_faces(name_or_path: str | Path) -> dict[int, Face]:
    found = load_faces(name_or_path)
    if found.skipped:
        raise InputError(f"cannot read {name_or_path}: {'; '.join(found.skipped[:3])}")
    return found.faces


def _beside_shipped(path: Path) -> Path:
    """The CAD file shipped under a bare name, where there is none in the working directory."""
    if path.suffix.lower() in CAD_SUFFIXES and path.name == str(path) and not is_file(path):
        shipped = Path(str(files("gearsim.scenes").joinpath("surfaces", path.name)))
        return shipped if is_file(shipped) else path
    return path


def _load_json(name_or_path: str | Path) -> list[NurbsSurface]:
    if str(name_or_path) in surface_names():
        entry = files("gearsim.scenes").joinpath("surfaces", f"{name_or_path}.json")
        return parse_surfaces(entry.read_text("utf-8"), str(name_or_path))
    path = Path(name_or_path)
    if path.suffix.lower() == ".json" or is_file(path):
        return parse_surfaces(read_input(path, "control net").removeprefix("\ufeff"), str(path))
    near = get_close_matches(str(name_or_path), surface_names(), n=1, cutoff=0.4)
    hint = f"; did you mean {near[0]!r}?" if near else "."
    raise InputError(
        f"no surface named {str(name_or_path)!r}{hint} Built-in surfaces: {', '.join(surface_names())}. "
        f"Or give the path of a file: .json, {', '.join(CAD_SUFFIXES)}."
    )


def _distinct(names: list[str]) -> list[str]:
    """Names with a number behind those that stand twice."""
    return [n if names.count(n) == 1 else f"{n} {names[:k].count(n) + 1}" for k, n in enumerate(names)]


def parse_surfaces(text: str, name: str) -> list[NurbsSurface]:
    """Surfaces from the JSON text of control nets; ``name`` stands in the messages."""
    try:
        document = json.loads(text)
    except json.JSONDecodeError as error:
        raise InputError(f"{name}, line {error.lineno}, column {error.colno}: no JSON: {error.msg}") from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"{name}: no JSON that can be read: {error}") from error
    _check_keys(document, _DOCUMENT, ("units", "surfaces"), name)
    if document["units"] != "mm":
        raise InputError(f"{name}: units must be 'mm', got {document['units']!r}: scale the points first")
    if not isinstance(document["surfaces"], list) or not document["surfaces"]:
        raise InputError(f"{name}: 'surfaces' must be a list of at least one surface")
    return [_surface(entry, f"{name}, surface {n}") for n, entry in enumerate(document["surfaces"], 1)]


def format_surfaces(surfaces: Sequence[NurbsSurface], note: str = "") -> str:
    """Surfaces as JSON text; numbers keep all their digits, and each row of points has a line."""
    entries = []
    for s in surfaces:
        rows = [("points", s.points), ("weights", s.weights)]
        lines = [
            f'"name": {json.dumps(s.name)}',
            f'"degree": {json.dumps([s.degree_u, s.degree_v])}',
            f'"knots": {json.dumps([s.knots_u.tolist(), s.knots_v.tolist()])}',
            *(f'"{key}": [\n    {_ROW.join(map(json.dumps, table.tolist()))}\n   ]' for key, table in rows),
            f'"flip": {json.dumps(s.flip)}',
        ]
        entries.append("  {" + ",\n   ".join(lines) + "}")
    head = f'"note": {json.dumps(note)},\n ' if note else ""
    return f'{{"units": "mm",\n {head}"surfaces": [\n' + ",\n".join(entries) + "\n ]}\n"


_ROW = ",\n    "


def write_surfaces(surfaces: Sequence[NurbsSurface], file: Path, note: str = "") -> None:
    """Write control nets as JSON. Raises InputError where the file cannot be written."""
    with written(file, "control net") as scratch:
        scratch.write_text(format_surfaces(surfaces, note), encoding="utf-8")


def _surface(entry: Any, where: str) -> NurbsSurface:
    """A surface from its JSON object; ``where`` begins the messages."""
    _check_keys(entry, _KNOWN, _NEEDED, where)
    degree, knots = entry["degree"], entry["knots"]
    for key, pair in (("degree", degree), ("knots", knots)):
        if not isinstance(pair, list) or len(pair) != 2:
            raise InputError(f"{where}: {key!r} must be a list of two, for u and for v; got {_short(pair)}")
    if not all(type(d) is int for d in degree):
        raise InputError(f"{where}: 'degree' must be two whole numbers; got {_short(degree)}")
    if not isinstance(entry.get("flip", False), bool):
        raise InputError(f"{where}: 'flip' must be true or false; got {_short(entry['flip'])}")
    if not isinstance(entry.get("name", ""), str):
        raise InputError(f"{where}: 'name' must be text; got {_short(entry['name'])}")
    for key in ("knots", "points", "weights"):
        for strange in _strange(entry.get(key, 0)):
            raise InputError(f"{where}: {key!r} must be numbers in lists; got {_short(strange)}")
    options = {key: entry[key] for key in ("name", "weights", "flip") if key in entry}
    try:
        return NurbsSurface(degree[0], degree[1], knots[0], knots[1], entry["points"], **options)
    except InputError as error:
        raise InputError(f"{where}: {error}") from error


def _strange(value: Any, depth: int = 3) -> list[Any]:
    """The first that is no number in lists nested to a depth: text, truths, null, lists deeper still."""
    if isinstance(value, list) and depth:
        return next((found for v in value if (found := _strange(v, depth - 1))), [])
    return [] if isinstance(value, int | float) and not isinstance(value, bool) else [value]


def _check_keys(entry: Any, known: Sequence[str], needed: Sequence[str], where: str) -> None:
    if not isinstance(entry, dict):
        raise InputError(f"{where}: expected an object with the keys {', '.join(known)}; got {_short(entry)}")
    for key in entry:
        if key not in known:
            near = get_close_matches(key, known, n=1, cutoff=0.0)[0]
            raise InputError(f"{where}: unknown key {key!r}; the nearest known is {near!r}")
    missing = [key for key in needed if key not in entry]
    if missing:
        raise InputError(f"{where}: missing {', '.join(map(repr, missing))}")


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) < 60 else text[:57] + "..."
