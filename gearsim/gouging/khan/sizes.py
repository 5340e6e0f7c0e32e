"""Khan's choice of a tool (chapter 7), beside which the true optimum is shown: repaired only where it could not run.

Repairs (errata): k_s(T_t,min) <= 0 sets no limit to R (printed: a division by zero); r starts at min(1/ks_max, R)
for every R; r below 2 mm does not exist. Left as they are: r is lowered in steps though k_min falls with it, R only
falls, the limit on R holds for the first r alone, and R "less than" its limit. A tie is no gouging, as in print.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.gouging.compare import TIE
from gearsim.gouging.sizes import JointChoice, largest_joint_mill, least_difference
from gearsim.gouging.standard_mills import KHAN_CORNER_LEAST, KHAN_CORNER_STEP, KHAN_RADII, khan_mills
from gearsim.gouging.tensors import Tensor

_ROUNDING = 1e-9


class KhanChoice(NamedTuple):
    """Khan's mills at contacts, shape (n,): R and r [mm] (nan: none found), his case, his limit on R [mm].

    ``smallest_gouges``: his case (a) calls the part impossible there, whatever the search finds.
    """

    shank: NDArray
    corner: NDArray
    case: NDArray
    limit: NDArray
    smallest_gouges: NDArray


def khan_mill(theta: NDArray, part: Tensor, radii: tuple[float, ...] = KHAN_RADII, strict: bool = True) -> KhanChoice:
    """Khan's tool at each contact, theta [rad] of shape (n,); ``strict``: R less than its limit, else at most.

    Cases: ``b`` convex, ``c i`` k_s(T_t,min) < 0, ``c ii`` else. In (b) he leaves r open; here r = R.
    """
    high = part.principal()[0]
    case = np.where(high <= 0.0, "b", np.where(part.c < 0.0, "c i", "c ii"))
    with np.errstate(divide="ignore", invalid="ignore"):
        first = np.where(high > 0.0, 1.0 / np.maximum(high, 0.0), np.inf)
        limit = np.sin(theta) / part.c + first * (1.0 - np.sin(theta))
    limit = np.where((case == "c ii") & (part.c > 0.0), limit, np.inf)
    smallest = least_difference(min(radii), KHAN_CORNER_LEAST, theta, part) < -TIE
    shank, corner = np.full(len(theta), np.nan), np.full(len(theta), np.nan)
    for big in sorted(radii, reverse=True):
        allowed = big < limit * (1.0 - _ROUNDING) if strict else big <= limit * (1.0 + _ROUNDING)
        waiting = np.flatnonzero(np.isnan(shank) & allowed)
        r = _lowered(big, np.minimum(first[waiting], big), theta[waiting], part[waiting])
        shank[waiting] = np.where(np.isnan(r), np.nan, big)
        corner[waiting] = r
    return KhanChoice(shank, corner, case, limit, smallest)


def khan_joint(choice: KhanChoice) -> tuple[float, float]:
    """His tool for a surface: the least R and the least r over all contacts [mm]; nan where a contact has none."""
    return float(np.min(choice.shank)), float(np.min(choice.corner))


class SideBySide(NamedTuple):
    """One mill for all contacts: Khan's R and r [mm], where and how it is closest to gouging; and the true optimum.

    ``limiting``, ``least``: the contact and its least f [1/mm], below 0 where Khan's mill gouges. ``khan`` is None
    beside the optimum of another catalogue: his algorithm chooses from his own.
    """

    khan: tuple[float, float] | None
    limiting: int
    least: float
    best: JointChoice


def beside_best(theta: NDArray, part: Tensor, mills: NDArray | None = None) -> SideBySide:
    """Khan's mill for a surface beside the largest of a catalogue (R, r) that gouges nowhere; his own if none given."""
    khan = khan_joint(khan_mill(theta, part))
    f = least_difference(*khan, theta, part)
    limiting = int(np.argmin(f))
    best = largest_joint_mill(khan_mills() if mills is None else mills, theta, part)
    return SideBySide(khan, limiting, float(f[limiting]), best)


def _lowered(shank: float, start: NDArray, theta: NDArray, part: Tensor) -> NDArray:
    """The first corner radius from ``start`` down in steps of 0.1 mm that does not gouge; nan where none to 2 mm."""
    r, found = start.copy(), np.full(len(start), np.nan)
    waiting = np.flatnonzero(r >= KHAN_CORNER_LEAST - 1e-9)
    while len(waiting):
        fits = least_difference(shank, r[waiting], theta[waiting], part[waiting]) >= -TIE
        found[waiting[fits]] = r[waiting[fits]]
        waiting = waiting[~fits]
        r[waiting] -= KHAN_CORNER_STEP
        waiting = waiting[r[waiting] >= KHAN_CORNER_LEAST - 1e-9]
    return found
