"""The path of a flank-milled tooth as a program for a five-axis machine.

The gear lies on its back: the program's frame has the gear frame's x, and its y and z turned over, so that the
teeth look up to the spindle. Its origin is that of the gear frame, the apex of the pitch cone.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.geometry.rigid import Rigid
from gearsim.programs.cldata import RAPID, CLProgram, apt_parameters
from gearsim.programs.operation import Operation, Tool
from gearsim.programs.path_blocks import blocks_from_cl
from gearsim.programs.post import write_program
from gearsim.programs.post_options import Header
from gearsim.scene import FlankMillingScene
from gearsim.scene.program import ProgramTable

CLAMPED = Rigid(np.diag([1.0, -1.0, -1.0]), np.zeros(3))


def machine_program(scene: FlankMillingScene, table: ProgramTable, cl: CLProgram, cutter: Profile) -> str:
    """The CL program, gear frame, as text for the table's machine. Neither tip nor top of the cutter exceeds its feed.

    Raises InputError where the CL data states no feed, or the machine or its control cannot do it.
    """
    if cl.feed is None:
        raise InputError("the CL data has no FEDRAT; a program for a machine needs a feed")
    paths = (replace(p, tips=CLAMPED.point(p.tips), axes=CLAMPED.direction(p.axes)) for p in cl.paths)
    blocks = blocks_from_cl(
        table.controlled(), replace(cl, paths=tuple(paths)), cl.feed, table.tip_control, reach=cutter.height
    )
    shape = ", ".join(f"{value:.6g}" for value in apt_parameters(cutter))
    tool = Tool(1, f"APT cutter {shape}", apt_parameters(cutter)[0], cutter.height, table.flutes)
    passes = [p.name for p in cl.paths if p.name != RAPID]
    operation = Operation("flank milling", tool, table.spindle_rpm, blocks, comments=(f"passes {', '.join(passes)}",))
    lines = (scene.scene.summary, "gear on its back: x, -y, -z of the gear frame, origin at the pitch apex")
    header = Header(table.number, scene.name, tuple(line for line in lines if line))
    return write_program([operation], header, table.options())
