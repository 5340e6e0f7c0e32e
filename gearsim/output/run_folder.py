"""What a run's folder holds, read back: the part's closed surface, its stock, the measured surfaces, the scene."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError, is_file, is_folder
from gearsim.geometry.triangles import TriangleMesh
from gearsim.output.files import LAST, PART, SAMPLES
from gearsim.output.meshes import points_of, triangles_of
from gearsim.output.solid_files import SolidSurface
from gearsim.output.window import read_mesh


@dataclass(frozen=True)
class MeasuredGrid:
    """A measured surface by its ``name``: ``point`` [mm] and unit outward ``normal`` of the intended one, shape (rows,
    columns, 3), and the ``deviation`` [mm] of the machined one along it, (rows, columns), nan where there is none.
    """

    name: str
    point: NDArray[np.floating]
    normal: NDArray[np.floating]
    deviation: NDArray[np.floating]

    @property
    def machined(self) -> NDArray:
        """The machined surface's points [mm], shape (rows, columns, 3)."""
        return np.asarray(self.point + self.deviation[..., None] * self.normal)


@dataclass(frozen=True)
class RunFolder:
    """A run's ``folder``. Raises InputError where there is none, and its methods where a file is missing or no such."""

    folder: Path

    def __post_init__(self) -> None:
        if not is_folder(self.folder):
            raise InputError(f"{self.folder} is no run's folder; gearsim run writes one")

    def file(self, name: str, why: str) -> Path:
        """A file of the run."""
        if not is_file(self.folder / name):
            raise InputError(f"{self.folder} holds no {name}: {why}, or --only left it out")
        return self.folder / name

    def report(self) -> dict[str, Any]:
        """The run's figures."""
        file = self.file(LAST, "the run was not completed")
        try:
            told = json.loads(file.read_text(encoding="utf-8"))
            str(told["scene"]["scene"]["name"]), str(told["program"])
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise InputError(f"{file}: it is no report of a run ({error})") from error
        return dict(told)

    def part(self) -> SolidSurface:
        """The whole part's surface, its triangles with what made them."""
        from vtkmodules.util.numpy_support import vtk_to_numpy

        file = self.file(PART, "its scene has no [stock]")
        shape = read_mesh(file)
        cells, names = shape.GetCellData(), shape.GetFieldData().GetAbstractArray("gearsim.operations")
        if names is None or not (cells.HasArray("tag") and cells.HasArray("operation")):
            raise InputError(f"{file}: it is no surface of a whole part (no tag and operation of every cell)")
        tag, operation = (np.asarray(vtk_to_numpy(cells.GetArray(name))) for name in ("tag", "operation"))
        mesh = TriangleMesh(points_of(shape), triangles_of(shape), tag)
        return SolidSurface(mesh, operation, tuple(json.loads(names.GetValue(0))))

    def grids(self) -> list[MeasuredGrid]:
        """The surfaces measured on grids, under the whole program; none where there are no samples."""
        import pyarrow.parquet as pq

        if not is_file(self.folder / SAMPLES):
            return []
        value = f"{self.report()['program']}_um"
        names = ["surface", "row", "column", "x_mm", "y_mm", "z_mm", "nx", "ny", "nz", value]
        try:
            table = pq.read_table(self.folder / SAMPLES, columns=names)
            columns = {name: table.column(name).to_numpy(zero_copy_only=False) for name in names}
        except (OSError, ValueError, KeyError) as error:
            raise InputError(f"{self.folder / SAMPLES}: no samples under the whole program: {error}") from error
        return [_grid(columns, name, value) for name in dict.fromkeys(columns["surface"])]


def _grid(columns: dict[str, NDArray], name: str, value: str) -> MeasuredGrid:
    own = columns["surface"] == name
    row, column = (columns[k][own].astype(int) for k in ("row", "column"))
    shape = (int(row.max()) + 1, int(column.max()) + 1)
    grids = []
    for names in (("x_mm", "y_mm", "z_mm"), ("nx", "ny", "nz"), (value,)):
        grid = np.full((*shape, len(names)), np.nan)
        grid[row, column] = np.column_stack([columns[k][own].astype(float) for k in names])
        grids.append(grid)
    return MeasuredGrid(name, grids[0], grids[1], 1e-3 * grids[2][..., 0])
