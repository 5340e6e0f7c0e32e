"""Tables [[machine.table]] and [[machine.fixture]]: bodies on the workpiece's side of a machine."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from gearsim.geometry.solid import Shifted, Solid
from gearsim.scene.outline import Coordinate
from gearsim.scene.stock import AnyBlank
from gearsim.scene.tables import Table


class BodyTable(Table):
    """A body that moves with the workpiece: a ``shape`` as in [stock.blank], in the frame of the machine's workpiece.

    ``at_mm``: where the axis of its frame stands, x and y, once for each of several alike.
    """

    shape: AnyBlank
    at_mm: tuple[tuple[Coordinate, Coordinate], ...] = Field(default=((0.0, 0.0),), min_length=1)

    def build(self) -> list[Solid]:
        """One solid a place. Raises InputError as the shape does."""
        solid = self.shape.build()
        return [Shifted(solid, np.array([x, y, 0.0])) for x, y in self.at_mm]
