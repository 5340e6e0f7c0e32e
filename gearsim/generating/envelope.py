"""Envelope scenes: one NC program as theory, CL data and a machine's two ways of interpolating see it."""

from __future__ import annotations

import numpy as np

from gearsim.envelope import EnvelopePatch
from gearsim.errors import InputError
from gearsim.generating.job import Cut, GeneratingJob
from gearsim.machines.chain import Machine
from gearsim.motion.axes import AxisMotion, tip_control
from gearsim.motion.guiding import guided, line
from gearsim.motion.sources import CLMotion, MotionSource
from gearsim.programs.cldata import CLPath, CLProgram, format_cl
from gearsim.scene.generated import AxisPointsTable, EnvelopeScene

BRANCH = {"left": 1.0, "right": -1.0}
TEXTS = {
    "theory": "theoretical motion: tip and top of the tool guided along two straight lines",
    "cl": "CL data: straight tip line, the axis turning at a constant rate",
    "tcp": "NC program with tool-centre-point control: straight tip line, rotary axes linear",
    "linear": "NC program without it: all axes linear",
}


def plan_envelope(scene: EnvelopeScene) -> GeneratingJob:
    """The swept tool's flanks under the theoretical motion, and the motions measured against them."""
    cutter, machine = scene.tool(), scene.controller()
    values = axis_values(scene.toolpath, machine)
    tips, axes = machine.forward(values)
    tops = tips + cutter.height * axes
    sources: dict[str, MotionSource] = {
        "theory": guided(line(tips[0], tips[1]), line(tops[0], tops[1])),
        "cl": CLMotion(tips, axes),
        "tcp": tip_control(machine, values),
        "linear": AxisMotion(machine, values),
    }
    elements = tuple(i for i, e in enumerate(cutter.elements) if not e.is_flat)
    patches = tuple(
        EnvelopePatch(f.name, sources["theory"], cutter, elements, BRANCH[f.side], scene.surface.window_mm)
        for f in scene.surface.flanks
    )
    program = CLProgram((CLPath("nc", tips, axes),), cutter)
    programs = {"toolpath.cl": format_cl(program, scene.name, 600.0, 9)}
    cut = Cut(cutter, patches, sources)
    return GeneratingJob(scene, (cut,), TEXTS, "workpiece frame of the NC program", programs)


def axis_values(table: AxisPointsTable, machine: Machine) -> np.ndarray:
    """The program's points in the machine's axis order, shape (n, k) [mm, rad].

    Raises InputError where the table's axes are not the machine's.
    """
    if set(table.axes) != set(machine.axes):
        raise InputError(
            f"toolpath.axes are {', '.join(table.axes)}; machine {machine.name} has {', '.join(machine.axes)}"
        )
    columns = np.array(table.points).T
    turned = {j.name for j in machine.joints if j.is_rotary}
    given = {a: np.radians(c) if a in turned else c for a, c in zip(table.axes, columns, strict=True)}
    return machine.values(**given)
