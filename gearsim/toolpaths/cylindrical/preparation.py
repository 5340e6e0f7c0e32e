"""Round work on the blank with an upright tool: face, bore, outside diameter, reference ring (Groover 2018, A.4)."""

from __future__ import annotations

from math import ceil, pi, radians, sqrt
from typing import NamedTuple

import numpy as np

from gearsim.errors import InputError
from gearsim.machines.chain import Machine
from gearsim.programs.blocks import Blocks
from gearsim.programs.operation import Operation
from gearsim.toolpaths.counts import check_count
from gearsim.toolpaths.cylindrical.axes import GearTable
from gearsim.toolpaths.cylindrical.feed import SHORTEST_S, block_seconds
from gearsim.toolpaths.cylindrical.order import straight, told_time
from gearsim.toolpaths.cylindrical.settings import Bore, Cutting, Facing, OutsideDiameter, ReferenceRing
from gearsim.toolpaths.cylindrical.steps import descent, parts

_PLUNGE = 0.375  # radius of the plunging helix in tool diameters
_AWAY_MM = 0.5  # from a wall before the tool goes up
_OVERLAP_RAD = radians(20.0)
_RAMP_RAD = radians(45.0)
_START_RAD = 0.5 * pi  # heading at which the tables' zero has X and Y along the workpiece's x and y
_ALIGNED = 1e-9


class Move(NamedTuple):
    """To ``r``, ``y``, ``z`` [mm] in the frame that turns with ``turn`` [rad], or round the axis by ``sweep``."""

    r: float
    z: float
    y: float = 0.0
    turn: float = 0.0
    sweep: float = 0.0
    rapid: bool = False


def face(machine: Machine, settings: Facing) -> Operation:
    """The top face down to z = 0, in rings from the middle outward. Raises InputError as ``bore`` does."""
    moves = _pocket(settings, settings.radius, settings.allowance, 0.0)
    return _operation(machine, "facing", settings.cutting, moves)


def bore(machine: Machine, settings: Bore) -> Operation:
    """A round pocket: helix in the middle, then rings outward, a level at a time (the thesis's cylinder pocket).

    Raises InputError where the tool is too wide or too short for the hole, and for unsuited machines.
    """
    settings.cutting.check_depth("bore", settings.depth)
    return _operation(machine, "bore", settings.cutting, _pocket(settings, settings.radius, 0.0, -settings.depth))


def outside_diameter(machine: Machine, settings: OutsideDiameter) -> Operation:
    """Turns round the blank from the outside inward, each at all levels; the tool comes and goes along tangents.

    The tangent's length is 1.5 sqrt(2 R a + a²) with the tool centre's radius R and the step a (the thesis prints
    2 R a - a²). Raises InputError unless the blank is the larger one, for short tools and unsuited machines.
    """
    cutting, change = settings.cutting, settings.blank_radius - settings.radius
    cutting.check_depth("outside diameter", settings.depth)
    if change <= 0.0:
        raise InputError(
            f"outside diameter: the blank's radius {settings.blank_radius:g} mm must exceed {settings.radius:g} mm"
        )
    count = parts(change, settings.radial_immersion * cutting.tool.diameter)
    step, top, moves = change / count, settings.clearance.top, []
    for centre in settings.blank_radius + cutting.radius - step * np.arange(1, count + 1):
        run = 1.5 * sqrt(2.0 * centre * step + step * step)
        for z in descent(0.0, -settings.depth, settings.axial_step):
            moves += [
                Move(centre, top, run, rapid=True),
                Move(centre, z, run, rapid=True),
                Move(centre, z),
                Move(centre, z, sweep=-2.0 * pi),
                Move(centre, z, -run),
                Move(centre, top, -run, rapid=True),
            ]
    return _operation(machine, "outside diameter", cutting, moves)


