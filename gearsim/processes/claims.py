"""Closed forms that a scene declares, as data: planners make them, `gearsim verify` checks them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from gearsim.cutters.profile import Profile
from gearsim.motion.sources import CurveMotion, MotionSource
from gearsim.surfaces.face_milled import FaceMilledTooth
from gearsim.surfaces.hypoid import HypoidPinion
from gearsim.surfaces.involute import InvoluteFlank
from gearsim.surfaces.patch import SIDES
from gearsim.surfaces.slot_patch import GeneratedPatch


@dataclass(frozen=True)
class Swept:
    """The envelopes of a cutter's profile elements under a motion, which is called ``name``."""

    source: MotionSource
    cutter: Profile
    name: str


@dataclass(frozen=True)
class Standing:
    """A cutter's profile elements as they stand at either end of a motion, which is called ``name``."""

    source: MotionSource
    cutter: Profile
    name: str


@dataclass(frozen=True)
class ToothPatches:
    """Patches of a head-cut tooth in its own coordinates."""

    tooth: FaceMilledTooth
    patches: Sequence[GeneratedPatch]


@dataclass(frozen=True)
class Involute:
    """An involute flank as an end mill of a radius [mm] generates it."""

    flank: InvoluteFlank
    radius: float


Claim = Swept | Standing | ToothPatches | Involute


def head_claims(tooth: FaceMilledTooth | HypoidPinion) -> list[Claim]:
    """What is known of a head-cut tooth: the head's own envelopes, or the head at rest, and the tooth's patches.

    Raises InputError for a slot that no gear has.
    """
    tooth.check()
    if isinstance(tooth, FaceMilledTooth):
        return [_head(tooth, ""), ToothPatches(tooth, tooth.patches)]
    if tooth.concave == tooth.convex:
        return [_head(tooth.concave, ""), ToothPatches(tooth.concave, tooth.concave.patches)]
    claims: list[Claim] = []
    for side in SIDES:
        cut = tooth.cut(side)
        claims += [_head(cut, side), ToothPatches(cut, [p for p in tooth.patches if p.side == side])]
    return claims


def _head(tooth: FaceMilledTooth, flank: str) -> Claim:
    make = Swept if tooth.generated else Standing
    return make(CurveMotion(tooth.poses, *tooth.motion_range), tooth.head, flank)
