"""study.json: a Study as plain JSON, read back as it was; how two differ; what its jobs' results depend on."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from importlib.util import find_spec
from math import isnan, nan
from pathlib import Path
from typing import Any

from gearsim import __version__
from gearsim.errors import InputError, is_file, read_input
from gearsim.studies.records import Asked, Parameter, Study
from gearsim.studies.writing import sha256, sha256_of

SCHEMA_VERSION = 1
_KIND = "gearsim study"
_SAYS_NOTHING_OF_JOBS = ("summary", "folder", "source", "gearsim", "sources")


def as_json(study: Study) -> bytes:
    """A study with the version and the checksum of the sources that compute it; a line a key and a parameter."""
    head = {
        "kind": _KIND, "schema_version": SCHEMA_VERSION, "gearsim": __version__, "sources": sources(),
        "name": study.name, "summary": study.summary, "method": study.method, "seed": study.seed,
        "chunk": study.chunk, "measure": study.asked.measure, "cross_checked": study.asked.cross_checked,
        "folder": str(study.folder.absolute()), "source": study.source, "tables": study.tables,
    }  # fmt: skip
    lines = [f'"{key}": {_text(value)}' for key, value in head.items()]
    parameters = [
        {"key": p.key, "lower": _bound(p.lower), "upper": _bound(p.upper), "values": p.values} for p in study.parameters
    ]
    lines.append('"parameters": [' + ",".join("\n " + _text(p) for p in parameters) + "]")
    return ("{\n" + ",\n".join(lines) + "\n}\n").encode()


def read_study_file(file: Path) -> tuple[Study, dict[str, Any]]:
    """A study and its plain values. Raises InputError where the file is missing or tells of no study."""
    try:
        told = json.loads(read_input(file, "study"))
        if told["kind"] != _KIND or told["schema_version"] != SCHEMA_VERSION:
            raise ValueError(f"expected a {_KIND} of schema_version {SCHEMA_VERSION}")
        parameters = tuple(
            Parameter(p["key"], tuple(p["values"]), _unbound(p["lower"]), _unbound(p["upper"]))
            for p in told["parameters"]
        )
        return Study(
            told["name"], told["summary"], told["tables"], Path(told["folder"]), parameters, told["method"],
            told["seed"], Asked(tuple(told["measure"]), told["cross_checked"]), told["chunk"], told["source"],
        ), told  # fmt: skip
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"{file}: it is no study ({error})") from error


def differences(told: Mapping[str, Any], other: Mapping[str, Any]) -> list[str]:
    """Where two studies' plain values lead to other jobs or other files: dotted names, with both values if short."""
    out = []
    for key in dict.fromkeys([*told, *other]):
        if key not in (*_SAYS_NOTHING_OF_JOBS, "parameters"):
            out += list(unequal(key, told.get(key), other.get(key)))
    mine, theirs = ({p["key"]: p for p in t["parameters"]} for t in (told, other))
    for key in dict.fromkeys([*mine, *theirs]):
        if key not in mine or key not in theirs:
            out.append(f"{key} is varied in one alone")
        elif _text(mine[key]) != _text(theirs[key]):
            out.append(f"the values of {key}")
    return out


def unequal(name: str, one: Any, other: Any) -> Iterator[str]:
    """Where nested plain values differ: dotted names, with both values if short; the name ``tables`` goes unsaid."""
    if isinstance(one, dict) and isinstance(other, dict):
        for key in dict.fromkeys([*one, *other]):
            yield from unequal(f"{name}.{key}" if name != "tables" else key, one.get(key), other.get(key))
    elif _text(one) != _text(other):
        short = len(_text(one)) + len(_text(other)) < 60
        yield f"{name} ({_text(one)} there, {_text(other)} here)" if short else name


class Digests:
    """Of every chunk what its results depend on: scene, the files it names, values, what is asked, the sources."""

    def __init__(self, study: Study) -> None:
        self._study, self._cross_checked = study, study.cross_checked
        hashed = cache(lambda name: _content(study.folder, name))
        self._hashed: Callable[[str], str] = hashed
        files = {name: hashed(name) for name in _strings(study.tables) if hashed(name)}
        self._all = sha256(_text([__version__, sources(), study.tables, files, study.asked.measure], True).encode())

    def of(self, chunk: int) -> str:
        """16 hexadecimal digits."""
        jobs = self._study.jobs_of(chunk)
        values = {p.key: p.values[jobs.start : jobs.stop] for p in self._study.parameters}
        files = {v: self._hashed(v) for row in values.values() for v in set(row) if isinstance(v, str)}
        both = self._cross_checked[jobs.start : jobs.stop].tolist()
        return sha256(_text([self._all, jobs.start, jobs.stop, values, files, both], True).encode())[:16]


@cache
def sources() -> str:
    """The checksum of gearsim's own files, kernels and shipped scenes with them: other code, other results."""
    told = []
    for package in ("gearsim", "gearsim.kernels", "gearsim.scenes"):
        for folder in _places(package):
            kept = (f for f in sorted(folder.rglob("*")) if f.suffix in (".py", ".toml", ".json", ".step"))
            told += [(package, f.relative_to(folder).as_posix(), sha256_of(f)) for f in kept]
    return sha256(_text(sorted(told)).encode())[:16]


def _places(package: str) -> Sequence[Path]:
    """A package's folders, found without running it."""
    found = find_spec(package)
    return [Path(p) for p in (found.submodule_search_locations or [])] if found else []


def _content(folder: Path, name: str) -> str:
    return sha256_of(folder / name) if name and is_file(folder / name) else ""


def _strings(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping | list | tuple):
        for item in value.values() if isinstance(value, Mapping) else value:
            yield from _strings(item)


def _text(value: Any, ordered: bool = False) -> str:
    """JSON; numbers of NumPy are plain ones."""
    return json.dumps(value, ensure_ascii=False, sort_keys=ordered, default=lambda x: x.item())


def _bound(x: float) -> float | None:
    return None if isnan(x) else x


def _unbound(x: float | None) -> float:
    return nan if x is None else x
