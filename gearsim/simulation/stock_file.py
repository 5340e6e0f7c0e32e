"""Stock at rest in a file: Parquet, a row an interval, a row group a bundle; what is read back is bit-identical.

Version 1. Columns ``bundle`` (0, 1, 2: rays along the box's x, y, z), ``ray`` (its number in the bundle, of the two
other axes the first the slowest), ``lo_mm`` and ``hi_mm`` (along the ray, from the box's lower face), ``lo_tag`` and
``hi_tag`` (-1: an end of the blank; else the row that made it, counted through the operations done). The schema's
metadata hold under ``gearsim.stock`` as JSON: ``version``, ``unit`` (mm), ``frame`` (``rotation`` and ``translation``
from the box to the part), ``lower``, ``upper``, ``pitch``, ``done`` (of each operation ``name``, ``rows``,
``first_tag`` and whether it ``turned`` the blank; none says: no) and ``job``, whose stock it is: a name and a digest of
what was to be done.
"""

from __future__ import annotations

import json
import os
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError, written
from gearsim.geometry.rigid import Rigid
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.intervals import IntervalSet
from gearsim.simulation.stock import AXES, BLANK, Done, Stock

VERSION = 1
_KEY = b"gearsim.stock"
_SQUARE = 1e-9  # how far a frame's rotation may be off one
_COLUMNS = {"ray": np.int64, "lo_mm": np.float64, "hi_mm": np.float64, "lo_tag": np.int32, "hi_tag": np.int32}


def save_stock(stock: Stock, file: Path, job: str = "") -> None:
    """Write a stock; the file appears whole or not at all, and lasts once this returns.

    Raises InputError where the folder cannot be written, or the disk is full.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    box = stock.box
    told = {
        "version": VERSION,
        "unit": "mm",
        "frame": {k: getattr(box.frame, k).tolist() for k in ("rotation", "translation")},
        "lower": np.asarray(box.lower, float).tolist(),
        "upper": np.asarray(box.upper, float).tolist(),
        "pitch": box.pitch,
        "done": [asdict(d) for d in stock.done],
        "job": job,
    }
    fields = [pa.field("bundle", pa.int8()), *(pa.field(k, pa.from_numpy_dtype(t)) for k, t in _COLUMNS.items())]
    schema = pa.schema(fields, metadata={_KEY: json.dumps(told)})
    with written(file, "stock") as scratch:
        with pq.ParquetWriter(scratch, schema, compression="zstd") as writer:
            for axis, left in zip(AXES, stock.left, strict=True):
                columns = (left.ray, left.lo, left.hi, left.lo_segment, left.hi_segment)
                arrays = [np.asarray(c, t) for c, t in zip(columns, _COLUMNS.values(), strict=True)]
                table = pa.table([np.full(len(left.lo), axis, np.int8), *arrays], schema=schema)
                writer.write_table(table, row_group_size=max(1, len(left.lo)))
        with scratch.open("rb") as whole:
            os.fsync(whole.fileno())


def load_stock(file: Path) -> tuple[Stock, str]:
    """A stock and the job it belongs to, as they were saved.

    Raises InputError for a file that is none, of another version, or whose intervals cannot be.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        table = pq.read_table(file)
    except (OSError, pa.ArrowException) as error:
        raise InputError(f"stock file {file}: cannot be read: {error}") from error
    told = _told(file, table.schema.metadata or {})
    try:
        box = _box(told)
        done = tuple(
            Done(str(d["name"]), int(d["rows"]), int(d["first_tag"]), d.get("turned") is True) for d in told["done"]
        )
        bundle = _column(table, "bundle", np.int8)
        columns = {k: _column(table, k, t) for k, t in _COLUMNS.items()}
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(f"stock file {file}: {error} is missing or has another form; save it anew") from error
    if not np.isin(bundle, AXES).all():
        raise InputError(f"stock file {file}: bundles are {', '.join(map(str, np.unique(bundle)))}; expected 0, 1, 2")
    left = [_bundle(file, box, axis, {k: c[bundle == axis] for k, c in columns.items()}) for axis in AXES]
    stock = Stock(box, (left[0], left[1], left[2]), done)
    tags = np.concatenate([k for s in stock.left for k in (s.lo_segment, s.hi_segment)])
    highest = int(tags.max(initial=BLANK))
    if tags.min(initial=BLANK) < BLANK:
        raise InputError(f"stock file {file}: tag {tags.min()} is of no operation; the blank's is {BLANK}")
    if highest >= stock.next_tag:
        raise InputError(f"stock file {file}: tag {highest} is of no operation; the last one's is {stock.next_tag - 1}")
    return stock, str(told.get("job", ""))


