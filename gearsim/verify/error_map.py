"""Where over its parameters a formula errs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Worst(NamedTuple):
    """The largest error of a check, and the parameters where it is."""

    error: float
    u: float
    v: float


@dataclass(frozen=True)
class ErrorMap:
    """Errors at points u, v of a formula, all shape (n,).

    ``missing``: the formula has no point there; ``trimmed``: another pose cuts it away; ``wrong_side``: its normal
    points into the material. ``errors`` by check (mm, rad, relative), nan where nothing was compared, inf for what is
    not a number.
    """

    u: NDArray
    v: NDArray
    missing: NDArray
    trimmed: NDArray = field(default_factory=lambda: np.zeros(0, dtype=bool))
    wrong_side: NDArray = field(default_factory=lambda: np.zeros(0, dtype=bool))
    errors: Mapping[str, NDArray] = field(default_factory=dict)

    def known(
        self, trimmed: NDArray, found: Mapping[str, tuple[NDArray, NDArray]], wrong_side: NDArray
    ) -> ErrorMap:  # fmt: skip
        """With what was found: which of the points that are there are trimmed, and of the others errors by check, with
        whether they are settled, and which have their normals on the wrong side.
        """
        there = np.flatnonzero(~self.missing)
        kept = there[~trimmed]

        def everywhere(values: NDArray, at: NDArray, default: float | bool) -> NDArray:
            out = np.full(self.u.shape, default)
            out[at] = values
            return out

        spread = {
            name: everywhere(np.where(settled, np.nan_to_num(error, nan=np.inf, posinf=np.inf), np.nan), kept, np.nan)
            for name, (error, settled) in found.items()
        }
        cut, wrong = everywhere(trimmed, there, False), everywhere(wrong_side, kept, False)
        return ErrorMap(self.u, self.v, self.missing, cut, wrong, spread)

    def worst(self, name: str) -> Worst | None:
        """Where a check's error is largest; None where nothing was compared."""
        error = self.errors[name]
        if np.isnan(error).all():
            return None
        i = int(np.nanargmax(error))
        return Worst(float(error[i]), float(self.u[i]), float(self.v[i]))
