"""What the measuring rooms ask of a surface: points with normals, where they lie, and how far to look."""

from __future__ import annotations

from typing import Protocol

from numpy.typing import NDArray

from gearsim.geometry.jets import Curvature
from gearsim.surfaces.blank import BevelBlank


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

    def jet(self, u: NDArray, v: NDArray) -> Jet: ...

    def locate(self, length: NDArray, height: NDArray) -> tuple[NDArray, NDArray]:
        """Parameters of points given by fractions, 0 to 1, along the patch and up it."""
        ...

    def windows(self, u: NDArray, v: NDArray) -> tuple[NDArray, NDArray]:
        """How far [mm] to look for the machined surface, into the material and out of it."""
        ...
