"""The largest end mill that does not gouge: in closed form, over a catalogue, at each contact and jointly.

Tensors are those of the part in the basis (uphill, n x uphill), which is fixed by axis and normal and is the same
for all mills. "Largest" is Khan's preference: the largest shank radius R, then the largest corner radius r. A tie
counts as fitting, so the closed forms are the tie's sizes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.cutters.contact import ANGLE, end_mill_contact
from gearsim.gouging.compare import TIE, compare_contact
from gearsim.gouging.tensors import Tensor


class Choice(NamedTuple):
    """Mills chosen at contacts: row of the catalogue (-1: none fits), R and r [mm] (nan), least f [1/mm]."""

    row: NDArray
    shank: NDArray
    corner: NDArray
    least: NDArray


class JointChoice(NamedTuple):
    """One mill for all contacts: row, R and r [mm], and the contact it is closest to gouging at.

    Row -1, nan where none fits: ``limiting`` and ``least`` are then those of the catalogue's last.
    """

    row: int
    shank: float
    corner: float
    limiting: int
    least: float


def least_difference(shank: ArrayLike, corner: ArrayLike, theta: ArrayLike, part: Tensor) -> NDArray:
    """Least value of k_tool - k_part [1/mm] over all directions, by broadcasting; nan where there is no contact."""
    return compare_contact(end_mill_contact(shank, corner, theta), part).least


def largest_ball(theta: ArrayLike, part: Tensor) -> NDArray:
    """Radius [mm] of the largest ball end mill, shape (...): 1/ks_max, inf on convex points; on the shank see below."""
    high = part.principal()[0]
    with np.errstate(divide="ignore"):
        ball = np.where(high > 0.0, 1.0 / np.maximum(high, 0.0), np.inf)
    shank = largest_shank(0.0, np.full(np.shape(high), 0.5 * np.pi), part)
    on_shank = np.abs(np.asarray(theta) - 0.5 * np.pi) <= ANGLE
    return np.where(on_shank, shank, ball)


def largest_shank(corner: ArrayLike, theta: ArrayLike, part: Tensor) -> NDArray:
    """Largest shank radius R [mm] for a given corner radius r, shape (...): inf without a limit, nan where none fits.

    f >= 0 everywhere if and only if 1/r >= a and k_min >= kappa = c + b²/(1/r - a); then
    R = r + sin(theta) (1/kappa - r). On the shank 1/r gives way to 0, on a flat bottom k_max = k_min = 0.
    """
    r, angle, a, b, c = np.broadcast_arrays(corner, theta, part.a, part.b, part.c)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        along = np.where(np.abs(angle - 0.5 * np.pi) <= ANGLE, 0.0, 1.0 / np.asarray(r, dtype=float))
        room = along - a
        coupling = np.where(b == 0.0, 0.0, b * b / room)
        need = np.where(np.isinf(room), c, c + coupling)
        need = np.where((np.abs(room) <= TIE) & (np.abs(b) <= TIE), c, need)
        size = np.where(need > 0.0, r + np.sin(angle) * (1.0 / need - r), np.inf)
    size = np.where((room < -TIE) | ((np.abs(room) <= TIE) & (np.abs(b) > TIE)), np.nan, size)
    size = np.where(size < r * (1.0 - 1e-12), np.nan, size)
    return np.where(angle <= ANGLE, _on_bottom(r, part), size)


def largest_mills(mills: NDArray, theta: NDArray, part: Tensor) -> Choice:
    """The first mill of a catalogue (R, r), shape (m, 2), that fits at each contact, theta of shape (n,)."""
    n = len(theta)
    row, least = np.full(n, -1), np.full(n, np.nan)
    waiting = np.flatnonzero(np.isfinite(part.a + part.b + part.c + theta))
    for i, (shank, corner) in enumerate(mills):
        f = least_difference(shank, corner, theta[waiting], part[waiting])
        fits = f >= -TIE
        row[waiting[fits]], least[waiting[fits]] = i, f[fits]
        waiting = waiting[~fits]
        if not len(waiting):
            break
    size = np.where((row >= 0)[:, None], mills[row], np.nan)
    return Choice(row, size[:, 0], size[:, 1], least)


def largest_joint_mill(mills: NDArray, theta: NDArray, part: Tensor) -> JointChoice:
    """The first mill of a catalogue that fits at all contacts at once.

    Khan takes the least R and the least r over the contacts (7.3 end), which may gouge: k_min falls with r. A contact
    that no mill has (theta above 90 deg, no curvature) leaves none: leave such points out.
    """
    row, limiting, last = 0, 0, len(mills) - 1
    while True:
        at_limit = least_difference(mills[row:last, 0], mills[row:last, 1], theta[limiting], part[limiting])
        fits = np.flatnonzero(~(at_limit < -TIE))  # what stopped a larger mill stops the others, too
        row = row + int(fits[0]) if len(fits) else last
        shank, corner = mills[row]
        f = least_difference(shank, corner, theta, part)
        limiting = int(np.argmin(f))
        worst = float(f[limiting])
        if worst >= -TIE:
            return JointChoice(row, float(shank), float(corner), limiting, worst)
        if row == last:
            return JointChoice(-1, np.nan, np.nan, limiting, worst)
        row += 1


def _on_bottom(corner: NDArray, part: Tensor) -> NDArray:
    """At theta = 0: any disc where the part is not concave, else only a ball (R = r)."""
    high = part.principal()[0]
    ball = np.where((corner > 0.0) & (corner * high <= 1.0 + TIE * corner), corner, np.nan)
    return np.where(high <= TIE, np.inf, ball)
