"""What a scene's [stock] begins with: a shape, a body from a file, or what another run has left."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from gearsim.errors import InputError
from gearsim.geometry.solid import Solid, box_corners
from gearsim.scene.blank_files import SavedTable, SolidFileTable
from gearsim.scene.stock import StockTable
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.ends import material_ends
from gearsim.simulation.saved_blank import saved_solid
from gearsim.simulation.sequence import whole_box
from gearsim.simulation.stock import Stock
from gearsim.simulation.stock_file import load_stock


class Given(NamedTuple):
    """A blank as a ``solid``, the ``saved`` stock where it is one, and what a reader must be ``told`` of its file."""

    solid: Solid
    saved: Stock | None = None
    told: tuple[str, ...] = ()

    @property
    def top(self) -> float:
        """How high its material stands [mm]; of a saved stock, by the ends of its rays."""
        if self.saved is None:
            return float(self.solid.box[1][2])
        return float(material_ends(self.saved, lambda points, tags: np.zeros(points.shape)).point[:, 2].max())

    def box(self, pitch: float | None, others: Sequence[Solid] = ()) -> DexelBox:
        """The box around it and ``others``; a saved stock has its own. Raises InputError where they are not in it."""
        if self.saved is None:
            assert pitch is not None
            return whole_box(self.solid, pitch, others=others)
        box = self.saved.box
        for other in others:
            corners = box.frame.inverse().point(box_corners(other))
            if (corners.min(axis=0) < box.lower).any() or (corners.max(axis=0) > box.upper).any():
                raise InputError(
                    f"stock.blank: the saved stock's box, {box.lower} to {box.upper} mm, does not hold the body of "
                    "[surface]; begin the run that saves it with a box that does"
                )
        return box


def given_blank(table: StockTable, folder: Path) -> Given:
    """The blank that a table [stock] names; files are looked up in ``folder``.

    Raises InputError for what cannot be, where a file holds none, or a saved stock has another pitch.
    """
    blank = table.blank
    assert blank is not None
    if isinstance(blank, SavedTable):
        stock, job = load_stock(folder / blank.file)
        if table.pitch_mm is not None and table.pitch_mm != stock.box.pitch:
            raise InputError(
                f"stock.pitch_mm = {table.pitch_mm:g}: {blank.file} was saved with {stock.box.pitch:g}; "
                "leave the key out"
            )
        names = ", ".join(d.name for d in stock.done) or "nothing"
        told = (
            f"stock.blank: {blank.file}: what {job or 'another run'} has left after: {names}; between its rays, "
            f"{stock.box.pitch:g} mm apart, its surface is guessed: holders are held against it no closer than that"
        )
        return Given(saved_solid(stock, f"stock.blank: {blank.file}"), stock, (told,))
    if isinstance(blank, SolidFileTable):
        assert table.pitch_mm is not None
        solid, said = blank.read(folder, table.pitch_mm)
        return Given(solid, None, (said,))
    return Given(blank.build())