def reference_ring(machine: Machine, settings: ReferenceRing) -> Operation:
    """A groove milled by the turning table under a standing tool, ring after ring outward, a level at a time.

    The table goes on turning the same way; its turns are not taken back before the tool is out. (The thesis's
    program walks to the ring it stands on, so that the outer one is never cut.) Raises InputError for a groove
    narrower than the tool, a short tool and unsuited machines.
    """
    cutting, width = settings.cutting, settings.outer - settings.inner
    cutting.check_depth("reference ring", settings.depth)
    if width < cutting.tool.diameter:
        raise InputError(
            f"reference ring: {settings.inner:g} to {settings.outer:g} mm leaves {width:g} mm, less than the tool's "
            f"diameter of {cutting.tool.diameter:g} mm"
        )
    walk = width - cutting.tool.diameter
    rings = settings.inner + cutting.radius + _spread(walk, settings.radial_immersion * cutting.tool.diameter)
    turn, moves = 0.0, [Move(rings[0], settings.clearance.top, rapid=True)]
    above = 0.0
    for z in descent(0.0, -settings.depth, settings.axial_step):
        moves.append(Move(rings[0], above, turn=turn))
        turn += _RAMP_RAD
        moves.append(Move(rings[0], z, turn=turn))
        for ring in rings:
            moves.append(Move(ring, z, turn=turn))
            turn += 2.0 * pi + _OVERLAP_RAD
            moves.append(Move(ring, z, turn=turn))
        above = z
    moves += [
        Move(rings[-1], 0.0, turn=turn),  # the tool slides along the groove's walls
        Move(rings[-1], settings.clearance.top, turn=turn, rapid=True),
    ]
    return _operation(machine, "reference ring", cutting, moves)


def _pocket(settings: Facing | Bore, radius: float, top: float, bottom: float) -> list[Move]:
    """Helix, circle and rings of every level; down-milling is anticlockwise in a hole."""
    cutting = settings.cutting
    last = radius - cutting.radius
    if last <= 0.0:
        raise InputError(
            f"{type(settings).__name__}: a tool of {cutting.tool.diameter:g} mm does not fit a radius of {radius:g} mm"
        )
    start = min(_PLUNGE * cutting.tool.diameter, last)
    rings = start + _spread(last - start, settings.radial_immersion * cutting.tool.diameter)
    clear = top + settings.clearance.top
    moves, above = [Move(start, clear, rapid=True), Move(start, top)], top
    for z in descent(top, bottom, settings.axial_step):
        moves += [Move(start, above), *(Move(start, h, sweep=2.0 * pi) for h in _helix(above, z, settings.axial_step))]
        for ring in rings:
            moves += [Move(ring, z), Move(ring, z, sweep=2.0 * pi)]
        above = z
    inside = max(last - _AWAY_MM, 0.0)
    return [*moves, Move(inside, bottom), Move(inside, clear, rapid=True)]


def _helix(above: float, z: float, axial_step: float) -> list[float]:
    """Where each turn of the helix ends: half a level a turn."""
    return [float(h) for h in descent(above, z, 0.5 * axial_step)]


def _spread(width: float, step: float) -> np.ndarray:
    """0 to ``width`` in equal steps."""
    check_count(width, step)
    return np.linspace(0.0, width, (ceil(width / step - 1e-9) if width > 1e-9 else 0) + 1)


def _operation(machine: Machine, name: str, cutting: Cutting, moves: list[Move]) -> Operation:
    r, z, y, turn, sweep = np.array([move[:5] for move in moves]).T
    rapid = np.array([move.rapid for move in moves])
    table = GearTable(machine, 0.0)
    heading = _START_RAD + turn
    c, s = np.cos(turn), np.sin(turn)
    values = table.values(heading, np.stack([c * r - s * y, s * r + c * y, z], axis=-1))
    centre = table.values(heading, np.stack([0.0 * z, 0.0 * z, z], axis=-1))[:, :3]
    _check_upright(machine, values[:1])
    seconds = block_seconds(machine, values, rapid, np.zeros(len(r)), table.column, cutting.feed)
    rise = np.diff(z, prepend=z[0])
    arc = 60.0 * np.hypot(sweep * np.hypot(r, y), rise) / cutting.feed
    seconds = np.where(sweep != 0.0, np.maximum(arc, SHORTEST_S), seconds)
    moved = (sweep != 0.0) | (np.diff(values, axis=0, prepend=np.nan) != 0.0).any(axis=1)
    plain = straight(machine, values[moved], rapid[moved], seconds[moved], cutting)
    blocks = Blocks(**{**vars(plain), "sweep": sweep[moved][1:], "centre": centre[moved][1:]})
    return Operation(name, cutting.tool, cutting.spindle, blocks, comments=(told_time(seconds),))


def _check_upright(machine: Machine, values: np.ndarray) -> None:
    """Arcs need X, Y, Z along a right-handed frame whose Z is the gear's axis."""
    directions = machine.slide_directions(values)[0]
    flat = abs(directions[2, :2]).max() < _ALIGNED and abs(directions[2, 2] - 1.0) < _ALIGNED
    if not flat or abs(np.linalg.det(directions) - 1.0) > _ALIGNED:
        raise InputError(
            f"machine {machine.name}: with the tool along the gear's axis, its X, Y and Z must be a right-handed frame "
            "with Z along that axis for arcs about it"
        )
