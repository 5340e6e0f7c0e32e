"""Parts of all kinds of surfaces, for programs that cut any of them."""

from __future__ import annotations

from pathlib import Path

from gearsim.metrology.dexel_check import slot_box
from gearsim.metrology.gear_section import space_box
from gearsim.processes.frames import FACE_FRAME, NET_FRAME, PINION_FRAME
from gearsim.processes.parts import Limits, bevel_part
from gearsim.scene.any_program import ProgramScene
from gearsim.scene.cylindrical import CylindricalGearTable
from gearsim.scene.generated import HypoidTable
from gearsim.scene.sculptured import NurbsTable
from gearsim.simulation.dexels import DexelBox
from gearsim.surfaces.cylindrical_gear import SIDES as GEAR_SIDES
from gearsim.surfaces.gear_stock import gear_stock
from gearsim.surfaces.hypoid import HypoidPinion
from gearsim.surfaces.part import Intended, Part
from gearsim.surfaces.patch import Tooth
from gearsim.surfaces.reached_flank import ReachedFlank


def part_of(
    scene: ProgramScene, tooth: Tooth | HypoidPinion | None, folder: Path, limits: Limits
) -> tuple[Part, DexelBox | None]:
    """The part that a scene's surface describes, and the box of its tri-dexel (None for a surface without a blank).

    ``tooth`` is the scene's own (see `ProgramScene.tooth`).

    Raises InputError where the geometry is impossible or a file of ``folder`` cannot be used.
    """
    surface, pitch = scene.surface, scene.simulation.dexel_pitch_mm
    if isinstance(surface, NurbsTable):
        net = surface.build(folder, scene.metrology.window_mm)
        return Part(NET_FRAME, None, {net.name: Intended(net, limits.flank)}), None
    if isinstance(surface, CylindricalGearTable):
        gear = surface.gear()
        ends = gear.root_roll, gear.tip_roll
        flanks = {str(s): Intended(ReachedFlank(gear, s, 0, surface.design(), ends), limits.flank) for s in GEAR_SIDES}
        return Part(FACE_FRAME, gear_stock(gear, surface.rim_mm), flanks), space_box(gear, pitch)
    assert tooth is not None
    box = slot_box(tooth.patches, tooth.blank, pitch)
    if isinstance(surface, HypoidTable):
        return bevel_part(tooth, limits, mate=None, frame=PINION_FRAME), box
    return bevel_part(tooth, limits, mate=tooth.blank.mate(surface.mate_teeth).stock), box
