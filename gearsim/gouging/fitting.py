"""The largest mill for a whole part: smooth points of its faces, and the places where faces meet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.contact import BEYOND
from gearsim.gouging.compare import TIE
from gearsim.gouging.junctions import Join, Junctions, least_at_sides, least_on_ridges
from gearsim.gouging.khan.sizes import SideBySide, khan_joint, khan_mill
from gearsim.gouging.looked import FaceLook
from gearsim.gouging.sizes import Choice, JointChoice, largest_mills, least_difference
from gearsim.gouging.standard_mills import khan_mills
from gearsim.gouging.surface import SurfaceContacts
from gearsim.gouging.tensors import Tensor
from gearsim.gouging.tool import mill_tool

_DIGITS = 1e12
_KEYS = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9, 0xD6E8FEB86659FD93], dtype=np.uint64)


@dataclass(frozen=True)
class Contacts:
    """What an end mill with a given axis reaches: smooth points, theta [rad] (n,) with the part's tensors and places
    [mm], and junctions.
    """

    theta: NDArray
    part: Tensor
    point: NDArray
    met: Junctions
    axis: NDArray

    def least(self, shank: float, corner: float) -> NDArray:
        """The least f [1/mm] of a mill R, r at all of them: smooth points, sides of places, ridges; inf off reach."""
        tool = mill_tool(shank, corner)
        parts = [
            least_difference(shank, corner, self.theta, self.part),
            least_at_sides(self.met, tool, self.axis),
            least_on_ridges(self.met, tool, self.axis),
        ]
        found = np.concatenate(parts)
        return np.where(np.isnan(found), np.inf, found)

    def place(self, index: int) -> NDArray:
        """Where one of them lies [mm]."""
        sides = self.met.sides
        return np.asarray(np.concatenate([self.point, sides.point, sides.point[self.met.ridges.side]])[index])

    def only(self, index: int) -> Contacts:
        """One smooth point alone, or one place with all its sides."""
        n, sides, none = len(self.theta), self.met.sides, np.empty(0, int)
        smooth = np.array([index]) if index < n else none
        row = -1 if index < n else index - n
        if row >= len(sides):
            row = int(self.met.ridges.side[row - len(sides)])
        place = sides.place[[row]] if row >= 0 else none
        return Contacts(self.theta[smooth], self.part[smooth], self.point[smooth], self.met.only(place), self.axis)


def contacts_of(looks: Sequence[FaceLook], met: Junctions, axis: NDArray) -> Contacts:
    """The contacts of faces that were looked at; those alike to twelve decimals are one."""
    seen: list[tuple[SurfaceContacts, NDArray]] = []
    for f in looks:
        held = f.held.ravel()
        smooth = f.samples.contacts
        seen.append((SurfaceContacts(smooth.theta[held], smooth.part[held]), f.grid.point.reshape(-1, 3)[held]))
        seen.append((f.tight.contacts, f.point))
    theta = np.concatenate([c.theta for c, _ in seen])
    part = Tensor(*(np.concatenate([getattr(c.part, k) for c, _ in seen]) for k in "abc"))
    rows = np.flatnonzero(np.isfinite(theta + part.a + part.b + part.c) & (theta <= 0.5 * np.pi + BEYOND))
    table = np.stack([theta, part.a, part.b, part.c], axis=1)[rows]
    with np.errstate(over="ignore"):
        keys = np.sum(np.round(table * _DIGITS).astype(np.int64).astype(np.uint64) * _KEYS, axis=1)
    rows = rows[np.sort(np.unique(keys, return_index=True)[1])]
    theta = np.minimum(theta[rows], 0.5 * np.pi)
    return Contacts(theta, part[rows], np.concatenate([p for _, p in seen])[rows], met, axis)


def size_map(seen: FaceLook, mills: NDArray) -> Choice:
    """The largest mill (R, r) of a catalogue at every point of a face's grid, row-major; none off the face."""
    smooth = seen.samples.contacts
    mine = seen.held.ravel() & np.isfinite(smooth.theta)
    return largest_mills(mills, np.where(mine, smooth.theta, np.pi), smooth.part)


def largest_for_all(contacts: Contacts, mills: NDArray) -> SideBySide | None:
    """Khan's mill for the smooth points, of his catalogue alone, beside the largest of one that gouges nowhere.

    ``mills``: (R, r), shape (m, 2). ``limiting`` and ``least`` of both are by all contacts. None where no mill reaches
    anything.
    """
    if not np.isfinite(contacts.least(*mills[-1])).any() and not len(contacts.theta):
        return None
    if not np.array_equal(mills, khan_mills()):
        return SideBySide(None, 0, np.nan, _largest(contacts, mills))
    khan = khan_joint(khan_mill(contacts.theta, contacts.part)) if len(contacts.theta) else (np.nan, np.nan)
    f = contacts.least(*khan) if np.isfinite(khan).all() else np.full(1, np.nan)
    return SideBySide(khan, int(np.argmin(f)), float(f.min()), _largest(contacts, mills))


def _largest(contacts: Contacts, mills: NDArray) -> JointChoice:
    """The first mill that fits everywhere; what stopped a larger one stops this one, too, unless it is sharp."""
    stops: list[Contacts] = []
    limiting, worst = 0, np.nan
    blunt = _has_corners(contacts)
    for i, (shank, corner) in enumerate(mills):
        last = i == len(mills) - 1
        if not last and ((corner > 0.0 and blunt) or any(np.any(s.least(shank, corner) < -TIE) for s in stops)):
            continue
        f = contacts.least(shank, corner)
        limiting = int(np.argmin(f))
        worst = float(f[limiting])
        if worst >= -TIE:
            return JointChoice(i, float(shank), float(corner), limiting, worst)
        stops = [contacts.only(limiting), *stops][:3]
    return JointChoice(-1, np.nan, np.nan, limiting, worst)


def _has_corners(contacts: Contacts) -> bool:
    """Whether a blunt mill reaches a concave corner: none enters it."""
    pairs = contacts.met.pairs
    touched = contacts.met.sides.normal[pairs.touched[pairs.kind == Join.CONCAVE]]
    return bool(np.any(touched @ contacts.axis >= -BEYOND))
