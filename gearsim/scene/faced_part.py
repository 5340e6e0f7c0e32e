"""Scenes of a part bounded by NURBS faces, made from a blank by operations in sequence on any of its faces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import inf, radians
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, Field, model_validator

from gearsim.errors import InputError, is_file
from gearsim.scene.bevel import Number
from gearsim.scene.sculptured import Margin
from gearsim.scene.solid_part import DrillTable, MillTable, SequenceScene
from gearsim.scene.tables import Count, GridTable, Length, LengthOrZero, Table
from gearsim.surfaces.faced_solid import FacedPart, FacedSolid
from gearsim.surfaces.nurbs import NurbsSurface
from gearsim.surfaces.nurbs_file import load_untrimmed
from gearsim.surfaces.part import Tolerance
from gearsim.toolpaths.over_face import AxisRule, between_axis, fixed_axis, leaning_axis


def _has_a_length(direction: tuple[float, float, float]) -> tuple[float, float, float]:
    if not float(np.linalg.norm(direction)) > 1e-9:
        raise ValueError(f"got {direction}; it must have a length")
    return direction


Direction = Annotated[tuple[Number, Number, Number], AfterValidator(_has_a_length)]
_UP: Direction = (0.0, 0.0, 1.0)


class FaceTable(Table):
    """An entry of [[surface.faces]]: a face of the file by its ``number`` from 1, its name here, and its tolerances.

    ``excess_um`` left out: it is not meant to be finished, as much as it likes may be left.
    """

    number: int = Field(ge=1)
    name: str = Field(min_length=1)
    overcut_um: Length
    excess_um: Length | None = None

    @property
    def tolerance(self) -> Tolerance:
        return Tolerance(self.overcut_um, inf if self.excess_um is None else self.excess_um)


class FacedTable(Table):
    """Table [surface] of kind ``faced-part``: a solid whose faces stand in a ``file`` (shipped net, JSON, IGES, STEP).

    ``faces`` are those to be machined. All others are the blank's own: they are held to ``rest_tolerance_um``.
    """

    kind: Literal["faced-part"]
    file: str = Field(min_length=1)
    rest_tolerance_um: Length = 1.0
    faces: tuple[FaceTable, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _each_once(self) -> FacedTable:
        for key in ("number", "name"):
            given = [getattr(face, key) for face in self.faces]
            if len(set(given)) < len(given):
                raise ValueError(f"faces: each {key} stands once, got {given}")
        return self

    def build(self, folder: Path, window: float) -> FacedPart:
        """The part, its faces looked at within ``window`` [mm] along their normals; files are looked up in ``folder``.

        Raises InputError where there is no such solid.
        """
        beside = folder / self.file
        found = load_untrimmed(beside if is_file(beside) else self.file)
        named = {face.number: face for face in self.faces}
        for number in named:
            if number > len(found):
                raise InputError(f"surface.faces: {self.file} holds {len(found)} faces, got number {number}")
        names = [named[k].name if k in named else face.name for k, face in enumerate(found, 1)]
        for name in names:
            if names.count(name) > 1:
                raise InputError(f"surface.faces: two faces of {self.file} are called {name!r}; name one otherwise")
        faces = tuple(replace(face, name=name, window=window) for face, name in zip(found, names, strict=True))
        rest = Tolerance.both(self.rest_tolerance_um)
        limits = {name: named[k].tolerance if k in named else rest for k, name in enumerate(names, 1)}
        return FacedPart(FacedSolid(faces), limits)


class FixedAxisTable(Table):
    """Key ``axis`` of kind ``fixed``: the tool's axis is the same everywhere; ``direction`` leads away from the tip."""

    kind: Literal["fixed"]
    direction: Direction = _UP

    def build(self, faces: Mapping[str, NurbsSurface], over: str) -> AxisRule:
        return fixed_axis(unit(self.direction))


class LeaningAxisTable(Table):
    """Key ``axis`` of kind ``leaning``: ``direction``, leant by ``lean_deg`` to the side that a face looks at.

    ``as_over``: for a face that does not look to a side, the name of one that does, asked at the same share of
    u in its middle.
    """

    kind: Literal["leaning"]
    direction: Direction = _UP
    lean_deg: float = Field(ge=0.0, le=85.0, allow_inf_nan=False)
    as_over: dict[str, str] = Field(default_factory=dict)

    def build(self, faces: Mapping[str, NurbsSurface], over: str) -> AxisRule:
        guide = faces[self.as_over[over]] if over in self.as_over else None
        return leaning_axis(unit(self.direction), radians(self.lean_deg), guide)


