"""Table [stock.turning]: the blank turned to an outline before anything else is cut."""

from __future__ import annotations

import numpy as np
from pydantic import model_validator

from gearsim.errors import InputError
from gearsim.geometry.turned import Turned
from gearsim.scene.outline import Outline
from gearsim.scene.tables import Length, Table
from gearsim.simulation.turning import Turning


class TurningTable(Table):
    """Table [stock.turning]: what of the blank lies outside an outline about z is turned off first, exactly.

    ``outline_mm``: corners (radius, z) of what remains, once around, as of a turned blank (default: the part's own
    blank). ``speed_m_min``, ``feed_mm_rev`` and ``depth_mm`` of cut, all or none, say how long it takes.
    """

    name: str = "turning"
    outline_mm: Outline | None = None
    speed_m_min: Length | None = None
    feed_mm_rev: Length | None = None
    depth_mm: Length | None = None

    @model_validator(mode="after")
    def _rate_is_whole(self) -> TurningTable:
        given = [x is not None for x in (self.speed_m_min, self.feed_mm_rev, self.depth_mm)]
        if any(given) and not all(given):
            raise ValueError("speed_m_min, feed_mm_rev and depth_mm belong together; give all three or none")
        return self

    def build(self, own: Turned | None) -> Turning:
        """``own``: the part's own blank. Raises InputError where neither says what remains."""
        kept = own if self.outline_mm is None else Turned(np.array(self.outline_mm, dtype=float))
        if kept is None:
            raise InputError("stock.turning.outline_mm: missing; this part has no blank of its own to turn to")
        rate = None
        if self.speed_m_min is not None and self.feed_mm_rev is not None and self.depth_mm is not None:
            rate = 1e3 * self.speed_m_min * self.feed_mm_rev * self.depth_mm
        return Turning(self.name, kept, rate)
