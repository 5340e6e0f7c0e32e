"""Motions of a real machine: a control that knows the nominal one runs a program, and the errors move the tool."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry.pose import FrameSeries, PoseSeries
from gearsim.geometry.series import Series
from gearsim.machines.errors import RealMachine
from gearsim.machines.inverse import reach_tip_series
from gearsim.motion.lost_motion import Stretches, stretches
from gearsim.motion.program import ProgramMotion, in_parts
from gearsim.programs.blocks import Blocks


@dataclass(frozen=True)
class RealMotion:
    """What a ``real`` machine does with a program: axes are commanded as its nominal one's control commands them.

    Under tip control that is the nominal machine's inverse of the straight tip line, at every instant. A block in
    which backlash is used up is several pieces. Time runs in feeds; rapids take none.
    Raises InputError where the spindle grows and a feed's time is not known, and as ``stretches``.
    """

    program: ProgramMotion
    real: RealMachine

    def __post_init__(self) -> None:
        blocks = self.program.blocks
        unknown = np.flatnonzero(~blocks.rapid & ~np.isfinite(blocks.seconds))
        if self.real.errors.grows and len(unknown):
            raise InputError(
                f"line {blocks.line[unknown[0]]}: nothing says how long this feed takes, so that the spindle's growth "
                "is not known; state a feed, or take errors.thermal's spindle values off"
            )
        _ = self._stretches

    @property
    def blocks(self) -> Blocks:
        return self.program.blocks

    @property
    def rows(self) -> NDArray[np.integer]:
        """The block of every piece, counted from 0."""
        return self.program.rows if self._stretches is None else self._stretches.block

    @property
    def pieces(self) -> int:
        return len(self.rows)

    @property
    def share(self) -> NDArray[np.floating]:
        """How much of its block's time every piece takes."""
        return self.program.share if self._stretches is None else self._stretches.end - self._stretches.start

    def pose(self, piece: NDArray, t: NDArray, order: int) -> PoseSeries:
        """Poses at t (0 to 1) of the given pieces, both shape (n,)."""
        return self.frame(piece, t, order).pose

    def frame(self, piece: NDArray, t: NDArray, order: int) -> FrameSeries:
        """The same with the tool's own turn."""
        return in_parts(self._frame, piece, t, order)

    def _frame(self, piece: NDArray, time: Series) -> FrameSeries:
        lost, own = None, piece
        if self._stretches is not None:
            parts = self._stretches
            gone = time.column * (parts.after - parts.before)[piece] + parts.before[piece]
            lost = [Series(gone.c[..., i]) for i in range(gone.c.shape[-1])]
            time = time * (parts.end - parts.start)[piece] + parts.start[piece]
            own = np.searchsorted(self.program.rows, parts.block[piece])
        minutes = None
        if self.real.errors.grows:
            minutes = time * self._minutes[1][self.rows[piece]] + self._minutes[0][self.rows[piece]]
        return self.real.frame_series(self._commanded(own, time), lost, minutes)

    def _commanded(self, piece: NDArray, time: Series) -> list[Series]:
        """Axis values on pieces of the program."""
        values = self.program.axes(piece, time)
        held = np.flatnonzero(self.program.held(piece))
        if len(held):
            turns = [Series(values.c[:, held, i]) for i in range(values.c.shape[-1])]
            tip = self.program.tip(piece[held], Series(time.c[:, held]))
            reached = reach_tip_series(self.blocks.machine, turns, tip)
            values.c[:, held] = np.stack([value.c for value in reached], axis=-1)
        return [Series(values.c[..., i]) for i in range(values.c.shape[-1])]

    @cached_property
    def _stretches(self) -> Stretches | None:
        """The pieces, where an axis has play."""
        play = self.real.backlash
        return stretches(self.blocks, play, self.program.rows) if play.any() else None

    @cached_property
    def _minutes(self) -> tuple[NDArray, NDArray]:
        """When every block starts, and how long it takes."""
        spent = np.where(self.blocks.rapid, 0.0, self.blocks.seconds) / 60.0
        return np.cumsum(spent) - spent, spent
