"""The tool's own envelope: one NC program as theory, CL data and a machine's two ways of interpolating see it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearsim.envelope import EnvelopePatch
from gearsim.errors import InputError
from gearsim.machines.chain import Machine
from gearsim.machines.path import overruns
from gearsim.metrology.job import Job
from gearsim.motion.nc_step import NCStep
from gearsim.motion.sources import MotionSource
from gearsim.processes.claims import Claim, Swept
from gearsim.processes.frames import PROGRAM_FRAME
from gearsim.processes.generated import Sweep, generated_job
from gearsim.programs.cldata import CLPath, CLProgram, CLTool, format_cl, sizes_of
from gearsim.scene.generated import AxisPointsTable, EnvelopeScene

BRANCH = {"left": 1.0, "right": -1.0}
TEXTS = {
    "theory": "theoretical motion: tip and top of the tool guided along two straight lines",
    "cl": "CL data: straight tip line, the axis turning at a constant rate",
    "tcp": "NC program with tool-centre-point control: straight tip line, rotary axes linear",
    "linear": "NC program without it: all axes linear",
}


def plan(scene: EnvelopeScene, folder: Path) -> Job:
    """The swept tool's flanks under the theoretical motion, and the motions measured against them.

    It names no files to look up in ``folder``. Raises InputError beyond the machine's travel.
    """
    cutter, machine = scene.tool(), scene.controller()
    tips, rotary = program_points(scene.toolpath, machine)
    step = NCStep(cutter, machine, tips, rotary)
    if found := overruns(machine, step.nc_axes.values):
        raise InputError(f"machine {machine.name}: " + "; ".join(str(o) for o in found))
    sources: dict[str, MotionSource] = {
        "theory": step.theoretical,
        "cl": step.cl,
        "tcp": step.nc_tip,
        "linear": step.nc_axes,
    }
    elements = tuple(i for i, e in enumerate(cutter.elements) if not e.is_flat)
    patches = tuple(
        EnvelopePatch(f.name, sources["theory"], cutter, elements, BRANCH[f.side], scene.surface.window_mm)
        for f in scene.surface.flanks
    )
    program = CLProgram((CLPath("nc", tips, step.axes),), (CLTool(sizes=sizes_of(cutter)),))
    programs = {"toolpath.cl": format_cl(program, scene.name, 600.0, 9)}
    cut = Sweep(cutter, patches, sources)
    return generated_job(scene, [cut], TEXTS, PROGRAM_FRAME, files=programs)


def program_points(table: AxisPointsTable, machine: Machine) -> tuple[NDArray, NDArray]:
    """Tips (n, 3) [mm] and rotary axes (n, r) [rad], in the machine's order, of the program's points.

    Raises InputError where the table's axes are not X, Y, Z and the machine's rotary ones.
    """
    turned = [j.name for j in machine.joints if j.is_rotary]
    wanted = ["X", "Y", "Z", *turned]
    if sorted(table.axes) != sorted(wanted):
        raise InputError(
            f"toolpath.axes are {', '.join(table.axes)}; a program for {machine.name} has {', '.join(wanted)}"
        )
    columns = dict(zip(table.axes, np.array(table.points).T, strict=True))
    tips = np.column_stack([columns[name] for name in "XYZ"])
    return tips, np.radians(np.column_stack([columns[name] for name in turned]))


def claims(scene: EnvelopeScene, folder: Path) -> list[Claim]:
    """The cutter's envelopes under the program as theory, CL data and both ways of interpolating see it."""
    return [Swept(source, v.cutter, v.name) for v in plan(scene, folder).variants for source in v.motions()]
