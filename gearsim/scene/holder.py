"""Table [holder], and whatever else stands above a cutter's flutes and must touch nothing."""

from __future__ import annotations

from pydantic import Field, model_validator

from gearsim.cutters.holder import UPPER, Holder, Section, standing_on
from gearsim.cutters.profile import Profile
from gearsim.scene.catalogue import MillTable
from gearsim.scene.tables import Length, Table


class HolderTable(Table):
    """A shank on the cutter's top, and a holder on the shank.

    ``sections_mm``: lower diameter, upper diameter and length of the holder's pieces, from the shank up.
    """

    shank_diameter_mm: Length | None = None
    shank_length_mm: Length | None = None
    sections_mm: tuple[tuple[Length, Length, Length], ...] = Field(default=())

    @model_validator(mode="after")
    def _something(self) -> HolderTable:
        if (self.shank_diameter_mm is None) != (self.shank_length_mm is None):
            raise ValueError("shank_diameter_mm and shank_length_mm belong together; give both or none")
        if self.shank_diameter_mm is None and not self.sections_mm:
            raise ValueError("empty; give shank_diameter_mm with shank_length_mm, sections_mm, or both")
        return self

    def bodies(self) -> list[tuple[str, tuple[Section, ...]]]:
        """Shank and holder, as far as they are given."""
        found: list[tuple[str, tuple[Section, ...]]] = []
        if self.shank_diameter_mm is not None and self.shank_length_mm is not None:
            found.append(("shank", ((self.shank_diameter_mm, self.shank_diameter_mm, self.shank_length_mm),)))
        return found + [("holder", self.sections_mm)] * bool(self.sections_mm)


def above(table: MillTable, held: HolderTable | None, nose: tuple[Section, ...] = ()) -> Holder | None:
    """What stands above a cutter's flutes: its own upper part, what holds it, the spindle's nose.

    None where nothing of it is given. Raises InputError where that can be no body.
    """
    if table.flute_length_mm is None and held is None and not nose:
        return None
    return standing_on(table.build(), table.flute_length_mm, _held(held, nose))


def above_mill(
    mill: Profile, length: float | None, held: HolderTable | None, nose: tuple[Section, ...] = ()
) -> Holder | None:
    """The same of an end mill that is as high as its flutes, and goes on as thick to a ``length`` [mm] (None: not)."""
    if length is None or length <= mill.height:
        return standing_on(mill, None, _held(held, nose))
    wide = 2.0 * mill.max_radius
    return standing_on(mill, None, [(UPPER, ((wide, wide, length - mill.height),)), *_held(held, nose)])


def _held(held: HolderTable | None, nose: tuple[Section, ...]) -> list[tuple[str, tuple[Section, ...]]]:
    return [*([] if held is None else held.bodies()), *[("spindle nose", nose)] * bool(nose)]
