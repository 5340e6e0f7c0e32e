"""Parts of bevel gears, whatever cuts them."""

from __future__ import annotations

from typing import NamedTuple

from gearsim.geometry.turned import Turned
from gearsim.metrology.tooth_check import ToothInspection
from gearsim.processes.frames import GEAR_FRAME
from gearsim.scene.bevel import ToothTable
from gearsim.surfaces.face_milled import FaceMilledTooth
from gearsim.surfaces.hypoid import HypoidPinion
from gearsim.surfaces.part import Intended, Part, Tolerance
from gearsim.surfaces.patch import SIDES, Tooth


class Limits(NamedTuple):
    """Tolerances of working surfaces and of roots."""

    flank: Tolerance
    root: Tolerance


def bevel_part(tooth: Tooth | HypoidPinion, limits: Limits, *, mate: Turned | None, frame: str = GEAR_FRAME) -> Part:
    """A bevel gear's slot: flanks, fillets and bottom land, cut into its blank. Raises InputError for no gear's."""
    tooth.check()
    surfaces: dict[str, Intended] = {side: Intended(tooth.flank(side), limits.flank) for side in SIDES}
    surfaces |= {p.name: Intended(p, limits.root) for p in tooth.patches if p.part != "flank"}
    return Part(frame, tooth.blank.stock, surfaces, mate)


def held(variant: str, tooth: Tooth | HypoidPinion | None, demand: ToothTable | None) -> tuple[ToothInspection, ...]:
    """How a tooth that a head generates is held against its blank; nothing for another."""
    if not isinstance(tooth, FaceMilledTooth | HypoidPinion):
        return ()
    return (ToothInspection(variant, tooth, (demand or ToothTable()).build()),)
