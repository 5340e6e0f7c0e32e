"""Kinds of [stock.blank] that come from a file."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import Field

from gearsim.scene.outline import Coordinate
from gearsim.scene.tables import Length, Table
from gearsim.surfaces.solid_file import SolidFile, read_solid

_OF_THE_PITCH = 0.02


class SolidFileTable(Table):
    """Table [stock.blank] of kind ``solid-file``: a closed body from STL, or from STEP with the extra ``cad``.

    STL names no unit: mm are assumed, else ``scale`` says how many one unit is. STEP says its unit; its surfaces become
    triangles no farther than ``chord_mm`` off them (default: a fiftieth of the pitch). ``at_mm`` moves the body.
    """

    kind: Literal["solid-file"]
    file: str = Field(min_length=1)
    scale: Length | None = None
    chord_mm: Length | None = None
    at_mm: tuple[Coordinate, Coordinate, Coordinate] = (0.0, 0.0, 0.0)

    def read(self, folder: Path, pitch: float) -> SolidFile:
        """The body; relative files are looked up in ``folder``. Raises InputError where the file holds none."""
        chord = _OF_THE_PITCH * pitch if self.chord_mm is None else self.chord_mm
        return read_solid(folder / self.file, chord, self.scale, np.array(self.at_mm))


class SavedTable(Table):
    """Table [stock.blank] of kind ``saved``: the stock that another run has left, its ``stock.parquet``."""

    kind: Literal["saved"]
    file: str = Field(min_length=1)
