"""Rays: straight lines with an origin, a direction and a window of interest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry.rigid import Rigid

_UNIT = 1e-9


@dataclass(frozen=True)
class RayBundle:
    """Rays with a window of interest.

    ``origin`` [mm] and unit ``direction`` have shape (n, 3); ``start`` and ``end`` [mm along the ray],
    shape (n,), bound where cuts matter: those wholly outside may be missing from the result. Raises InputError for
    other shapes and for directions that are not of unit length to 1e-9 (nan passes: a ray that there is not).
    """

    origin: NDArray[np.floating]
    direction: NDArray[np.floating]
    start: NDArray[np.floating]
    end: NDArray[np.floating]

    def __post_init__(self) -> None:
        shapes = [np.shape(getattr(self, name)) for name in ("origin", "direction", "start", "end")]
        n = shapes[0][0] if shapes[0] else 0
        if shapes != [(n, 3), (n, 3), (n,), (n,)]:
            raise InputError(
                f"rays: origin, direction, start, end have shapes {', '.join(map(str, shapes))}; "
                "expected (n, 3), (n, 3), (n,), (n,)"
            )
        off = np.abs(np.einsum("ij,ij->i", self.direction, self.direction) - 1.0) > 2.0 * _UNIT
        if off.any():
            i = int(np.argmax(off))
            raise InputError(
                f"rays: direction {i} has length {np.linalg.norm(self.direction[i]):.12g}; expected 1 (divide by it)"
            )

    def __len__(self) -> int:
        return len(self.origin)

    def moved(self, rigid: Rigid) -> RayBundle:
        """The same rays in another frame."""
        return RayBundle(rigid.point(self.origin), rigid.direction(self.direction), self.start, self.end)

    def part(self, chosen: NDArray | slice) -> RayBundle:
        """A selection of the rays."""
        return RayBundle(self.origin[chosen], self.direction[chosen], self.start[chosen], self.end[chosen])


def join_rays(bundles: list[RayBundle]) -> RayBundle:
    """One bundle of several, in order."""
    fields = ("origin", "direction", "start", "end")
    return RayBundle(*(np.concatenate([getattr(b, f) for b in bundles]) for f in fields))
