"""Which closed forms a scene declares; a scene of a kind not listed has none."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from gearsim.motion.sources import CLMotion, CurveMotion
from gearsim.processes.cl_tools import cl_cutters
from gearsim.processes.run import plan
from gearsim.programs.cldata import RAPID, parse_cl, read_cl_text
from gearsim.scene import (
    CylindricalGearScene,
    EnvelopeScene,
    FaceMillingScene,
    FlankMillingScene,
    HypoidScene,
    Scene,
)
from gearsim.surfaces.cylindrical_gear import SIDES as GEAR_SIDES
from gearsim.surfaces.face_milled import FaceMilledTooth
from gearsim.surfaces.involute import InvoluteFlank
from gearsim.surfaces.patch import SIDES
from gearsim.verify.bevel_tooth import tooth_forms
from gearsim.verify.closed_form import ClosedForm, envelope_forms, pose_forms
from gearsim.verify.involute import flank_form


def closed_forms(scene: Scene, folder: Path) -> list[ClosedForm]:
    """The closed forms a scene declares; ``folder`` is where its files are looked up."""
    return next((declare(scene, folder) for kind, declare in FORMS.items() if isinstance(scene, kind)), [])


def _flank_milling(scene: FlankMillingScene, folder: Path) -> list[ClosedForm]:
    """The envelopes of the cutter's profile elements under each flank's planned path, or each path of its CL file."""
    cutter, table = scene.tool(), scene.toolpath
    if table.file is not None:
        program = parse_cl(read_cl_text(folder / table.file), str(folder / table.file))
        cutters, _ = cl_cutters(program, table.file, cutter)
        cuts = [p for p in program.paths if p.name != RAPID]
        names = [_numbered([p.name for p in cuts[: i + 1]]) for i in range(len(cuts))]
        forms = (envelope_forms(CLMotion(p.tips, p.axes), cutters[p.tool], n) for n, p in zip(names, cuts, strict=True))
        return [form for of_path in forms for form in of_path]
    return [form for side, p in scene.planners().items() for form in envelope_forms(p.motion, cutter, side)]


def _numbered(names: list[str]) -> str:
    """The last of some names, with its number from the second of that name on."""
    count = names.count(names[-1])
    return names[-1] if count == 1 else f"{names[-1]} {count}"


def _envelope(scene: EnvelopeScene, _: Path) -> list[ClosedForm]:
    """The cutter's envelopes under the program as theory, CL data and both ways of interpolating see it."""
    job = plan(scene)
    return [f for v in job.variants for source in v.motions() for f in envelope_forms(source, v.cutter, v.name)]


def _face_milling(scene: FaceMillingScene, _: Path) -> list[ClosedForm]:
    tooth = scene.tooth()
    tooth.check()
    return _head(tooth, "") + tooth_forms(tooth, tooth.patches)


def _hypoid(scene: HypoidScene, _: Path) -> list[ClosedForm]:
    pinion = scene.pinion()
    pinion.check()
    if pinion.concave == pinion.convex:
        return _head(pinion.concave, "") + tooth_forms(pinion.concave, pinion.concave.patches)
    forms = []
    for side in SIDES:
        cut = pinion.cut(side)
        forms += _head(cut, side) + tooth_forms(cut, [p for p in pinion.patches if p.side == side])
    return forms


def _head(tooth: FaceMilledTooth, flank: str) -> list[ClosedForm]:
    """A head's envelopes under the generating roll, or the head as it stands at either end of its plunge."""
    motion = CurveMotion(tooth.poses, *tooth.motion_range)
    make = envelope_forms if tooth.generated else pose_forms
    return make(motion, tooth.head, flank)


def _cylindrical_gear(scene: CylindricalGearScene, _: Path) -> list[ClosedForm]:
    """Both flanks as the finishing end mill generates them, without modification."""
    gear, radius = scene.gear(), scene.finishing().cutting.radius
    return [flank_form(InvoluteFlank(gear, side), radius) for side in GEAR_SIDES]


FORMS: dict[type[Scene], Callable[[Any, Path], list[ClosedForm]]] = {
    FlankMillingScene: _flank_milling,
    EnvelopeScene: _envelope,
    FaceMillingScene: _face_milling,
    HypoidScene: _hypoid,
    CylindricalGearScene: _cylindrical_gear,
}
