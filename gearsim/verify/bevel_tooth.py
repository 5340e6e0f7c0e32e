"""The patches of a generated bevel tooth as closed forms: what scenes hold the cut against, checked by brute force."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gearsim.motion.sources import CurveMotion
from gearsim.surfaces.face_milled import FaceMilledTooth
from gearsim.surfaces.slot_patch import GeneratedPatch
from gearsim.verify.closed_form import Claimed, ClosedForm
from gearsim.verify.shared import SharedPoses


def tooth_forms(tooth: FaceMilledTooth, patches: Sequence[GeneratedPatch]) -> list[ClosedForm]:
    """One closed form for each patch: u runs from toe to heel, v from the root side up, as in `GeneratedPatch.locate`.

    ``tooth`` is the cut that makes them. Every point claims the pose that its chart says, and the curvature.
    """
    motion = SharedPoses(CurveMotion(tooth.poses, *tooth.motion_range))
    return [_patch_form(tooth, patch, motion) for patch in patches]


def _patch_form(tooth: FaceMilledTooth, patch: GeneratedPatch, motion: SharedPoses) -> ClosedForm:
    first, last = tooth.motion_range

    def points(u: NDArray, v: NDArray) -> Claimed:
        at = patch.locate(u, v)
        jet, t = patch.jet(*at), (patch.pose_parameter(*at) - first) / (last - first)
        return Claimed(jet.r, jet.normal, jet.exists, jet.curvature(), np.clip(t, 0.0, 1.0))

    return ClosedForm(f"tooth: {patch.name}", motion, tooth.head, points, patch.name)
