"""What the measuring rooms ask of a surface: points with normals, where they lie, and how far to look."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple, Protocol

from numpy.typing import NDArray

from gearsim.geometry.jets import Curvature
from gearsim.surfaces.blank import BevelBlank

Side = Literal["convex", "concave"]
SIDES: tuple[Side, Side] = ("convex", "concave")
Part = Literal["flank", "fillet", "bottom"]


def patch_name(part: Part, side: Side) -> str:
    """``convex``, ``concave`` for the working flanks; ``convex fillet``, ..., ``bottom``."""
    return {"flank": side, "fillet": f"{side} fillet", "bottom": "bottom"}[part]


class Way(NamedTuple):
    """A direction in which fractions of ``Patch.locate`` run: what it is, with its unit, and its ends' values."""

    what: str
    first: float = 0.0
    last: float = 1.0

    def at(self, fraction: NDArray) -> NDArray:
        """Values at fractions, any shape."""
        return self.first + (self.last - self.first) * fraction


def slot_ways(blank: BevelBlank, part: Part) -> tuple[Way, Way]:
    """Along a bevel gear's slot, and up its walls or across its bottom."""
    up = "across the bottom [share]" if part == "bottom" else "root to tip [share]"
    return Way("toe to heel [mm]", 0.0, blank.face_width), Way(up)


class Jet(Protocol):
    """Points with tangents and normals, each of shape (n, 3); nan where there is no surface."""

    @property
    def r(self) -> NDArray: ...

    @property
    def ru(self) -> NDArray: ...

    @property
    def rv(self) -> NDArray: ...

    @property
    def normal(self) -> NDArray:
        """Unit normals out of the material."""
        ...

    def second_form(self) -> tuple[NDArray, NDArray, NDArray]:
        """L, M, N of the second fundamental form, shape (n,)."""
        ...

    def curvature(self) -> Curvature: ...


class Patch(Protocol):
    """One named part of an intended surface, over two parameters (u, v)."""

    @property
    def name(self) -> str: ...

    @property
    def blank(self) -> BevelBlank | None:
        """The gear blank the surface is cut into (None: a surface of its own, without bounds)."""
        ...

    @property
    def ways(self) -> tuple[Way, Way]:
        """What the fractions ``length`` and ``height`` of ``locate`` run along."""
        ...

    def jet(self, u: NDArray, v: NDArray) -> Jet: ...

    def locate(self, length: NDArray, height: NDArray) -> tuple[NDArray, NDArray]:
        """Parameters of points given by fractions, 0 to 1, along the patch and up it."""
        ...

    def windows(self, u: NDArray, v: NDArray) -> tuple[NDArray, NDArray]:
        """How far [mm] to look for the machined surface, into the material and out of it."""
        ...


class ToothSurface(Patch, Protocol):
    """One part of a bevel gear's tooth slot."""

    @property
    def blank(self) -> BevelBlank: ...

    @property
    def part(self) -> Part: ...

    @property
    def side(self) -> Side: ...

    @property
    def parameters(self) -> tuple[str, str]:
        """What u and v are called in tables, with their units where they have one."""
        ...

    def mean_profile(self, contact_height: float, offsets: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """The flank's profile in the plane of the lengthwise curve's mean point M, normal to the generator there.

        Heights count from the root cone along the pitch cone's normal at M: ``contact_height`` [mm] and, from there on,
        ``offsets`` [mm], shape (n,). Returns u and v, shape (n,), and the plane's unit normal, shape (3,).
        """
        ...


class Tooth(Protocol):
    """A tooth slot of a bevel gear."""

    @property
    def blank(self) -> BevelBlank: ...

    @property
    def patches(self) -> Sequence[ToothSurface]:
        """The whole slot, from the concave tip down and up to the convex tip."""
        ...

    @property
    def bottom(self) -> ToothSurface: ...

    def check(self) -> None:
        """Raise InputError for a slot that no gear has, before anything is cut."""
        ...

    def flank(self, side: Side) -> ToothSurface: ...

    def fillet(self, side: Side) -> ToothSurface: ...
