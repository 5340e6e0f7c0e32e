"""Parts from the surface tables of scenes, whatever cuts them."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from gearsim.metrology.dexel_check import slot_box
from gearsim.metrology.gear_section import space_box
from gearsim.processes.frames import FACE_FRAME, GEAR_FRAME, NET_FRAME
from gearsim.scene.any_program import AnySurface
from gearsim.scene.cylindrical import CylindricalGearTable
from gearsim.scene.sculptured import NurbsTable
from gearsim.simulation.dexels import DexelBox
from gearsim.surfaces.cylindrical_gear import SIDES as GEAR_SIDES
from gearsim.surfaces.gear_stock import gear_stock
from gearsim.surfaces.part import Intended, Part, Tolerance
from gearsim.surfaces.patch import SIDES, Tooth
from gearsim.surfaces.reached_flank import ReachedFlank


class Limits(NamedTuple):
    """Tolerances of working surfaces and of roots."""

    flank: Tolerance
    root: Tolerance


def bevel_part(tooth: Tooth, mate_teeth: int, limits: Limits) -> Part:
    """A bevel gear's slot: flanks, fillets and bottom land, cut into its blank. Raises InputError for no gear's."""
    tooth.check()
    surfaces: dict[str, Intended] = {side: Intended(tooth.flank(side), limits.flank) for side in SIDES}
    surfaces |= {p.name: Intended(p, limits.root) for p in tooth.patches if p.part != "flank"}
    return Part(GEAR_FRAME, tooth.blank.stock, surfaces, tooth.blank.mate(mate_teeth).stock)


def part_of(
    surface: AnySurface, folder: Path, limits: Limits, window: float, pitch: float
) -> tuple[Part, DexelBox | None]:
    """The part that a surface table describes, and the box of its tri-dexel with rays ``pitch`` [mm] apart.

    ``window`` [mm] is how far from a surface without a blank the machined one is looked for; then there is no box.
    """
    if isinstance(surface, NurbsTable):
        net = surface.build(folder, window)
        return Part(NET_FRAME, None, {net.name: Intended(net, limits.flank)}), None
    if isinstance(surface, CylindricalGearTable):
        gear = surface.gear()
        ends = gear.root_roll, gear.tip_roll
        flanks = {str(s): Intended(ReachedFlank(gear, s, 0, surface.design(), ends), limits.flank) for s in GEAR_SIDES}
        return Part(FACE_FRAME, gear_stock(gear, surface.rim_mm), flanks), space_box(gear, pitch)
    tooth = surface.build()
    return bevel_part(tooth, surface.mate_teeth, limits), slot_box(tooth.patches, tooth.blank, pitch)
