"""Where an internal gear's flank is as hollow as the tool is thick, programs of three decimals gouge: by both roads."""

from math import cos

import numpy as np
import pytest

from gearsim.envelope import machined_along
from gearsim.geometry.rays import RayBundle
from gearsim.metrology.deviation import measure
from gearsim.metrology.roads import road_gap
from gearsim.processes.gear_budget import disturbed_operations, first_space
from gearsim.scene import load_scene
from gearsim.simulation.disturbance import Disturbance
from gearsim.simulation.workshop import Workshop
from gearsim.surfaces.involute import InvoluteFlank
from gearsim.toolpaths.cylindrical.posting import planned, posted

DECIMALS = 3


def cut_of(teeth, module, helix_deg, diameter, step):
    """The finishing of space 0 from its program, one pass a flank."""
    scene, _ = load_scene("spur-internal", (
        f"surface.teeth={teeth}", f"surface.transverse_module_mm={module}", f"surface.helix_angle_deg={helix_deg}",
        "surface.face_width_mm=4.0", "toolpath.finishing.axial_step_mm=4.0",
        f"toolpath.finishing.involute_step_mm={step}", "toolpath.clearance.rim_mm=0.5",
    ))  # fmt: skip
    mill = scene.tools[0].model_copy(update={"diameter_mm": diameter, "flute_length_mm": 3.0 * diameter + 6.0})
    scene = scene.model_copy(update={"tools": (mill,)})
    gear, machine, finishing = scene.gear(), scene.controller(), scene.finishing()
    operation = first_space(planned(gear, machine, (finishing,), False)[0], gear.count)
    blocks = posted((operation,), machine, DECIMALS).blocks
    (cut,) = disturbed_operations(blocks, {1: mill.build()}, Disturbance(), 1e-9)
    return gear, finishing.cutting.radius, cut


@pytest.mark.parametrize(
    ("teeth", "module", "helix_deg", "diameter", "step", "side"),
    [(-25, 5.0, 0.0, 5.0, 2.0, "left"), (-25, 5.0, 0.0, 5.0, 2.0, "right"), (-30, 5.0, 10.0, 4.0, 1.0, "left")],
)
def test_gouges_of_three_decimals_are_found_by_both_roads(teeth, module, helix_deg, diameter, step, side):
    """There the instant centre runs through the tool's axis, and the contact races around it."""
    gear, radius, motion = cut_of(teeth, module, helix_deg, diameter, step)
    flank = InvoluteFlank(gear, side)
    limit = max(radius * cos(gear.base_helix_angle) / gear.base_radius, gear.tip_roll)
    near = np.geomspace(1e-5, 5e-2, 9)
    roll = np.concatenate([np.maximum(limit - near, 1e-4), limit + near])
    at = flank.jet(roll, np.full(len(roll), -1.48))
    window = np.full(len(roll), 0.1)
    rays = RayBundle(at.r, at.normal, -window, window)
    removal = measure(rays, Workshop("cpu", slots=64).cut([(rays, [motion])])[0])
    gap = road_gap(machined_along(rays, motion.motions(), motion.cutter), removal)
    assert gap.trusted
    assert gap.valid == removal.measured.sum() > 8
    assert np.nanmin(1e6 * removal.value) < -20.0  # nm: it gouges
