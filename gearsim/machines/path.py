"""Axis values along a path: one continuous choice among the branches, checked for travel and swings.

The branch of least rotary motion is followed from point to point, rotary axes are unwrapped, and whole turns
are chosen so that the travel limits hold where they can.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, degrees, isfinite, pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.errors import InputError
from gearsim.machines.chain import Joint, Machine
from gearsim.machines.inverse import PARALLEL_RAD, Solver, wrap

_ROUNDING = 1e-9
_SWING_LIMIT = 10.0


@dataclass(frozen=True)
class Overrun:
    """An axis beyond a travel limit: first and worst point (counted from 0), worst value, limit [mm or rad]."""

    joint: Joint
    first: int
    worst: int
    value: float
    limit: float

    def __str__(self) -> str:
        factor, unit = (degrees(1.0), "deg") if self.joint.is_rotary else (1.0, "mm")
        return (
            f"axis {self.joint.name} overruns its limit of {factor * self.limit:g} {unit} from point "
            f"{self.first + 1} on, by {factor * abs(self.value - self.limit):.6g} {unit} at point {self.worst + 1}"
        )


@dataclass(frozen=True)
class Swing:
    """A step near the singular position: from ``point`` to the next, the axis turns ``rate`` times as far
    as the tool axis [rad / rad]; ``turn`` [rad] is how far."""

    joint: Joint
    point: int
    turn: float
    rate: float

    def __str__(self) -> str:
        return (
            f"axis {self.joint.name} swings by {degrees(self.turn):.6g} deg between points {self.point + 1} and "
            f"{self.point + 2}, {self.rate:.3g} times as far as the tool axis turns"
        )


@dataclass(frozen=True)
class AxisPath:
    """Axis values (n, k) [mm, rad] along a path, rotary axes without jumps, and what is wrong with it.

    ``branch`` (n,) is 0 or 1 as in ``Branches``; ``free`` (n,) where the rotary axis nearest the workpiece
    could stand anywhere and holds its last position.
    """

    machine: Machine
    values: NDArray[np.floating]
    branch: NDArray[np.integer]
    free: NDArray[np.bool_]
    overruns: tuple[Overrun, ...]
    swings: tuple[Swing, ...]

    def messages(self) -> list[str]:
        """What to tell a person: overruns, then swings, then free positions; empty where all is well."""
        lines = [str(found) for found in (*self.overruns, *self.swings)]
        if self.free.any():
            name = next(joint.name for joint in self.machine.chain if joint.is_rotary)
            lines.append(
                f"axis {name} is parallel to the tool's direction at {self.free.sum()} points, first at point "
                f"{np.argmax(self.free) + 1}: it could stand anywhere"
            )
        return lines


def axis_values(
    machine: Machine, tips: NDArray, axes: NDArray, near: ArrayLike | None = None, spin: ArrayLike = 0.0
) -> AxisPath:
    """Axis values for a path of tips [mm] and unit axes, (n, 3), workpiece frame.

    ``near`` (k,): axis values the path is to start near: it settles branch, whole turns and the position of a
    free axis. Without it the start is chosen that keeps the limits, then the one with the smaller rotary
    positions (Litvin and Chen's choice under (16)).
    ``spin`` [rad]: the tool's own rotary axis, where there is one. Raises InputError as ``inverse_pose``.
    """
    solver = Solver(machine, frame=False)
    return _best(solver, axes, near, lambda v1, v2: solver.complete_pose(tips, v1, v2, spin))


def axis_values_of_frames(
    machine: Machine, rotation: NDArray, origin: NDArray, near: ArrayLike | None = None
) -> AxisPath:
    """Axis values for a path of full tool frames, (n, 3, 3) and (n, 3) [mm]; see ``axis_values``."""
    solver = Solver(machine, frame=True)
    aims = rotation @ solver.aim
    return _best(solver, aims, near, lambda v1, v2: solver.complete_frame(rotation, origin, v1, v2))


def _best(
    solver: Solver, wanted: NDArray, near: ArrayLike | None, complete: Callable[[NDArray, NDArray], NDArray]
) -> AxisPath:
    first, second, free = solver.turn(wanted)
    machine, columns = solver.machine, [solver.machine.column(j) for j in solver.rotaries]
    start = None if near is None else np.asarray(near, dtype=float)
    if start is not None and start.shape != (len(machine.axes),):
        raise InputError(
            f"machine {machine.name}: expected start values for {', '.join(machine.axes)}, got shape {start.shape}"
        )
    first = _hold(first, free, None if start is None else float(start[columns[0]]))
    tries: tuple[int, ...] = (0, 1)
    if start is not None:
        off = np.abs(wrap(np.stack([first[:, 0], second[:, 0]]) - start[columns[:2], None])).sum(axis=0)
        tries = (int(off.argmin()),)
    paths = []
    for branch in (_follow(first, second, begin) for begin in tries):
        point = np.arange(len(branch))
        values = complete(first[branch, point], second[branch, point])
        values[:, columns] = np.unwrap(values[:, columns], axis=0)
        for joint, column in zip(solver.rotaries, columns, strict=True):
            values[:, column] += 2.0 * pi * _turns(values[:, column], joint, start, column)
        found = overruns(machine, values)
        beyond = sum(abs(o.value - o.limit) for o in found)
        cost = beyond, round(float(np.abs(values[:, columns]).sum()), 6)
        swings = _swings(solver.rotaries[0], values[:, columns[0]], wanted)
        paths.append((cost, AxisPath(machine, values, branch, free, found, swings)))
    return min(paths, key=lambda entry: entry[0])[1]


def _hold(first: NDArray, free: NDArray, start: float | None) -> NDArray:
    """Let a free axis keep its last position, and before the first settled one take that or ``start``."""
    n = len(free)
    if free.all():
        return np.full_like(first, 0.0 if start is None else start)
    last = np.maximum.accumulate(np.where(free, -1, np.arange(n)))
    held = first[:, np.where(last < 0, np.argmin(free), last)]
    return held if start is None else np.where(last < 0, start, held)


def _follow(first: NDArray, second: NDArray, begin: int) -> NDArray:
    """The branch at every point, from branch ``begin`` by least rotary motion from point to point.

    Each step is a map of the two branches; maps are composed by doubling instead of a loop over points.
    """
    both = np.stack([first, second])
    steps = np.abs(wrap(both[:, None, :, 1:] - both[:, :, None, :-1])).sum(axis=0)
    reached = np.argmin(steps, axis=1).T
    reach = 1
    while reach < len(reached):
        reached[reach:] = np.take_along_axis(reached[reach:], reached[:-reach], axis=1)
        reach *= 2
    return np.concatenate([[begin], reached[:, begin]])


def _turns(values: NDArray, joint: Joint, start: NDArray | None, column: int) -> int:
    """Whole turns to add so that the path starts near ``start``, or else keeps the limits."""
    if start is not None:
        return round((start[column] - values[0]) / (2.0 * pi))
    low, high = float(values.min()), float(values.max())
    if joint.lower - _ROUNDING <= low and high <= joint.upper + _ROUNDING:
        return 0
    if isfinite(joint.lower) and isfinite(joint.upper):
        return round((joint.lower + joint.upper - low - high) / (4.0 * pi))
    if isfinite(joint.lower):
        return ceil((joint.lower - low) / (2.0 * pi))
    return -ceil((high - joint.upper) / (2.0 * pi))


def overruns(machine: Machine, values: NDArray) -> tuple[Overrun, ...]:
    """Where axis values (n, k) leave the machine's travel limits."""
    found = []
    for joint, axis in zip(machine.joints, values.T, strict=True):
        for limit, beyond in ((joint.lower, joint.lower - axis), (joint.upper, axis - joint.upper)):
            if len(axis) and beyond.max() > _ROUNDING:
                worst = int(beyond.argmax())
                first = int(np.argmax(beyond > _ROUNDING))
                found.append(Overrun(joint, first, worst, float(axis[worst]), limit))
    return tuple(found)


def _swings(joint: Joint, values: NDArray, wanted: NDArray) -> tuple[Swing, ...]:
    """Steps where the axis nearest the workpiece turns more than ten times as far as the tool's direction."""
    a, b = wanted[:-1], wanted[1:]
    tilt = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1))
    turn = np.diff(values)
    steps = np.flatnonzero(np.abs(turn) > np.maximum(_SWING_LIMIT * tilt, _ROUNDING))
    rate = np.abs(turn) / np.maximum(tilt, PARALLEL_RAD)
    return tuple(Swing(joint, int(i), float(turn[i]), float(rate[i])) for i in steps)
