"""Table [holder]: what stands above a cutter and must touch nothing."""

from __future__ import annotations

from pydantic import Field, model_validator

from gearsim.cutters.holder import holder
from gearsim.cutters.profile import Profile
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

    def build(self, height: float) -> Profile:
        """What stands above a cutter of a height [mm], in its frame."""
        sections = self.sections_mm
        if self.shank_diameter_mm is not None and self.shank_length_mm is not None:
            sections = ((self.shank_diameter_mm, self.shank_diameter_mm, self.shank_length_mm), *sections)
        return holder(height, sections)
