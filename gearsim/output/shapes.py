"""What is shown in 3D: triangles, and what they can be coloured by. Plain data, made without any drawing library."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gearsim.output.colours import STEEL


@dataclass(frozen=True)
class Values:
    """A value at every point, shape (n,), in ``unit``; nan where there is none.

    Colours run from ``low`` to ``high``, values beyond have those of the ends. ``palette``: ``diverging`` for signed
    values about 0 (overcut and excess), ``sequential`` for numbers that only grow.
    """

    value: NDArray
    low: float
    high: float
    unit: str
    palette: Literal["diverging", "sequential"] = "diverging"

    @property
    def scale(self) -> tuple[object, ...]:
        """What all shapes with this colouring share."""
        return self.low, self.high, self.unit, self.palette


@dataclass(frozen=True)
class Classes:
    """The class of every triangle, shape (m,), by its place in ``names``: an operation, a tool, a tool mark."""

    number: NDArray
    names: tuple[str, ...]


Colouring = Values | Classes


@dataclass(frozen=True)
class Shape:
    """A surface: ``points`` [mm], shape (n, 3), workpiece frame; ``triangles``, point numbers, shape (m, 3).

    ``colours`` by their names; under a colouring that it lacks a shape is ``plain``. ``smooth``: shaded as one curved
    surface wherever triangles share points, so that points at sharp edges have to be there twice; else facet by facet.
    ``shown``: from the start, and not only when it is asked for. ``body``: the closed body whose skin it is, with all
    shapes of that name, which share the points in which they meet; sections of it are filled. Empty: an open surface.
    Raises ValueError where the arrays do not fit one another.
    """

    name: str
    points: NDArray
    triangles: NDArray
    colours: Mapping[str, Colouring] = field(default_factory=dict)
    plain: str = STEEL
    smooth: bool = True
    shown: bool = True
    body: str = ""

    def __post_init__(self) -> None:
        if self.points.ndim != 2 or self.points.shape[1] != 3 or not np.isfinite(self.points).all():
            raise ValueError(f"{self.name}: points are finite and have shape (n, 3), not {self.points.shape}")
        if self.triangles.ndim != 2 or self.triangles.shape[1] != 3:
            raise ValueError(f"{self.name}: triangles have shape (m, 3), not {self.triangles.shape}")
        if len(self.triangles) and not 0 <= self.triangles.min() <= self.triangles.max() < len(self.points):
            raise ValueError(f"{self.name}: triangles name points from 0 to {len(self.points) - 1}")
        for name, colouring in self.colours.items():
            self._check(name, colouring)

    def _check(self, name: str, colouring: Colouring) -> None:
        """A colouring's length, scale and class numbers."""
        if isinstance(colouring, Values):
            if colouring.value.shape != (len(self.points),):
                raise ValueError(f"{self.name}, {name}: expected a value at each of {len(self.points)} points")
            if not -np.inf < colouring.low < colouring.high < np.inf:
                raise ValueError(f"{self.name}, {name}: colours from {colouring.low} to {colouring.high} are no scale")
            return
        number = colouring.number
        if number.shape != (len(self.triangles),):
            raise ValueError(f"{self.name}, {name}: expected a class of each of {len(self.triangles)} triangles")
        if len(number) and not 0 <= number.min() <= number.max() < len(colouring.names):
            raise ValueError(f"{self.name}, {name}: classes run from 0 to {len(colouring.names) - 1}")
