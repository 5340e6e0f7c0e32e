"""samples.parquet: every dense sample of every surface, one row each; what does not exist is null."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.exr import stated
from gearsim.result import Result


def write_parquet(tables: list[dict[str, NDArray[Any]]], result: Result, file: Path) -> None:
    """Write samples, one table of flat columns a surface, with what the file states in its metadata.

    A column that a table lacks is null in its rows, as is every nan.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    names = list(dict.fromkeys(name for table in tables for name in table))
    parts = [pa.table({name: _column(table, name) for name in names if name in table}) for table in tables]
    notes = {**stated(result), "version": result.versions["gearsim"]}
    whole = pa.concat_tables(parts, promote_options="default").select(names)
    pq.write_table(whole.replace_schema_metadata({f"gearsim.{k}": v for k, v in notes.items()}), file)


def _column(table: dict[str, NDArray[Any]], name: str) -> Any:
    import pyarrow as pa

    values = np.ravel(table[name])
    return pa.array(values, mask=np.isnan(values) if values.dtype.kind == "f" else None)
