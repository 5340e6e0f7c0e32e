"""Motions of a program: its blocks run as the machine runs them, whatever kind each of them is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry import series
from gearsim.geometry.pose import FrameSeries, PoseSeries
from gearsim.geometry.series import Series
from gearsim.programs.blocks import Blocks

_AT_ONCE = 1 << 14  # poses whose temporaries stay in the cache


@dataclass(frozen=True)
class ProgramMotion:
    """The blocks of a program that move the machine, one piece each, in their order.

    All axes are linear in time; with tip control the tip runs straight on the workpiece instead (Zhou 2015, 4.15
    to 4.17); in an arc the linear axes turn about its centre, and the distance from it goes evenly from that of
    the start to that of the end: a spiral, where a control takes ends that lie off the circle. Rapids are run like
    feeds, all axes arriving together.
    ``chosen`` (n,) picks blocks (default: all), between which the tool may then jump. Raises InputError where
    nothing moves, and for arcs under tip control.
    """

    blocks: Blocks
    chosen: NDArray[np.bool_] | None = None

    def __post_init__(self) -> None:
        blocks = self.blocks
        both = np.flatnonzero(blocks.tip_control & (blocks.sweep != 0.0))
        if len(both):
            raise InputError(
                f"{self._name(both[0])}: an arc under tip control is not defined here; switch tip control off or "
                "write the arc as straight blocks"
            )
        if not self.pieces:
            raise InputError(f"program for {blocks.machine.name}: none of the chosen blocks moves an axis")

    @cached_property
    def rows(self) -> NDArray[np.integer]:
        """The block of every piece, counted from 0."""
        blocks = self.blocks
        moves = (blocks.values != blocks.before).any(axis=1) | (blocks.sweep != 0.0)
        return np.flatnonzero(moves if self.chosen is None else moves & self.chosen)

    @property
    def pieces(self) -> int:
        return len(self.rows)

    @property
    def share(self) -> NDArray[np.floating]:
        """How much of its block's time every piece takes."""
        return np.ones(self.pieces)

    def select(self, chosen: NDArray[np.bool_]) -> ProgramMotion:
        """The motion of the chosen blocks alone; ``chosen`` has one value a block."""
        return ProgramMotion(self.blocks, chosen)

    def pose(self, piece: NDArray, t: NDArray, order: int) -> PoseSeries:
        """Poses at t (0 to 1) of the given pieces, both shape (n,)."""
        return self.frame(piece, t, order).pose

    def frame(self, piece: NDArray, t: NDArray, order: int) -> FrameSeries:
        """The same with the tool's own turn, for machines that control it."""
        return in_parts(self._frame, piece, t, order)

    def axes(self, piece: NDArray, time: Series) -> Series:
        """Axis values [mm, rad], shape (n, k), as they are without tip control."""
        values = _line(self._ends, piece, time)
        turning = np.flatnonzero(self.blocks.sweep[self.rows][piece])
        if len(turning):
            values.c[:, turning, :3] = self._arc(piece[turning], Series(time.c[:, turning])).c
        return values

    def held(self, piece: NDArray) -> NDArray[np.bool_]:
        """Whether pieces are run with tip control."""
        control: NDArray[np.bool_] = self.blocks.tip_control[self.rows][piece]
        return control

    def tip(self, piece: NDArray, time: Series) -> Series:
        """Tips [mm], shape (n, 3), as they are with tip control."""
        return _line(self._tips, piece, time)

    def _frame(self, piece: NDArray, time: Series) -> FrameSeries:
        values = self.axes(piece, time)
        axes = range(values.c.shape[-1])
        tip, axis, radial = self.blocks.machine.frame_series([Series(values.c[..., i]) for i in axes])
        held = np.flatnonzero(self.held(piece))
        if len(held):
            tip.c[:, held] = self.tip(piece[held], Series(time.c[:, held])).c
        return FrameSeries(tip, axis, radial)

    @cached_property
    def _ends(self) -> tuple[NDArray, NDArray]:
        """Axis values at both ends of every piece."""
        return self.blocks.before[self.rows], self.blocks.values[self.rows]

    @cached_property
    def _tips(self) -> tuple[NDArray, NDArray]:
        """Tips [mm] at both ends of every piece, workpiece frame."""
        start, end = (self.blocks.machine.forward(values)[0] for values in self._ends)
        return start, end

    def _arc(self, piece: NDArray, time: Series) -> Series:
        """The three linear axes on pieces that are arcs."""
        blocks, row = self.blocks, self.rows[piece]
        start, end = (values[piece, :3] for values in self._ends)
        sweep, normal = blocks.sweep[row], np.eye(3)[blocks.normal[row]]
        arm = start - blocks.centre[row]
        along = (arm * normal).sum(axis=1, keepdims=True) * normal
        arm, side = arm - along, np.cross(normal, arm)
        last = (end - blocks.centre[row]) * (1.0 - np.abs(normal))
        growth = np.linalg.norm(last, axis=1) / np.linalg.norm(arm, axis=1) - 1.0
        reached = start - arm + (1.0 + growth)[:, None] * (np.cos(sweep)[:, None] * arm + np.sin(sweep)[:, None] * side)
        turn = (series.exp(time * (1j * sweep)) * (time * growth + 1.0)).column
        return turn.real * arm + turn.imag * side + time.column * (end - reached) + (start - arm)

    def _name(self, block: int) -> str:
        return f"block {block + 1} (line {self.blocks.line[block]}) for {self.blocks.machine.name}"


def in_parts(frame: Callable[[NDArray, Series], FrameSeries], piece: NDArray, t: NDArray, order: int) -> FrameSeries:
    """What a function of pieces and of the time in them gives, asked for so many at once as stay in the cache."""
    piece, t = np.asarray(piece), np.asarray(t, dtype=float)
    cuts = [slice(i, i + _AT_ONCE) for i in range(0, max(len(piece), 1), _AT_ONCE)]
    parts = zip(*(frame(piece[cut], Series.variable(t[cut], order)) for cut in cuts), strict=True)
    return FrameSeries(*(Series(np.concatenate([s.c for s in part], axis=1)) for part in parts))


def cutting(blocks: Blocks) -> ProgramMotion:
    """The motion of the feed blocks alone."""
    return ProgramMotion(blocks, ~blocks.rapid)


def _line(ends: tuple[NDArray, NDArray], piece: NDArray, time: Series) -> Series:
    """What runs linearly in time from the first to the second (p, k) of every piece, as (order + 1, n, k)."""
    start = ends[0][piece]
    return time.column * (ends[1][piece] - start) + start
