"""From moves to blocks: arcs, tool centre point control and times, batch by batch in vector form."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.machines.chain import Machine
from gearsim.machines.inverse import FLAT, reach_tip
from gearsim.programs.gcode.arc_rules import ArcRules
from gearsim.programs.gcode.arcs import PLANES, Arcs, arcs
from gearsim.programs.gcode.moves import CLOCKWISE, COUNTER_CLOCKWISE, DWELL, FEED, RAPID, Moves


class Batch(NamedTuple):
    """Columns of a batch of blocks; ``turns`` is None where no block is an arc."""

    values: NDArray[np.floating]
    seconds: NDArray[np.floating]
    rapid: NDArray[np.bool_]
    tip_control: NDArray[np.bool_]
    line: NDArray[np.integer]
    tool: NDArray[np.integer]
    operation: NDArray[np.integer]
    turns: tuple[NDArray, NDArray, NDArray] | None


class MoveError(Exception):
    """Move ``index`` of a batch cannot be run: ``letters`` are the words to show."""

    def __init__(self, index: int, letters: str, reason: str):
        super().__init__(reason)
        self.index, self.letters, self.reason = index, letters, reason


def finish(moves: Moves, machine: Machine, rules: ArcRules, all_axes: bool) -> Batch:
    """The blocks of a batch of moves; ``all_axes`` is ``Dialect.feed_of_all_axes``.

    Raises MoveError for the first move that cannot be run.
    """
    mode, n = moves.mode, len(moves.line)
    turning = np.flatnonzero((moves.motion == CLOCKWISE) | (moves.motion == COUNTER_CLOCKWISE))
    circles = _circles(moves, turning, rules) if len(turning) else None
    values = to_slides(machine, moves.ends, mode.excess) if mode.tip else moves.ends
    return Batch(
        values,
        _seconds(moves, machine, turning, circles, all_axes),
        (moves.motion == RAPID),
        np.full(n, mode.tip) & (moves.motion <= FEED),
        moves.line.astype(np.int32),
        np.full(n, mode.tool, dtype=np.int32),
        np.full(n, mode.operation, dtype=np.int32),
        None if circles is None else _spread(turning, circles, n, mode.plane),
    )


def to_slides(machine: Machine, tips: NDArray, excess: float) -> NDArray:
    """Axis values for programmed tips and rotary values (n, k), the tip ``excess`` [mm] above the programmed one."""
    wanted = tips[:, :3]
    if excess:
        wanted = wanted + excess * machine.forward(tips)[1]
    try:
        return reach_tip(machine, tips, wanted)
    except InputError as error:
        flat = np.abs(np.linalg.det(machine.slide_directions(tips))) < FLAT
        reason = "the rotary axes turn the slides into one plane, so that they cannot reach the tip"
        raise MoveError(int(np.argmax(flat)), "".join(machine.axes[3:]), reason) from error


def to_tips(machine: Machine, values: NDArray, excess: float) -> NDArray:
    """The reverse of ``to_slides``."""
    tip, axis = machine.forward(values)
    return np.concatenate([tip - excess * axis, values[:, 3:]], axis=1)


def _circles(moves: Moves, turning: NDArray, rules: ArcRules) -> Arcs:
    mode = moves.mode
    assert moves.arcs is not None
    found = arcs(
        moves.before[turning, :3], moves.ends[turning, :3], moves.arcs[turning], moves.motion[turning] == CLOCKWISE,
        mode.plane, mode.scale, mode.arc_absolute, rules,
    )  # fmt: skip
    wrong = np.flatnonzero(~found.runs)
    if len(wrong):
        raise _no_arc(moves, int(turning[wrong[0]]), float(found.miss[wrong[0]]), rules)
    return found


def _no_arc(moves: Moves, i: int, miss: float, rules: ArcRules) -> MoveError:
    """Why a control does not run an arc."""
    assert moves.arcs is not None
    mode, radius = moves.mode, moves.arcs[i, 3]
    a, b, _ = PLANES[mode.plane]
    chord = float(np.hypot(*(moves.ends[i] - moves.before[i])[[a, b]]))
    if not np.isnan(radius):
        if np.isnan(miss):
            reason = (
                "a radius is not zero"
                if radius == 0.0
                else "a full circle needs its centre (I, J, K); R does not settle it"
            )
            return MoveError(i, "R", reason)
        return MoveError(i, "R", f"the radius {radius:g} mm does not reach the end, which is {chord:g} mm away")
    if np.isnan(miss):
        return MoveError(i, "IJK", "the arc's centre is its start or its end")
    allowed, share = rules.centre(mode.scale) * mode.scale, rules.share
    more = f", or {100 * share:g} % of its radius up to {rules.largest * allowed:.4g} mm," if share else ""
    reason = f"the arc's end lies {miss:.6g} mm off its circle; up to {allowed:.4g} mm{more} are allowed"
    return MoveError(i, "IJK", reason)


def _seconds(moves: Moves, machine: Machine, turning: NDArray, circles: Arcs | None, all_axes: bool) -> NDArray:
    """How long each move takes; nan for rapids."""
    mode, feed = moves.mode, moves.feed
    with np.errstate(divide="ignore", invalid="ignore"):
        if mode.feed_mode == 93:
            stands = (moves.ends == moves.before).all(axis=1) & (moves.motion <= FEED) & (not all_axes)
            seconds = np.where(stands, 0.0, 60.0 / feed)
        else:
            per_minute = feed * (mode.spindle if mode.feed_mode == 95 else 1.0)
            seconds = 60.0 * _length(moves, machine, turning, circles, all_axes) / per_minute
    seconds = np.where(moves.motion == DWELL, feed, seconds)
    return np.where(moves.motion == RAPID, np.nan, seconds)


def _length(moves: Moves, machine: Machine, turning: NDArray, circles: Arcs | None, all_axes: bool) -> NDArray:
    """What F counts, in units of the program: see ``Dialect.feed_of_all_axes``."""
    slides = sum(not joint.is_rotary for joint in machine.joints)
    change = moves.ends - moves.before
    way = np.sqrt((change[:, :slides] ** 2).sum(axis=1)) / moves.mode.feed_scale
    turn = np.degrees(np.sqrt((change[:, slides:] ** 2).sum(axis=1)))
    together = all_axes and not moves.mode.tip
    way = np.hypot(way, turn) if together else np.where(way > 0.0, way, turn)
    if circles is not None:
        a, b, c = PLANES[moves.mode.plane]
        radius = np.hypot(*(moves.before[turning, :3] - circles.centre)[:, [a, b]].T)
        along = 0.0 if all_axes else change[turning, c]
        way[turning] = np.hypot(radius * circles.sweep, along) / moves.mode.feed_scale
    return way


def _spread(turning: NDArray, circles: Arcs, n: int, plane: int) -> tuple[NDArray, NDArray, NDArray]:
    """Sweep, centre and normal of all moves; straight ones have none, whatever the plane."""
    sweep, centre, normal = np.zeros(n), np.zeros((n, 3)), np.full(n, 2, dtype=np.int8)
    sweep[turning], centre[turning], normal[turning] = circles.sweep, circles.centre, PLANES[plane][2]
    return sweep, centre, normal
