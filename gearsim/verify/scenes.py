"""The closed forms that scenes declare, in the form in which they are checked."""

from __future__ import annotations

from pathlib import Path

from gearsim.processes.claims import Claim, Involute, Standing, Swept
from gearsim.processes.run import claims
from gearsim.scene import Scene
from gearsim.verify.bevel_tooth import tooth_forms
from gearsim.verify.closed_form import ClosedForm, envelope_forms, pose_forms
from gearsim.verify.involute import flank_form


def closed_forms(scene: Scene, folder: Path) -> list[ClosedForm]:
    """The closed forms a scene declares; ``folder`` is where its files are looked up."""
    return [form for claim in claims(scene, folder) for form in _forms(claim)]


def _forms(claim: Claim) -> list[ClosedForm]:
    if isinstance(claim, Swept):
        return envelope_forms(claim.source, claim.cutter, claim.name)
    if isinstance(claim, Standing):
        return pose_forms(claim.source, claim.cutter, claim.name)
    if isinstance(claim, Involute):
        return [flank_form(claim.flank, claim.radius)]
    return tooth_forms(claim.tooth, claim.patches)
