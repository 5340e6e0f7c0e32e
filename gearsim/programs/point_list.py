"""Point lists with normals, x y z nx ny nz, as CSV or Parquet: read and written.

What the numbers mean stands beside them: ``units`` (mm) and ``sign`` (out of the material, or into the material: the
way the normals point) are needed; ``axis``, ``flank`` and, for a grid in row-major order, ``rows`` and ``columns`` may
follow: in CSV as in `gearsim.programs.point_table`, in Parquet as ``gearsim.units`` and so on in the metadata.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError, read_input, written
from gearsim.programs.point_table import COLUMNS, KEYS, format_table, parse_table

AXIS = "z along the gear axis"
SIGNS = {"out of the material": 1.0, "into the material": -1.0}
_UNIT = 1e-3


@dataclass(frozen=True)
class PointList:
    """Points [mm] and unit normals out of the material, both shape (n, 3), workpiece frame.

    ``shape``: (rows, columns) of a grid in row-major order, None for scattered points.
    """

    point: NDArray[np.floating]
    normal: NDArray[np.floating]
    flank: str = ""
    axis: str = AXIS
    shape: tuple[int, int] | None = None

    def header(self) -> dict[str, str]:
        """The keys that say what the numbers mean."""
        grid = {} if self.shape is None else {"rows": str(self.shape[0]), "columns": str(self.shape[1])}
        return {"units": "mm", "axis": self.axis, "flank": self.flank, "sign": next(iter(SIGNS)), **grid}


def read_points(file: Path) -> PointList:
    """Read a point list, Parquet if its name ends so, else CSV.

    Raises InputError naming file, line and column for anything that cannot be used.
    """
    if file.suffix.lower() == ".parquet":
        return _from_parquet(file)
    return parse_points(read_input(file, "point list"), str(file))


def write_points(points: PointList, file: Path) -> None:
    """Write a point list, Parquet if the file's name ends so, else CSV; numbers keep all their digits.

    Raises InputError where the file cannot be written.
    """
    with written(file, "point list") as scratch:
        if file.suffix.lower() == ".parquet":
            _to_parquet(points, scratch)
        else:
            scratch.write_text(format_points(points), encoding="utf-8")


def format_points(points: PointList) -> str:
    """A point list as CSV text."""
    return format_table(np.hstack([points.point, points.normal]), points.header(), points.shape)


def parse_points(text: str, name: str) -> PointList:
    """A point list from CSV text; ``name`` stands in the messages."""
    values, header, places = parse_table(text, name)
    return _point_list(values, header, name, places)


def _point_list(values: NDArray, header: dict[str, str], name: str, places: list[str] | None = None) -> PointList:
    """A point list from its numbers, shape (n, 6); ``places`` say where each row stands in the file."""
    units, sign = header.get("units"), header.get("sign", "")
    if units != "mm":
        got = "no '# units: mm' in its header, no x_mm" if units is None else f"units {units!r}"
        raise InputError(f"{name}: {got}; point lists are read in mm")
    if sign not in SIGNS:
        got = f"sign {sign!r}" if sign else "no column sign and no '# sign:' in its header"
        raise InputError(f"{name}: {got}; it says where the normals point: {' or '.join(map(repr, SIGNS))}")
    if not len(values):
        raise InputError(f"{name}: no points; expected lines of six numbers: {', '.join(COLUMNS)}")
    length = np.linalg.norm(values[:, 3:], axis=1)
    bad, off = np.argwhere(~np.isfinite(values)), np.flatnonzero(np.abs(length - 1.0) > _UNIT)
    if len(bad):
        row, column = map(int, bad[0])
        place = places[row] if places else f"row {row + 1}"
        raise InputError(
            f"{name}, {place}, column {column + 1} ({COLUMNS[column]}): {values[row, column]} is not a finite number"
        )
    if len(off):
        row = int(off[0])
        place = places[row] if places else f"row {row + 1}"
        raise InputError(f"{name}, {place}, columns 4 to 6: the normal has length {length[row]:.6g}; expected 1")
    normal = SIGNS[sign] * values[:, 3:] / length[:, None]
    shape = _shape(header, len(values), name)
    return PointList(values[:, :3], normal, header.get("flank", ""), header.get("axis", AXIS), shape)


def _shape(header: dict[str, str], count: int, name: str) -> tuple[int, int] | None:
    if not {"rows", "columns"} & set(header):
        return None
    try:
        rows, columns = int(header["rows"]), int(header["columns"])
    except (KeyError, ValueError):
        raise InputError(f"{name}: a grid needs whole numbers for both '# rows:' and '# columns:'") from None
    if rows * columns != count:
        raise InputError(f"{name}: {rows} rows of {columns} columns are {rows * columns} points; it holds {count}")
    return rows, columns


def _to_parquet(points: PointList, file: Path) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    units = {name: {"unit": "mm"} if name.endswith("_mm") else None for name in COLUMNS}
    fields = [pa.field(name, pa.float64(), metadata=units[name]) for name in COLUMNS]
    schema = pa.schema(fields, {f"gearsim.{k}": v for k, v in points.header().items()})
    pq.write_table(pa.table(list(np.hstack([points.point, points.normal]).T), schema=schema), file)


def _from_parquet(file: Path) -> PointList:
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        table = pq.read_table(file)
    except pa.ArrowInvalid as error:
        raise InputError(f"cannot read point list {file}: it is not a Parquet file") from error
    except OSError as error:
        raise InputError(f"cannot read point list {file}: {error.strerror or error}") from error
    missing = [c for c in COLUMNS if c not in table.column_names]
    if missing:
        raise InputError(f"{file}: no column {', '.join(missing)}; expected {', '.join(COLUMNS)}")
    columns = []
    for name in COLUMNS:
        try:
            columns.append(table.column(name).cast(pa.float64()).to_numpy())
        except (pa.ArrowInvalid, pa.ArrowNotImplementedError) as error:
            raise InputError(f"{file}, column {name}: it does not hold numbers") from error
    keys = {k.decode(): v.decode() for k, v in (table.schema.metadata or {}).items()}
    header = {k.removeprefix("gearsim."): v for k, v in keys.items() if k.removeprefix("gearsim.") in KEYS}
    return _point_list(np.column_stack(columns), header, str(file))
