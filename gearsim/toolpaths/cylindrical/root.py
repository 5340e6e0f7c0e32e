"""Root land and fillets of an external spur gear's spaces, milled along their outline with an upright tool.

Our own: the thesis leaves the root to its slots, whose flat tools leave corners, and to the finishing passes, which
reach no farther inward than the base circle.
"""

from __future__ import annotations

from math import acos, ceil, cos, sin

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.machines.chain import Machine
from gearsim.programs.operation import Operation
from gearsim.surfaces.cylindrical_gear import CylindricalGear
from gearsim.surfaces.gear_outline import GearOutline
from gearsim.toolpaths.cylindrical.axes import GearTable
from gearsim.toolpaths.cylindrical.limits import TIP_CLEARANCE_MM, pass_levels
from gearsim.toolpaths.cylindrical.order import every_space
from gearsim.toolpaths.cylindrical.settings import RootMilling
from gearsim.toolpaths.cylindrical.track import Track, join, moved_out, polar, track

_SAG_MM = 1e-4  # of a chord of the way round a fillet
_EXACT_MM = 1e-9


def mill_root(gear: CylindricalGear, machine: Machine, settings: RootMilling) -> Operation:
    """Level by level in along the right flank's tangent, round fillet, land and fillet, and out along the left one's.

    The table turns the land under a standing tool, so that it is round whatever the steps are. Raises InputError for
    internal and helical gears, a tool that is too thick for the fillets or too short, and unsuited machines.
    """
    cutting = settings.cutting
    if gear.is_internal or gear.helix_angle:
        raise InputError("toolpath.root mills external spur gears: it needs teeth above 0 and helix_angle_deg = 0")
    cutting.check_depth("root, face width", gear.facewidth)
    outline = GearOutline(gear, settings.fillet or 0.0)
    if cutting.radius > outline.fillet + _EXACT_MM:
        raise InputError(
            f"toolpath.root: the tool of {cutting.tool.diameter:g} mm does not fit fillets of {outline.fillet:g} mm "
            "radius; take a thinner one or a larger surface.fillet_radius_mm"
        )
    heading, right = _right_side(outline, cutting.radius)
    left = right[::-1] * np.array([1.0, -1.0])
    way, turn = np.concatenate([right, left]), np.concatenate([heading, -heading[::-1]])
    levels = pass_levels(gear, cutting.radius, settings.axial_step)
    rim, top = gear.tip_radius + settings.clearance.rim + cutting.radius, settings.clearance.top
    space = join(*(_level(way, turn, float(z), rim, top) for z in levels))
    return every_space(gear, GearTable(machine, 0.0), space, "root", cutting)


def _right_side(outline: GearOutline, tool: float) -> tuple[NDArray, NDArray]:
    """Headings (n,) [rad] and the tool's centre (n, 2) [mm], from outside the tip to the end of the land in space 0."""
    gear, (far, middle) = outline.gear, outline.centre
    lean = gear.space_half_angle + outline.form_roll
    along, out = np.array([cos(lean), sin(lean)]), np.array([sin(lean), -cos(lean)])
    angle = float(outline.half_angle(np.array(outline.form_radius)))
    start = polar(outline.form_radius, angle, 0.0)[0, :2] + tool * out
    reach = gear.tip_radius + tool + TIP_CLEARANCE_MM
    ahead = float(start @ along)
    open_ = start + (np.sqrt(ahead**2 + reach**2 - start @ start) - ahead) * along
    centre, spare = polar(far, middle, 0.0)[0, :2], outline.fillet - tool
    turn = outline.span
    count = ceil(turn / (2.0 * acos(1.0 - _SAG_MM / spare))) if spare > _SAG_MM else 1
    round_ = middle + np.pi - np.linspace(turn, 0.0, count + 1)
    arc = centre + max(spare, 0.0) * np.stack([np.cos(round_), np.sin(round_)], axis=-1)
    way = np.concatenate([open_[None], arc])
    return np.full(len(way), middle), way


def _level(way: NDArray, heading: NDArray, z: float, rim: float, top: float) -> Track:
    """One level's cut, and the rapids that lead to it and away from it, outside the tip cylinder."""
    tip = np.column_stack([way, np.full(len(way), z)])
    down = np.concatenate([moved_out(tip[0], rim, top), moved_out(tip[0], rim)])
    up = np.concatenate([moved_out(tip[-1], rim), moved_out(tip[-1], rim, top)])
    return join(track(heading[0], down, rapid=True), track(heading, tip), track(heading[-1], up, rapid=True))
