"""The line that a tooth slot's paths follow: the profile frames along it, whatever surface the slot has."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.surfaces.blank import BevelBlank
from gearsim.surfaces.ruled_bevel import Spine


@dataclass(frozen=True)
class LengthwiseLine:
    """A slot's lengthwise curve with its profile frames, and how far beyond toe and heel, ``run`` [mm], paths go on.

    ``frames`` takes parameters, shape (n,), and an order, and returns series in the parameter; ``parameter_at`` gives
    those of cone distances [mm].
    """

    blank: BevelBlank
    frames: Callable[[NDArray, int], Spine]
    parameter_at: Callable[[NDArray], NDArray]
    run: float

    @property
    def ends(self) -> tuple[float, float]:
        """The parameters from before the toe to behind the heel."""
        return self._at(self.blank.toe - self.run, self.blank.cone_distance + self.run)

    @property
    def face(self) -> tuple[float, float]:
        """The parameters of toe and heel."""
        return self._at(self.blank.toe, self.blank.cone_distance)

    def _at(self, first: float, last: float) -> tuple[float, float]:
        a, b = self.parameter_at(np.array([first, last]))
        return float(a), float(b)