class BetweenAxisTable(Table):
    """Key ``axis`` of kind ``between``: the mean of the rulings of ``faces``, along v, at the same share of u;
    rather along ``direction`` than against it."""

    kind: Literal["between"]
    direction: Direction = _UP
    faces: tuple[str, ...] = Field(min_length=1)

    def build(self, faces: Mapping[str, NurbsSurface], over: str) -> AxisRule:
        return between_axis(tuple(faces[name] for name in self.faces), unit(self.direction))


AnyAxis = Annotated[FixedAxisTable | LeaningAxisTable | BetweenAxisTable, Field(discriminator="kind")]


def unit(direction: Direction) -> NDArray:
    """A direction with length 1, shape (3,)."""
    return np.array(direction) / float(np.linalg.norm(direction))


class LayersTable(Table):
    """An entry of [[operations]] of kind ``layers``: roughing in layers, seen from ``direction``.

    Layers are at most ``depth_mm`` deep, their lines at most ``stepover_mm`` apart; ``allowance_mm`` stays on the part.
    Rapids run ``clear_mm`` over the blank.
    """

    kind: Literal["layers"]
    name: str = "roughing"
    tool: int = 1
    direction: Direction = _UP
    depth_mm: Length
    stepover_mm: Length
    allowance_mm: LengthOrZero = 0.3
    clear_mm: Length = 2.0
    feed_mm_min: Length


class PassesTable(Table):
    """An entry of [[operations]] of kind ``passes``: a ball-nosed tool to and fro over whole ``faces``, one by one.

    ``allowances_mm`` are left on them, one after the other. A flat face is left with ridges of
    ``stepover_mm`` squared over four of the ball's diameters.
    """

    kind: Literal["passes"]
    name: str = "finishing"
    tool: int = 1
    faces: tuple[str, ...] = Field(min_length=1)
    along: Literal["u", "v"] = "u"
    axis: AnyAxis = FixedAxisTable(kind="fixed")
    stepover_mm: Length
    allowances_mm: tuple[LengthOrZero, ...] = Field(default=(0.0,), min_length=1)
    points: Count = 17
    chord_um: float = Field(default=0.5, ge=1e-3, allow_inf_nan=False)
    retract_mm: Length = 5.0
    feed_mm_min: Length


AnyOperation = Annotated[DrillTable | MillTable | LayersTable | PassesTable, Field(discriminator="kind")]


class FacedMetrologyTable(GridTable):
    """Table [metrology]: a grid of rays along the normals of every face that is machined."""

    rows: Count = 9
    columns: Count = 33
    margin: Margin = 0.01
    window_mm: Length = 0.5


class FacedScene(SequenceScene):
    """A part bounded by NURBS faces, its blank, and operations in sequence with tools by their numbers."""

    surface: FacedTable
    operations: tuple[AnyOperation, ...] = Field(min_length=1)
    metrology: FacedMetrologyTable = FacedMetrologyTable()

    @model_validator(mode="after")
    def _faces_are_there(self) -> FacedScene:
        names = [face.name for face in self.surface.faces]
        for place, name in self._named():
            if name not in names:
                raise ValueError(f"{place}: got {name!r}; [[surface.faces]] has {', '.join(names)}")
        return self

    def _named(self) -> Iterator[tuple[str, str]]:
        for i, operation in enumerate(self.operations):
            if isinstance(operation, PassesTable):
                yield from ((f"operations.{i}.faces", name) for name in operation.faces)
                if isinstance(operation.axis, BetweenAxisTable):
                    yield from ((f"operations.{i}.axis.faces", name) for name in operation.axis.faces)
                if isinstance(operation.axis, LeaningAxisTable):
                    guides = operation.axis.as_over.items()
                    yield from ((f"operations.{i}.axis.as_over", name) for pair in guides for name in pair)

    def part(self, folder: Path) -> FacedPart:
        return self.surface.build(folder, self.metrology.window_mm)
