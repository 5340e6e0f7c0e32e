"""A plane section of a part: the outline as cut, and beside it that of the intended surfaces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry.grid_sections import cut_grid
from gearsim.geometry.sections import Section, section
from gearsim.output.run_folder import MeasuredGrid
from gearsim.output.solid_files import SolidSurface

_AXES = "xyz"
_LARGEST = 1e9  # a number that a plane is written with


@dataclass(frozen=True)
class Plane:
    """All points p [mm] with ``normal`` · p = ``offset`` [mm], the normal of length 1; ``text`` as it was asked for."""

    normal: NDArray[np.floating]
    offset: float
    text: str

    @property
    def point(self) -> NDArray:
        """The point nearest to the origin."""
        return self.offset * self.normal

    @property
    def frame(self) -> tuple[NDArray, NDArray, str]:
        """Two unit vectors in the plane, right-handed with its normal, and what they are called."""
        k = int(np.argmax(np.abs(self.normal)))
        if self.normal[k] == 1.0:
            return np.eye(3)[(k + 1) % 3], np.eye(3)[(k + 2) % 3], _AXES[(k + 1) % 3] + _AXES[(k + 2) % 3]
        u = np.cross(np.eye(3)[(k + 2) % 3], self.normal)
        u /= np.linalg.norm(u)
        return u, np.cross(self.normal, u), "uv"


@dataclass(frozen=True)
class Curve:
    """A curve in a section's plane: ``kind`` machined or intended, of which surface, ``points`` [mm], shape (n, 3), and
    the machined surface's ``deviation`` [mm] from it, nan where there is none."""

    kind: str
    name: str
    points: NDArray[np.floating]
    deviation: NDArray[np.floating]
    closed: bool


@dataclass(frozen=True)
class Cut:
    """A plane section: of the part as cut, where its surface is known, and the ``curves`` in it."""

    plane: Plane
    area: float | None
    curves: tuple[Curve, ...]


def read_plane(text: str) -> Plane:
    """A plane written as ``z=-5`` or ``n=0,0,1;d=-5`` (mm; the normal of any length). Raises InputError for others."""
    wrong = InputError(f"--section {text}: expected a plane such as z=-5, or n=1,1,0;d=20 (normal; mm along it)")
    key, _, rest = text.replace(" ", "").partition("=")
    try:
        if key in (*_AXES,):
            normal, offset = np.eye(3)[_AXES.index(key)], float(rest)
        elif key == "n" and ";d=" in rest:
            numbers, _, d = rest.partition(";d=")
            normal, offset = np.array([float(x) for x in numbers.split(",")]), float(d)
        else:
            raise wrong
    except ValueError:
        raise wrong from None
    length = float(np.linalg.norm(normal)) if (np.abs([*normal, offset]) < _LARGEST).all() else np.nan
    if normal.shape != (3,) or not (np.isfinite([length, offset]).all() and length > 0.0):
        raise wrong
    return Plane(normal / length, offset, text)


def cut_part(plane: Plane, part: SolidSurface | None, grids: Sequence[MeasuredGrid]) -> Cut:
    """The section of a part's surface, where it is known, else of the measured surfaces as machined; and as intended.

    Raises InputError where the plane meets none of them.
    """
    curves = [curve for grid in grids for curve in _lines(plane, grid, part is None)]
    found = None if part is None else section(part.mesh, plane.point, plane.normal)
    if found is not None:
        curves = [*_machined(found), *curves]
    if not curves:
        raise InputError(f"--section {plane.text}: the plane meets nothing of the part")
    return Cut(plane, None if found is None else found.area, tuple(curves))


def _lines(plane: Plane, grid: MeasuredGrid, machined: bool) -> Iterator[Curve]:
    for points, deviation in cut_grid(grid.point, plane.point, plane.normal, grid.deviation):
        yield Curve("intended", grid.name, points, deviation, False)
    for points, deviation in cut_grid(grid.machined, plane.point, plane.normal, grid.deviation) if machined else ():
        yield Curve("machined", grid.name, points, np.full(len(deviation), np.nan), False)


def _machined(found: Section) -> Iterator[Curve]:
    for loop, area in zip(found.loops, found.loop_areas, strict=True):
        yield Curve("machined", "outer" if area > 0.0 else "hole", loop, np.full(len(loop), np.nan), True)


def told(cut: Cut) -> list[str]:
    """What a section says, line by line."""
    lines = [] if cut.area is None else [f"material {cut.area:.6g} mm2 in {_count(cut, 'machined')} loops"]
    names = dict.fromkeys(c.name for c in cut.curves if c.kind == "intended")
    return lines + [f"{name}: {deviations(cut, name)}" for name in names]


def deviations(cut: Cut, name: str) -> str:
    """The machined surface's deviations along the section of an intended one."""
    um = 1e3 * np.concatenate([c.deviation for c in cut.curves if (c.kind, c.name) == ("intended", name)])
    known = um[np.isfinite(um)]
    return f"{known.min():+.3g} to {known.max():+.3g} um, + material left" if len(known) else "nothing measured here"


def _count(cut: Cut, kind: str) -> int:
    return sum(c.kind == kind for c in cut.curves)
