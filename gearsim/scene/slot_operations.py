"""Tables [roughing], [semi_finishing] and [root]: what is cut of a bevel slot beside finishing its flanks."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from gearsim.cutters.holder import Section
from gearsim.cutters.profile import Profile
from gearsim.scene.catalogue import AnyMill
from gearsim.scene.holder import HolderTable, above
from gearsim.scene.tables import Length, LengthOrZero, Table


class OperationTable(Table):
    """A tool with what stands above it, and its feed (none: that of [toolpath])."""

    tool: AnyMill
    holder: HolderTable | None = None
    feed_mm_min: Length | None = None

    def cutter(self) -> Profile:
        profile: Profile = self.tool.build()
        return profile

    def held(self, nose: tuple[Section, ...] = ()) -> Profile | None:
        """What stands above the tool's flutes, the spindle's ``nose`` on top, where anything is given."""
        return above(self.tool, self.holder, nose)


class RoughingTable(OperationTable):
    """Table [roughing]: both walls in one pass, pass below pass (Zhou 2015, 4.28, 4.29).

    ``strategy`` I: the axis is normal to the root cone, II: to the pitch cone. ``depth_mm``: the most that a pass goes
    deeper than the one before; ``allowance_mm`` is left all over the slot.
    """

    strategy: Literal["I", "II"]
    depth_mm: Length
    allowance_mm: LengthOrZero


class SemiFinishingTable(OperationTable):
    """Table [semi_finishing]: a pass for each flank, as the finishing one, that leaves ``allowance_mm``."""

    allowance_mm: LengthOrZero


class RootTable(OperationTable):
    """Table [root]: passes of a ball-ended tool over fillets and bottom land; ``ridge_um`` may stand between them."""

    ridge_um: float = Field(ge=1e-3, le=1e4, allow_inf_nan=False)
