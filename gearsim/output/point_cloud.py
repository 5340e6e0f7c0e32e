"""Ends of material as a point cloud: Parquet, CSV or PLY."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gearsim.errors import InputError, written
from gearsim.output.columns import Column, known
from gearsim.output.table import write_table
from gearsim.simulation.ends import Ends
from gearsim.simulation.stock import Stock


def write_points(ends: Ends, stock: Stock, file: Path) -> None:
    """Write a stock's ends, a row each, in the format that the file's name ends in: .parquet, .csv or .ply.

    Parquet and CSV hold the operations' names, PLY their numbers and the names as comments. Raises InputError for
    another ending, and where it cannot be written.
    """
    require_cloud(file)
    write = _WRITERS[file.suffix.lower()]
    with written(file, "points") as scratch:
        write(ends, stock, scratch)


def require_cloud(file: Path) -> None:
    """Raise InputError where a file's name ends in no format that a point cloud is written in."""
    if file.suffix.lower() not in _WRITERS:
        raise InputError(f"{file}: the name of a point cloud's file ends in {', '.join(_WRITERS)}")


def _columns(ends: Ends, stock: Stock) -> dict[str, Column]:
    operation = known(stock.operation_of(ends.tag))
    names = np.array([done.name for done in stock.done] + [""], dtype=object)
    out = {f"{k}_mm": Column(ends.point[:, i], f"{k} of the point") for i, k in enumerate("xyz")}
    out |= {f"normal_{k}": Column(ends.normal[:, i], f"{k} of the outward normal") for i, k in enumerate("xyz")}
    out |= {
        "bundle": Column(ends.bundle, "which axis of the box the point's ray runs along", _AXES),
        "tag": Column(known(ends.tag), "row that made it, counted through all operations; none: the blank itself"),
        "operation": Column(
            np.ma.masked_array(names[np.ma.getdata(operation)], np.ma.getmaskarray(operation)),
            "operation that made it; none: the blank itself",
        ),
    }
    return out


def _write_parquet(ends: Ends, stock: Stock, file: Path) -> None:
    write_table([_columns(ends, stock)], {"units": "mm", "frame": "that of the part"}, file)


def _write_csv(ends: Ends, stock: Stock, file: Path) -> None:
    """What does not exist is empty; numbers as they are, to the last digit."""
    import pyarrow as pa
    import pyarrow.csv

    columns = _columns(ends, stock)
    arrays = [pa.array(np.ma.getdata(c.values), mask=np.ma.getmaskarray(c.values)) for c in columns.values()]
    pyarrow.csv.write_csv(pa.table(arrays, names=list(columns)), file)


def _write_ply(ends: Ends, stock: Stock, file: Path) -> None:
    """Binary: float64 points and normals; -1: an end of the blank itself."""
    row = np.dtype([*((k, "<f8") for k in ("x", "y", "z", "nx", "ny", "nz")), ("tag", "<i4"), ("operation", "<i4")])
    rows = np.empty(len(ends.tag), dtype=row)
    for k, axis in enumerate("xyz"):
        rows[axis], rows[f"n{axis}"] = ends.point[:, k], ends.normal[:, k]
    rows["tag"], rows["operation"] = ends.tag, stock.operation_of(ends.tag)
    head = [
        "ply", "format binary_little_endian 1.0", "comment unit mm", "comment operation -1: the blank itself",
        *(f"comment operation {i}: {' '.join(done.name.split())}" for i, done in enumerate(stock.done)),
        f"element vertex {len(rows)}", *(f"property double {k}" for k in ("x", "y", "z", "nx", "ny", "nz")),
        "property int tag", "property int operation", "end_header",
    ]  # fmt: skip
    file.write_bytes("".join(f"{line}\n" for line in head).encode() + rows.tobytes())


_WRITERS = {".parquet": _write_parquet, ".csv": _write_csv, ".ply": _write_ply}
_AXES = {"0": "x", "1": "y", "2": "z"}
