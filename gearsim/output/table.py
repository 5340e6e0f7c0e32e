"""Tables as Parquet, samples of every surface before all, one row each; what does not exist is null."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.columns import Column, about
from gearsim.output.exr import stated
from gearsim.result import Result


def write_columns(tables: list[dict[str, Column]], result: Result, file: Path) -> None:
    """Write tables of a run, one below the other, with what its files state of it in the metadata."""
    write_table(tables, {**stated(result), "version": result.versions["gearsim"]}, file)


def write_table(tables: list[dict[str, Column]], notes: Mapping[str, str], file: Path) -> None:
    """Write tables of columns one below the other, with ``notes`` in the file's metadata under ``gearsim.``.

    A column that a table lacks is null in its rows, as is every number that is masked or not finite. Codes are words:
    a dictionary column opens as another kind of thing in each reader, and Parquet packs words as small. Unit, meaning
    and key stand in each column's own metadata, and all together as JSON under ``gearsim.columns`` in the file's, for
    readers that show no other.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    names = list(dict.fromkeys(name for table in tables for name in table))
    parts = [pa.Table.from_pydict({k: _values(table[k]) for k in names if k in table}) for table in tables]
    whole = pa.concat_tables(parts, promote_options="default").select(names)
    told = {name: about(name, _together([table for table in tables if name in table], name)) for name in names}
    notes = {**notes, "columns": json.dumps(told, ensure_ascii=False)}
    fields = [whole.schema.field(name).with_metadata(_texts(told[name])) for name in names]
    schema = pa.schema(fields, {f"gearsim.{k}": v for k, v in notes.items()})
    pq.write_table(pa.Table.from_arrays(whole.columns, schema=schema), file)


def _together(tables: list[dict[str, Column]], name: str) -> Column:
    """One column for what is said of it in several tables; its key goes by surface where surfaces differ."""
    first = tables[0][name]
    if all(table[name].key == first.key for table in tables):
        return first
    return first._replace(key={str(table["surface"].values.flat[0]): table[name].key for table in tables})


def _texts(told: dict[str, Any]) -> dict[str, str]:
    return {k: v if isinstance(v, str) else json.dumps(v, ensure_ascii=False) for k, v in told.items()}


def _values(column: Column) -> Any:
    """A column as Arrow keeps it. Made of its buffers: ``pyarrow.array`` loads pandas wherever that is installed."""
    import pyarrow as pa

    values = np.ma.getdata(column.values).ravel()
    there = ~np.ma.getmaskarray(column.values).ravel()
    if values.dtype.kind == "f":
        there = there & np.isfinite(values)
    valid = None if there.all() else _bits(there)
    if values.dtype.kind in "UO":  # words
        words = [word.encode() for word in np.where(there, values, "").tolist()]
        ends = np.cumsum([0, *map(len, words)], dtype=np.int32)
        return pa.StringArray.from_buffers(len(words), pa.py_buffer(ends), pa.py_buffer(b"".join(words)), valid)
    data = _bits(values) if values.dtype.kind == "b" else pa.py_buffer(np.ascontiguousarray(values))
    return pa.Array.from_buffers(pa.from_numpy_dtype(values.dtype), len(values), [valid, data])


def _bits(values: NDArray[np.bool_]) -> Any:
    import pyarrow as pa

    return pa.py_buffer(np.packbits(values, bitorder="little"))
