"""The operations that make a bevel slot, in their order, as one CL program: each with its own tool."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import NamedTuple

import numpy as np

from gearsim.cutters.profile import Profile
from gearsim.motion.sources import CLMotion
from gearsim.programs.cldata import CLPath, CLProgram, CLTool, assemble, is_apt, sizes_of
from gearsim.scene import FlankMillingScene
from gearsim.scene.slot_operations import OperationTable
from gearsim.surfaces.patch import SIDES, Side, Tooth
from gearsim.toolpaths.indexing import indexed
from gearsim.toolpaths.interference import critical_depth, rough_paths
from gearsim.toolpaths.lengthwise_line import LengthwiseLine
from gearsim.toolpaths.links import clear_rapids
from gearsim.toolpaths.root import RootPlan
from gearsim.toolpaths.slot_clearance import SlotClearance
from gearsim.toolpaths.tangent import FlankPass

_STATIONS = 17


class Tool(NamedTuple):
    """A cutter and what stands above it."""

    cutter: Profile
    holder: Profile | None


@dataclass(frozen=True)
class Step:
    """One operation's passes by their names, and the tool they are run with."""

    tool: Tool
    feed: float
    passes: Sequence[tuple[str, CLMotion]]


@dataclass(frozen=True)
class SlotProgram:
    """The CL program of a slot, the tools of its numbers, and what must be told of them."""

    program: CLProgram
    tools: tuple[Tool, ...]
    notes: tuple[str, ...]


def slot_program(scene: FlankMillingScene, tooth: Tooth, planners: Mapping[Side, FlankPass]) -> SlotProgram:
    """Roughing, semi-finishing, finishing and root of a scene, as far as it asks for them, rapids clear of the blank.

    Raises InputError where a tool does not fit the slot.
    """
    slot, line = SlotClearance(tooth.patches), planners[SIDES[0]].line
    rough, notes = _roughing(scene, slot, line)
    steps = [*rough, *_semi_finishing(scene, slot), _finishing(scene, planners), *_root(scene, tooth)]
    tools = tuple(dict.fromkeys(step.tool for step in steps))
    paths: list[CLPath] = []
    for tool, run in groupby(steps, key=lambda step: step.tool):
        passes = [CLPath(name, m.tips, m.axes, feed=step.feed) for step in run for name, m in step.passes]
        passes = indexed(passes, tooth.blank.teeth, scene.toolpath.spaces or 1)
        retract = scene.toolpath.retract_mm
        linked = clear_rapids(assemble(passes, retract, tool.cutter), tool.cutter, tooth.blank.stock, retract)
        paths += [replace(path, tool=tools.index(tool)) for path in linked.paths]
    return SlotProgram(CLProgram(tuple(paths), _cl_tools(tools)), tools, notes)


def _cl_tools(tools: Sequence[Tool]) -> tuple[CLTool, ...]:
    """How the program names its tools: a single one by its sizes, several by numbers from 1, too."""
    if len(tools) == 1:
        return (CLTool(sizes=sizes_of(tools[0].cutter)),)
    return tuple(
        CLTool(str(k + 1), sizes_of(tool.cutter) if is_apt(tool.cutter) else None) for k, tool in enumerate(tools)
    )


def _roughing(
    scene: FlankMillingScene, slot: SlotClearance, line: LengthwiseLine
) -> tuple[list[Step], tuple[str, ...]]:
    table, points = scene.roughing, scene.toolpath.points
    if table is None:
        return [], ()
    cutter = table.cutter()
    paths = rough_paths(line, slot, cutter, table.strategy, table.depth_mm, table.allowance_mm)
    found = critical_depth(line, slot, cutter, table.strategy, np.linspace(*line.face, _STATIONS))
    i = int(np.argmax(found.lift))
    what, cone = slot.patches[found.met.patch[i]].name, float(line.blank.cone_height(found.met.place[i])[0])
    note = (
        f"roughing by strategy {table.strategy} takes {len(paths)} passes and stops {paths[-1].lift:.3f} mm over the "
        f"root; its tool would cut the {what} at cone distance {cone:.2f} mm from a depth of {found.depth[i]:.3f} mm "
        f"under the pitch cone on, {found.lift[i]:.3f} mm over the root"
    )
    motions = [path.cl_motion(points) for path in paths]
    return [_step(scene, table, [(f"roughing-{k + 1}", m) for k, m in enumerate(_to_and_fro(motions))])], (note,)


def _semi_finishing(scene: FlankMillingScene, slot: SlotClearance) -> list[Step]:
    table = scene.semi_finishing
    if table is None:
        return []
    cutter, passes = table.cutter(), []
    for side in SIDES:
        planner = scene.surface.planner(side, cutter, scene.toolpath.run_mm, table.allowance_mm)
        planner.check_passage()
        motion = planner.cl_motion(scene.toolpath.points)
        every = np.linspace(0, len(motion.tips) - 1, _STATIONS).astype(int)
        slot.require_room(
            cutter, motion.tips[every], motion.axes[every], 0.0, f"the semi-finishing pass of the {side} flank",
            "choose a smaller bottom radius, fillet or allowance",
        )  # fmt: skip
        passes.append((f"semi-{side}", motion))
    return [_step(scene, table, passes)]


def _finishing(scene: FlankMillingScene, planners: Mapping[Side, FlankPass]) -> Step:
    passes = []
    for side, planner in planners.items():
        planner.check_passage()
        passes.append((side, planner.cl_motion(scene.toolpath.points)))
    return Step(Tool(scene.tool(), scene.held()), scene.toolpath.feed_mm_min, passes)


def _root(scene: FlankMillingScene, tooth: Tooth) -> list[Step]:
    table = scene.root
    if table is None:
        return []
    plan = RootPlan(tooth, table.cutter(), 1e-3 * table.ridge_um, scene.toolpath.run_mm)
    motions = _to_and_fro([path.cl_motion(scene.toolpath.points) for path in plan.paths])
    return [_step(scene, table, [(f"root-{k + 1}", m) for k, m in enumerate(motions)])]


def _step(scene: FlankMillingScene, table: OperationTable, passes: Sequence[tuple[str, CLMotion]]) -> Step:
    return Step(Tool(table.cutter(), table.held(scene.nose)), table.feed_mm_min or scene.toolpath.feed_mm_min, passes)


def _to_and_fro(motions: Sequence[CLMotion]) -> list[CLMotion]:
    """Every second motion backwards, so that each begins where the one before it ends."""
    return [CLMotion(m.tips[::-1], m.axes[::-1]) if k % 2 else m for k, m in enumerate(motions)]
