"""What generates a head-cut tooth: the motion whose envelope its closed form is."""

from __future__ import annotations

from collections.abc import Sequence

from gearsim.motion.sources import CurveMotion
from gearsim.simulation.operation import Variant, operation
from gearsim.surfaces.face_milled import FaceMilledTooth
from gearsim.surfaces.hypoid import HypoidPinion
from gearsim.surfaces.patch import Patch, Tooth

ROLL, PLUNGE = "roll", "plunge"


def generating(tooth: Tooth | HypoidPinion | None, tolerance: float) -> tuple[Variant, ...]:
    """The head's roll or plunge, a variant for every cut of the tooth; none for a tooth that no head generates.

    They are compiled to ``tolerance`` [mm].
    """
    if isinstance(tooth, FaceMilledTooth):
        return (_variant(tooth, tooth.patches, tolerance),)
    if not isinstance(tooth, HypoidPinion):
        return ()
    both = {"concave": tooth.concave, "convex": tooth.convex}
    return tuple(_variant(cut, [p for p in tooth.patches if p.side == side], tolerance) for side, cut in both.items())


def _variant(tooth: FaceMilledTooth, patches: Sequence[Patch], tolerance: float) -> Variant:
    name, text = (
        (ROLL, "the generating roll that the intended surfaces are the envelope of")
        if tooth.generated
        else (PLUNGE, "the head's infeed, whose shape the intended surfaces are")
    )
    motion = CurveMotion(tooth.poses, *tooth.motion_range)
    return Variant(name, text, (operation(name, tooth.head, [motion], tolerance),), tuple(p.name for p in patches))
