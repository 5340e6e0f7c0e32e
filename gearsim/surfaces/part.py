"""The part to be made: its stock, its named surfaces, and what of each is tolerated."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Protocol

from numpy.typing import NDArray

from gearsim.geometry.turned import Turned
from gearsim.surfaces.patch import Patch


@dataclass(frozen=True)
class Tolerance:
    """How far [um] a surface may lie below and above the intended one; inf: as far as it likes."""

    overcut_um: float
    excess_um: float

    @classmethod
    def both(cls, um: float) -> Tolerance:
        return cls(um, um)

    @property
    def text(self) -> str:
        """The tolerance in words."""
        if self.overcut_um == self.excess_um:
            return f"±{self.excess_um:g} µm"
        ends = [
            f"{word} {um:g} µm" for word, um in (("overcut", self.overcut_um), ("excess", self.excess_um)) if um < inf
        ]
        return ", ".join(ends)

    def allows(self, deviation_um: float) -> bool:
        """Whether a deviation, positive for material left, is within it."""
        return -self.overcut_um <= deviation_um <= self.excess_um


@dataclass(frozen=True)
class Intended:
    """A surface as it is meant to be; ``tolerance`` None: it is measured and judged by nothing."""

    patch: Patch
    tolerance: Tolerance | None = None


class NamedFaces(Protocol):
    """A whole part as it is meant to be: a solid whose surface is all of named faces."""

    @property
    def volume(self) -> float | None:
        """Its volume [mm³], where it is known."""
        ...

    @property
    def tolerances(self) -> dict[str, Tolerance]:
        """Of each face, by its name."""
        ...

    def by_face(self, points: NDArray) -> tuple[NDArray, NDArray]:
        """Signed distances [mm] of points, shape (n, 3), negative inside, and which faces they are nearest to, (n,)."""
        ...

    def signed_distance(self, points: NDArray) -> NDArray:
        """The distances alone."""
        ...


@dataclass(frozen=True)
class Part:
    """What is to be made, all in one frame, named in words by ``frame``.

    ``stock`` is what it is cut out of (None: the surfaces stand alone, material without end behind them), ``mate`` the
    blank that it will run with, about its own axis, where one is known. ``whole`` is all of its surface, where that is
    known: every end of a whole stock's rays is held against it.
    """

    frame: str
    stock: Turned | None
    surfaces: dict[str, Intended]
    mate: Turned | None = None
    whole: NamedFaces | None = None

    def patch(self, name: str) -> Patch:
        """The intended surface of a name."""
        return self.surfaces[name].patch
