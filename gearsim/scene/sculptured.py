"""Scenes of local gouging: 3-axis passes over a NURBS surface, and contacts of which only numbers are known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError, is_file
from gearsim.gouging.khan.worked_sections import SECTIONS, worked_rows
from gearsim.gouging.standard_mills import khan_mills, metric_mills, ranked
from gearsim.scene.base import Scene
from gearsim.scene.catalogue import AnyCutter, AnyMill
from gearsim.scene.holder import HolderTable, above
from gearsim.scene.tables import Count, GridTable, Length, LengthOrZero, Table
from gearsim.surfaces.nurbs import NurbsSurface
from gearsim.surfaces.nurbs_file import load_surfaces

Share = Annotated[float, Field(ge=0.0, le=1.0, allow_inf_nan=False)]
Margin = Annotated[float, Field(ge=0.0, lt=0.5, allow_inf_nan=False)]


class NurbsTable(Table):
    """Table [surface] of kind ``nurbs``: a shipped control net by name or a file (JSON, IGES, STEP)."""

    kind: Literal["nurbs"]
    file: str = Field(min_length=1)
    number: int = Field(default=1, ge=1)

    def build(self, folder: Path, window: float = 0.0) -> NurbsSurface:
        """The surface; relative files are looked up in ``folder``. Raises InputError where there is none."""
        beside = folder / self.file
        found = load_surfaces(beside if is_file(beside) else self.file)
        if self.number > len(found):
            raise InputError(f"surface.number: {self.file} holds {len(found)} surfaces, got {self.number}")
        return replace(found[self.number - 1], window=window)


class SculpturedPathTable(Table):
    """Table [toolpath]: ``contact`` follows contact points along u or v, ``drop`` lowers the tool along x or y."""

    kind: Literal["contact", "drop"] = "contact"
    along: Literal["u", "v", "x", "y"]
    stepover_mm: Length
    points: Count = 33
    margin: Margin = 0.02
    chord_um: float = Field(default=0.1, ge=1e-3, allow_inf_nan=False)

    @model_validator(mode="after")
    def _fits(self) -> SculpturedPathTable:
        right = ("u", "v") if self.kind == "contact" else ("x", "y")
        if self.along not in right:
            raise ValueError(f"passes of kind {self.kind!r} run along {' or '.join(right)}, got {self.along!r}")
        return self


class MillsTable(Table):
    """Table [catalogue]: the end mills to choose from, by name or as pairs R, r [mm]; ``margin`` of the surface.

    The margin's default is that of ``gearsim gouge``: none, the border is looked at in the sector of the surface.
    """

    mills: Literal["khan", "metric"] | tuple[tuple[Length, LengthOrZero], ...] = "khan"
    margin: Margin = 0.0

    def build(self) -> NDArray:
        """(R, r) [mm], shape (m, 2), the largest first. Raises InputError for a corner larger than its mill."""
        if isinstance(self.mills, str):
            return khan_mills() if self.mills == "khan" else metric_mills()
        if not self.mills:
            raise InputError("catalogue.mills: got []; wanted are 'khan', 'metric', or one or more pairs R, r [mm]")
        mills = np.array(self.mills)
        for shank, corner in mills:
            if corner > shank:
                raise InputError(f"catalogue.mills: the corner radius {corner:g} mm exceeds the mill's, {shank:g} mm")
        return ranked(mills)


class GougingMetrologyTable(GridTable):
    """Table [metrology]: what is measured; overcut deeper than the tolerance is attributed and fails the tool."""

    tolerance_um: Length = 1.0
    rows: Count = 65
    columns: Count = 65
    margin: Margin = 0.02
    window_mm: Length = 5.0
    ring_mm: Length = 0.25

    @property
    def samples(self) -> int:
        """Mills are chosen on as many rows as columns."""
        return int(max(self.rows, self.columns)) ** 2


class PlotTable(Table):
    """Table [plot]: the contact whose curvatures are drawn, as shares of the domain."""

    u: Share = 0.5
    v: Share = 0.5


class WorkedTable(Table):
    """Table [reference]: worked examples printed beside ours, by section and the beginning of their names."""

    sections: tuple[str, ...] = Field(min_length=1)
    names: tuple[str, ...] = ()

    @model_validator(mode="after")
    def _known(self) -> WorkedTable:
        for section in self.sections:
            if section not in SECTIONS:
                raise ValueError(f"no worked example in section {section!r}; there are {', '.join(SECTIONS)}")
        for name in self.names:
            if not name or not worked_rows(self.sections, (name,)):
                begin = ", ".join(dict.fromkeys(row.quantity.partition(":")[0] for row in worked_rows(self.sections)))
                raise ValueError(f"names: no worked example of these sections begins with {name!r}; there are {begin}")
        return self


class SculpturedScene(Scene):
    """A NURBS surface cut by a tool, and by a larger and a printed one for comparison, with gouging predicted.

    The [holder] is that of the [cutter].
    """

    surface: NurbsTable
    cutter: AnyMill
    holder: HolderTable | None = None
    larger: AnyCutter | None = None
    printed: AnyCutter | None = None
    toolpath: SculpturedPathTable
    catalogue: MillsTable = MillsTable()
    metrology: GougingMetrologyTable = GougingMetrologyTable()
    plot: PlotTable = PlotTable()
    reference: WorkedTable | None = None

    @model_validator(mode="after")
    def _chord_below(self) -> SculpturedScene:
        if self.toolpath.chord_um >= self.metrology.tolerance_um:
            raise ValueError(
                "toolpath.chord_um must be below metrology.tolerance_um, or straight steps would pass for gouging"
            )
        return self

    def tools(self) -> dict[str, Profile]:
        """The cutters by what they are here, the chosen one first."""
        given: dict[str, Any] = {"chosen": self.cutter, "larger": self.larger, "printed": self.printed}
        return {name: table.build() for name, table in given.items() if table is not None}

    def held(self) -> Profile | None:
        """What stands above the chosen cutter's flutes, where it is given."""
        return above(self.cutter, self.holder)

    def builders(self) -> tuple[Callable[[], object], ...]:
        return (self.tools, self.held, self.catalogue.build)


class GougeExampleTable(Table):
    """Table [surface] of kind ``gouge-example``: contacts known by their curvatures only."""

    kind: Literal["gouge-example"]


class GougeExampleScene(Scene):
    """Worked examples of which only numbers are printed: compared and drawn, nothing is cut."""

    surface: GougeExampleTable
    reference: WorkedTable

    def builders(self) -> tuple[Callable[[], object], ...]:
        return ()
