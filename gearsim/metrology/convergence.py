"""How the deviation under a motion of N points approaches that of the motion the points were taken from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearsim.metrology.deviation import Deviation
from gearsim.metrology.study import Change

_ROUNDING_UM = 1e-6  # what the removal road finds a cut's end to


@dataclass(frozen=True)
class Series:
    """Variants of more and more ``points`` of the motion ``of``, to be held against the ``exact`` one: names."""

    of: str
    exact: str
    points: tuple[int, ...]
    variants: tuple[str, ...]

    @property
    def changes(self) -> list[Change]:
        """The series as a study: one variant after the other in the place of the motion."""
        named = zip(self.points, self.variants, strict=True)
        return [Change("points", str(n), {self.of: variant}) for n, variant in named]

    def read(self, surface: str, exact: Deviation, found: Sequence[Deviation]) -> ConvergenceMeasurement:
        """The series from the deviations of a surface's samples under the exact motion and under every change."""
        changes = (np.abs(deviation.value - exact.value) for deviation in found)
        worst = tuple(float(np.nanmax(1e3 * change)) for change in changes)
        return ConvergenceMeasurement(surface, self.of, Convergence(self.points, worst))


@dataclass(frozen=True)
class Convergence:
    """Largest change of the deviation [um] from the theoretical motion to one given by N points."""

    points: tuple[int, ...]
    worst_um: tuple[float, ...]

    @property
    def orders(self) -> list[float]:
        """Observed order between consecutive N, by the ratio of the spacings (N - 1); nan for changes of rounding."""
        n, w = np.array(self.points) - 1.0, np.array(self.worst_um)
        w = np.where(w > _ROUNDING_UM, w, np.nan)
        with np.errstate(divide="ignore", invalid="ignore"):
            return [float(q) for q in np.log(w[:-1] / w[1:]) / np.log(n[1:] / n[:-1])]


@dataclass(frozen=True)
class ConvergenceMeasurement:
    """The convergence of one surface's dense grid under a variant."""

    surface: str
    variant: str
    convergence: Convergence
    inspection: str = "convergence"
