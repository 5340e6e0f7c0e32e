"""What an engineer must be told of a gear milled by generation."""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees

import numpy as np

from gearsim.generation_milling.cutting import ProgramCut
from gearsim.generation_milling.flank_map import LAST, WHOLE
from gearsim.generation_milling.job import GearJob
from gearsim.generation_milling.stock import gear_stock
from gearsim.geometry.rays import join_rays
from gearsim.metrology.dexel_check import DexelResult
from gearsim.metrology.findings import Finding, rapid_findings, surface_findings
from gearsim.metrology.gear_inspection import GearInspection
from gearsim.metrology.rapid_check import blank_rays, rapid_touch
from gearsim.metrology.surface import SurfaceResult
from gearsim.simulation.dexels import DexelBox
from gearsim.surfaces.cylindrical_gear import SIDES, Side
from gearsim.surfaces.involute import InvoluteFlank
from gearsim.surfaces.tool_access import tool_reach

_SEEN_MM = 1e-6
_DEEPER_MM = 1e-3
_CLEAR_MM = 0.05


def gear_findings(
    job: GearJob, cut: ProgramCut, inspection: GearInspection, maps: Mapping[Side, SurfaceResult], dexels: DexelResult
) -> list[Finding]:
    """Values beyond the class, maps beyond the tolerance, cross-cuts, rapids in the blank, flanks not reached."""
    found = _class(job, inspection)
    for side, surface in maps.items():
        found += surface_findings(surface, (WHOLE,), job.scene.metrology.tolerance_um)
        found += _cross_cut(side, surface)
    found += _rapids(job, cut, dexels.box)
    for side in SIDES:
        found += _not_reached(job, side)
    return found + _left_in_space(job, dexels)


def _rapids(job: GearJob, cut: ProgramCut, box: DexelBox) -> list[Finding]:
    """The first rapid block that touches material, seen by rays through the whole blank and closer ones at space 0."""
    blocks, stock = job.program.blocks, gear_stock(job.gear, job.scene.surface.rim_mm)
    rays = join_rays([blank_rays(stock), *(box.rays(axis) for axis in range(3))])
    touch = rapid_touch(stock, rays, blocks.rapid, cut.removed_by)
    line = 0 if touch is None else int(blocks.line[touch.step])
    return rapid_findings(touch, None, f"the rapid move of line {line}")


def _class(job: GearJob, inspection: GearInspection) -> list[Finding]:
    """Parameters of ISO 1328-1 beyond the class asked for; pitches only where all spaces were probed."""
    whole = len(job.spaces) == job.gear.count
    found = []
    for row in inspection.rows():
        if row.within or (row.parameter in ("f_p", "F_p") and not whole):
            continue
        worst = max((v for v in row.value_um.values() if np.isfinite(v)), key=abs, default=None)
        what = f"{row.incomplete} traces incomplete" if row.incomplete else f"{worst:.3g} um"
        text = f"{row.parameter} is beyond class {inspection.gear_class} ({row.tolerance_um:g} um): {what}"
        found.append(_at(job, "left", 0.5, "beyond_class", worst, True, text))
    return found


def _cross_cut(side: Side, surface: SurfaceResult) -> list[Finding]:
    """Where the rest of the program cuts deeper than the last operation alone."""
    if LAST not in surface.deviations:
        return []
    depth = np.nan_to_num(surface.deviations[WHOLE].value - surface.deviations[LAST].value).ravel()
    i = int(np.argmin(depth))
    if depth[i] > -_SEEN_MM:
        return []
    x, y, z = (float(c) for c in surface.grid.point.reshape(-1, 3)[i])
    text = f"another operation cuts the {side} flank deeper than the last one"
    return [Finding("cross_cut", side, 1e3 * float(depth[i]), (x, y, z), None, None, False, text)]


def _left_in_space(job: GearJob, dexels: DexelResult) -> list[Finding]:
    """Material between the flanks of space 0 where both are generated, as the dexels along the axis find it."""
    gear, bundle = job.gear, dexels.bundles[2]
    x, y, _ = bundle.rays.origin.T
    radius, angle = np.hypot(x, y), np.arctan2(y, x)
    low, high = (gear.radius([of(ends) for ends in job.reached.values()]) for of in (min, max))
    between = np.flatnonzero((radius > low.max()) & (radius < high.min()))
    middle = gear.space_centre(0, np.array([0.0, -gear.facewidth]))
    off = np.abs(angle[between, None] - middle).max(axis=1)
    inside = between[off < gear.half_space(radius[between]) - _CLEAR_MM / radius[between]]
    left = np.zeros(len(radius))
    np.add.at(left, bundle.left.ray, bundle.left.hi - bundle.left.lo)
    worst = inside[np.argmax(left[inside])] if len(inside) else 0
    if not len(inside) or left[worst] < _DEEPER_MM:
        return []
    place = (float(x[worst]), float(y[worst]), float(bundle.rays.origin[worst, 2]))
    text = f"material stands in space 1, up to {left[worst]:.3f} mm along the axis"
    return [Finding("left_in_space", "space", None, place, None, None, True, text)]


def _not_reached(job: GearJob, side: Side) -> list[Finding]:
    """The part of the involute that the tool cannot generate, and roots it deepens."""
    gear, (root, tip) = job.gear, job.reached[side]
    tool = job.finishing.cutting.tool
    found = []
    if abs(root - gear.root_roll) > 1e-9 or abs(tip - gear.tip_roll) > 1e-9:
        radii = f"R {gear.radius(root):.3f} to {gear.radius(tip):.3f} mm"
        text = (
            f"the tool of {tool.diameter:g} mm generates the {side} flank over the whole facewidth from roll "
            f"{degrees(root):.3f} to {degrees(tip):.3f} deg ({radii}); the involute goes from "
            f"{degrees(gear.root_roll):.3f} to {degrees(gear.tip_roll):.3f} deg"
        )
        found.append(_at(job, side, 0.0, "not_reached", None, False, text))
    deepest = float(tool_reach(gear, root, 0.5 * tool.diameter))
    deeper = gear.sign * (gear.root_radius - deepest)
    if deeper > _DEEPER_MM:
        text = f"finishing the {side} flank to its root end deepens the root circle by {deeper:.3f} mm"
        found.append(_at(job, side, 0.0, "root_deepened", None, False, text))
    return found


def _at(job: GearJob, side: Side, height: float, kind: str, um: float | None, fails: bool, text: str) -> Finding:
    """A finding at a height, 0 root to 1 tip, of a flank of space 0."""
    root, tip = job.reached[side]
    x, y, z = InvoluteFlank(job.gear, side).jet(root + height * (tip - root), -0.5 * job.gear.facewidth).r
    return Finding(kind, side, um, (float(x), float(y), float(z)), None, None, fails, text)
