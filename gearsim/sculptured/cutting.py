"""One tool's passes cut, measured, and set against its predicted local gouging."""

from __future__ import annotations

import numpy as np

from gearsim.cutters.profile import Profile
from gearsim.geometry.rays import RayBundle
from gearsim.gouging.attribution import (
    Attribution,
    attribute,
    segment_ends,
    straight_distance,
    tool_distance,
)
from gearsim.gouging.prediction import Prediction, predict, predict_path
from gearsim.gouging.rings import RingResult, read_rings, rings
from gearsim.metrology.deviation import Deviation
from gearsim.metrology.machine import MachineFor, MeasuringMachine
from gearsim.metrology.samples import SampleGrid
from gearsim.motion.segments import SegmentTable, compile_motion
from gearsim.result import ToolCut
from gearsim.scene import SculpturedScene
from gearsim.sculptured.job import SculpturedJob, ToolPass
from gearsim.toolpaths.sculptured import SculpturedPath

_CHECKED = 300


def cut_with(job: SculpturedJob, tool: ToolPass, grid: SampleGrid, machine_for: MachineFor) -> ToolCut:
    """Cut the surface with one tool and say what made every overcut sample."""
    assert isinstance(job.scene, SculpturedScene)
    assert job.surface is not None
    surface, cutter, machine = job.surface, tool.cutter, machine_for(tool.cutter)
    tolerance = 1e-3 * job.scene.metrology.tolerance_um
    found = predict_path(surface, cutter, tool.path)
    rays = grid.rays()
    deviation = machine.measure([rays], tool.table)[0]
    at = grid.phi.ravel(), grid.v.ravel()
    made = attribute(surface, cutter, tool.path, tool.table, deviation, at, tolerance)
    return ToolCut(
        cutter=cutter,
        path=tool.path,
        segments=len(tool.table),
        contacts=found,
        samples=predict(surface, cutter, *at),
        deviation=deviation.reshaped(grid.shape),
        made=Attribution(*(x.reshape(grid.shape) for x in (made.cause, made.contact, made.apart))),
        rings=_rings(job, tool, found, machine),
        check_um=_check(cutter, tool.path, tool.table, rays, deviation),
        machine=machine_figures(machine),
    )


def _rings(job: SculpturedJob, tool: ToolPass, found: Prediction, machine: MeasuringMachine) -> RingResult:
    """Contacts cut one by one."""
    assert isinstance(job.scene, SculpturedScene)
    assert job.surface is not None
    step = job.scene.metrology.ring_mm
    asked = rings(job.surface, tool.cutter, tool.path, found, step)
    table = compile_motion(asked.standing, tool.cutter.reach)
    return read_rings(asked, found, machine.measure([asked.rays], table)[0], step)


def machine_figures(machine: MeasuringMachine) -> dict[str, float]:
    """What the machine has done so far."""
    return {"rays": machine.rays, "pairs": machine.pairs, "candidates": machine.candidates, "kernel": machine.kernel_s}


def _check(
    cutter: Profile, path: SculpturedPath, table: SegmentTable, rays: RayBundle, deviation: Deviation
) -> float:  # fmt: skip
    """Largest distance [um] of machined points from the tool over the whole path, by a search that shares no code.

    A machined point must touch the tool at the nearest move and be inside it at none.
    """
    measured = np.flatnonzero(deviation.measured)
    chosen = measured[:: max(1, len(measured) // _CHECKED)]
    points = rays.origin[chosen] + deviation.value[chosen, None] * rays.direction[chosen]
    ends = segment_ends(path, table)
    start, end = path.touches.tip[ends[:, 0]], path.touches.tip[ends[:, 1]]
    at_start = tool_distance(cutter, start, points[:, None])
    least = at_start.min(axis=1, keepdims=True)
    point, move = np.nonzero(at_start - np.linalg.norm(end - start, axis=1) <= least + 1e-9)  # no other can be nearer
    distance = straight_distance(cutter, start[move], end[move], points[point])
    nearest = np.full(len(points), np.inf)
    np.minimum.at(nearest, point, distance)
    return 1e3 * float(np.max(np.abs(nearest), initial=0.0))
