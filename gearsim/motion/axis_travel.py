"""What a machine's axes do within the blocks of a program: how far they go, and how fast."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.series import Series
from gearsim.machines.inverse import reach_tip
from gearsim.motion.program import ProgramMotion
from gearsim.programs.blocks import Blocks

INSTANTS = 65
_AT_ONCE = 1 << 10


class Travel(NamedTuple):
    """Of every block, shape (n, k): least and largest value of each axis [mm, rad], its largest rate [per block]."""

    least: NDArray[np.floating]
    largest: NDArray[np.floating]
    rate: NDArray[np.floating]


def axis_travel(blocks: Blocks) -> Travel:
    """How far and how fast axes go in every block, exactly where all of them run linearly.

    In arcs and with tip control they are looked at in 65 instants, with their exact rates: a cubic through both gives
    what lies between, to a ten-millionth of an arc's radius. Raises InputError where slides cannot reach a tip.
    """
    before, after = blocks.before, blocks.values
    least, largest, rate = np.minimum(before, after), np.maximum(before, after), np.abs(after - before)
    bent = blocks.tip_control | (blocks.sweep != 0.0)
    if not bent.any() or not (bent & ((after != before).any(axis=1) | (blocks.sweep != 0.0))).any():
        return Travel(least, largest, rate)
    motion = ProgramMotion(blocks, bent)
    for begin in range(0, motion.pieces, _AT_ONCE):
        piece = np.arange(begin, min(begin + _AT_ONCE, motion.pieces))
        value, slope = _states(motion, piece)
        row = motion.rows[piece]
        low, high = _between(value, slope)
        least[row], largest[row] = np.minimum(least[row], low), np.maximum(largest[row], high)
        rate[row] = np.abs(slope).max(axis=1)
    return Travel(least, largest, rate)


def _states(motion: ProgramMotion, piece: NDArray) -> tuple[NDArray, NDArray]:
    """Axis values and their rates [per block], shape (n, instants, k)."""
    t = np.tile(np.linspace(0.0, 1.0, INSTANTS), len(piece))
    each, time = np.repeat(piece, INSTANTS), Series.variable(t, 1)
    axes = motion.axes(each, time)
    value, slope = axes.c[0].copy(), axes.c[1].copy()
    held = np.flatnonzero(motion.held(each))
    if len(held):
        part = Series(axes.c[:, held])
        value[held], slope[held] = _with_tip(motion, part, motion.tip(each[held], Series(time.c[:, held])))
    shape = (len(piece), INSTANTS, -1)
    return value.reshape(shape), slope.reshape(shape)


def _with_tip(motion: ProgramMotion, axes: Series, tip: Series) -> tuple[NDArray, NDArray]:
    """Axis values and rates of rotary axes that turn as given while the tip goes its own way."""
    machine = motion.blocks.machine
    slides = sum(not joint.is_rotary for joint in machine.joints)
    value = reach_tip(machine, axes.c[0].copy(), tip.c[0])
    turn = axes.c[1].copy()
    turn[:, :slides] = 0.0
    swept = machine.forward_series([Series(np.stack([value[:, i], turn[:, i]])) for i in range(value.shape[1])])
    rest = tip.c[1] - swept.tip.c[1]
    slope = turn
    slope[:, :slides] = np.linalg.solve(machine.slide_directions(value), rest[..., None])[..., 0]
    return value, slope


def _between(value: NDArray, slope: NDArray) -> tuple[NDArray, NDArray]:
    """Least and largest of cubics through values and slopes at even instants, shape (n, k)."""
    a, b = value[:, :-1], value[:, 1:]
    p, q = (s / (INSTANTS - 1) for s in (slope[:, :-1], slope[:, 1:]))
    c3, c2 = 2.0 * (a - b) + p + q, 3.0 * (b - a) - 2.0 * p - q
    root = np.sqrt(np.maximum(c2 * c2 - 3.0 * c3 * p, 0.0))
    under = -(c2 + np.copysign(root, c2))
    found = [a, b]
    with np.errstate(divide="ignore", invalid="ignore"):
        for x in (under / (3.0 * c3), p / under):
            inside = (x > 0.0) & (x < 1.0)
            at = np.where(inside, x, 0.0)
            found.append(a + at * (p + at * (c2 + at * c3)))
    every = np.stack(found)
    return every.min(axis=(0, 2)), every.max(axis=(0, 2))