def _told(file: Path, metadata: dict[bytes, bytes]) -> dict[str, Any]:
    if _KEY not in metadata:
        raise InputError(f"stock file {file}: no stock of gearsim (its schema has no {_KEY.decode()} metadata)")
    try:
        told = json.loads(metadata[_KEY])
    except ValueError as error:
        raise InputError(f"stock file {file}: its {_KEY.decode()} metadata are no JSON: {error}") from error
    version, unit = (told.get(k) if isinstance(told, dict) else None for k in ("version", "unit"))
    if version != VERSION:
        raise InputError(f"stock file {file}: version {version}; this gearsim reads version {VERSION}")
    if unit != "mm":
        raise InputError(f"stock file {file}: unit {unit}; expected mm")
    return dict(told)


def _box(told: dict[str, Any]) -> DexelBox:
    """The box of a file's metadata. Raises ValueError, and what reading plain values does."""
    frame = told["frame"]
    shapes = {"rotation": (3, 3), "translation": (3,), "lower": (3,), "upper": (3,), "pitch": ()}
    found = {k: np.array((frame if k in frame else told)[k], dtype=float) for k in shapes}
    for key, shape in shapes.items():
        if found[key].shape != shape or not np.isfinite(found[key]).all():
            raise ValueError(f"{key} = {found[key].tolist()}")
    rotation = found["rotation"]
    if not np.allclose(rotation @ rotation.T, np.eye(3), rtol=0.0, atol=_SQUARE):
        raise ValueError(f"rotation = {rotation.tolist()}")
    try:
        return DexelBox(Rigid(rotation, found["translation"]), found["lower"], found["upper"], float(found["pitch"]))
    except InputError as error:
        raise ValueError(f"its box ({error})") from error


def _column(table: Any, name: str, kind: type) -> NDArray:
    """A column of the form that it is written in. Raises ValueError for another."""
    column = table.column(name)
    if column.null_count or str(column.type) != np.dtype(kind).name.replace("float64", "double"):
        raise ValueError(f"column {name} of {column.type}")
    values: NDArray = column.to_numpy()
    return values


def _bundle(file: Path, box: DexelBox, axis: int, columns: dict[str, NDArray]) -> IntervalSet:
    ray, lo, hi = (columns[k] for k in ("ray", "lo_mm", "hi_mm"))
    count = int(np.delete(box.counts, axis).prod())
    same = ray[1:] == ray[:-1]
    rising = (hi > lo).all() and (ray[1:] >= ray[:-1]).all() and (lo[1:][same] >= hi[:-1][same]).all()
    length = float(box.upper[axis] - box.lower[axis])
    within = (lo >= 0.0).all() and (hi <= length).all()
    if not rising or not within or (len(ray) and not 0 <= ray[0] <= ray[-1] < count):
        raise InputError(
            f"stock file {file}: intervals of bundle {axis} must rise along rays 0 to {count - 1} without overlap, "
            f"from 0 to {length:g} mm"
        )
    first = np.concatenate([[0], np.cumsum(np.bincount(ray, minlength=count))])
    return IntervalSet(first, lo, hi, columns["lo_tag"], columns["hi_tag"])
