"""Tool against part at a contact: free, tie or gouging; in which directions, and by how much.

f(alpha) = k_tool - k_part = m + A cos(2 alpha - psi) is the difference of two symmetric tensors: its least value
m - A decides, and its zeros are closed forms. No search over alpha (Khan 6.23) is needed. A sharp rim has
k_tool = inf along the meridian and is compared along the rim only: by Meusnier the section across the axis has
the curvature k_n / sin(eta), eta the angle between axis and normal (Khan 6.24 repaired, printed cos(eta)), and
1/R >= k_n / sin(eta) is around >= k_n.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.cutters.contact import Contact
from gearsim.gouging.tensors import Tensor, tool_tensor

TIE = 1e-9  # 1/mm


class Decision(IntEnum):
    """A tie is neither: the second order does not tell."""

    FREE = 0
    TIE = 1
    GOUGES = 2


@dataclass(frozen=True)
class Comparison:
    """f(alpha) = mean + amplitude cos(2 alpha - phase) [1/mm, rad], shape (...), and its ``least`` value.

    At a sharp rim mean and amplitude are inf, and ``least`` is the difference along the rim.
    """

    mean: NDArray
    amplitude: NDArray
    phase: NDArray
    least: NDArray

    def at(self, alpha: ArrayLike) -> NDArray:
        """f [1/mm] in directions alpha [rad]."""
        return self.mean + self.amplitude * np.cos(2.0 * np.asarray(alpha) - self.phase)

    @property
    def decision(self) -> NDArray:
        """`Decision` of each contact, shape (...)."""
        return decide(self.least)

    @property
    def worst(self) -> NDArray:
        """The direction of the least value [rad] in [0, pi)."""
        return np.mod(0.5 * (self.phase + np.pi), np.pi)

    @property
    def half_width(self) -> NDArray:
        """Half the width [rad] of the gouging interval about ``worst``: 0 where none, pi/2 where all directions."""
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(np.isinf(self.amplitude), 1.0, self.mean / self.amplitude)
        round_ = np.where(self.least < 0.0, -1.0, 1.0)  # A = 0: all directions are alike
        ratio = np.where(self.amplitude > 0.0, ratio, round_)
        return np.where(self.decision == Decision.GOUGES, 0.5 * np.arccos(np.clip(ratio, -1.0, 1.0)), 0.0)

    @property
    def interval(self) -> tuple[NDArray, NDArray]:
        """Start and end [rad] of the gouging directions, repeated after pi; start in (-pi/2, pi), nan where none."""
        gouges = self.decision == Decision.GOUGES
        half = self.half_width
        return np.where(gouges, self.worst - half, np.nan), np.where(gouges, self.worst + half, np.nan)

    def depth(self, step: ArrayLike) -> NDArray:
        """How deep [mm] the tool cuts into the part at a distance ``step`` [mm] from the contact: to second order."""
        return 0.5 * np.maximum(-self.least, 0.0) * np.asarray(step) ** 2


def decide(least: NDArray) -> NDArray:
    """`Decision` from the least value of k_tool - k_part [1/mm]."""
    return np.where(np.abs(least) <= TIE, Decision.TIE, np.where(least > 0.0, Decision.FREE, Decision.GOUGES))


def compare(tool: Tensor, part: Tensor) -> Comparison:
    """Compare tensors in one basis; the tool's ``a`` may be inf (a rim along e2)."""
    rim = np.isinf(tool.a)
    a = np.where(rim, 0.0, tool.a) - part.a
    b, c = tool.b - part.b, tool.c - part.c
    mean, half = 0.5 * (a + c), 0.5 * (a - c)
    amplitude = np.hypot(half, b)
    phase = np.arctan2(b, half)
    return Comparison(
        np.where(rim, np.inf, mean),
        np.where(rim, np.inf, amplitude),
        np.where(rim, 0.0, phase),
        np.where(rim, c, mean - amplitude),
    )


def compare_contact(contact: Contact, part: Tensor) -> Comparison:
    """Compare a cutter's contact with the part's tensor in the basis (uphill, n x uphill).

    Where the meridian's curvature differs on the two sides the weaker one is taken: f repeats after pi, so it
    decides. Its directions then hold on that side only: `borders.tool_sectors` has both.
    """
    return compare(tool_tensor(contact), part)
