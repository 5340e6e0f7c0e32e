"""Collects moves into batches of one mode, and finished batches into blocks."""

from __future__ import annotations

from collections.abc import Callable
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from gearsim.machines.chain import Machine
from gearsim.programs.blocks import Blocks
from gearsim.programs.gcode.arc_rules import ArcRules
from gearsim.programs.gcode.errors import Line
from gearsim.programs.gcode.finish import Batch, MoveError, finish
from gearsim.programs.gcode.lexer import find_word
from gearsim.programs.gcode.moves import NO_ARC, Arc, Mode, Moves

_AT_ONCE = 4096


class Recorder:
    """Takes moves one by one or in batches; ``line_of`` gives a line's text for messages."""

    def __init__(self, machine: Machine, rules: ArcRules, all_axes: bool, line_of: Callable[[int], Line]):
        self.machine, self.rules, self.all_axes, self.line_of = machine, rules, all_axes, line_of
        self._mode: Mode | None = None
        self._start: list[float] = []
        self._ends: list[list[float]] = []
        self._rest: list[tuple[int, float, Arc, int]] = []
        self._batches: list[Batch] = []

    def add(
        self, mode: Mode, before: list[float], end: list[float], motion: int, feed: float,
        arc: Arc, line: int,
    ) -> None:  # fmt: skip
        """Take one move."""
        if mode != self._mode or len(self._ends) >= _AT_ONCE:
            self.flush()
            self._mode, self._start = mode, before
        self._ends.append(end)
        self._rest.append((motion, feed, arc, line))

    def flush(self) -> None:
        """Finish the moves taken one by one. Raises ProgramError where one cannot be run."""
        mode, ends, rest = self._mode, self._ends, self._rest
        self._mode, self._ends, self._rest = None, [], []
        if mode is not None:
            motion, feed, arc, line = zip(*rest, strict=True)
            has_arcs = any(words is not NO_ARC for words in arc)
            self._finish(
                Moves(
                    mode, np.array(self._start), np.array(ends), np.array(motion), np.array(feed),
                    np.array(arc) if has_arcs else None, np.array(line),
                )
            )  # fmt: skip

    def take(self, moves: Moves) -> None:
        """Take a batch behind what has been taken. Raises ProgramError where a move cannot be run."""
        self.flush()
        self._finish(moves)

    def _finish(self, moves: Moves) -> None:
        try:
            self._batches.append(finish(moves, self.machine, self.rules, self.all_axes))
        except MoveError as error:
            self._fail(error, int(moves.line[error.index]))

    def _fail(self, error: MoveError, number: int) -> NoReturn:
        line = self.line_of(number)
        start, end = find_word(line, error.letters)
        raise line.error(start, end, error.reason) from error

    def blocks(self, start: list[float]) -> Blocks:
        """Everything taken, from ``start`` on."""
        self.flush()
        batches, self._batches = self._batches, []
        n, k = sum(len(batch.line) for batch in batches), len(self.machine.axes)

        def column(name: str, empty: NDArray) -> NDArray:
            return np.concatenate([getattr(batch, name) for batch in batches]) if batches else empty

        sweep, centre, normal = _turns(batches, n)
        integers = np.zeros(0, dtype=np.int32)
        return Blocks(
            self.machine, np.array(start), column("values", np.zeros((0, k))), column("rapid", np.zeros(0, dtype=bool)),
            column("tip_control", np.zeros(0, dtype=bool)), column("seconds", np.zeros(0)), column("line", integers),
            column("tool", integers), column("operation", integers), sweep, centre, normal,
        )  # fmt: skip


def _turns(batches: list[Batch], n: int) -> tuple[NDArray, NDArray, NDArray]:
    """Sweeps, centres and normals; without any arc they take no memory."""
    if all(batch.turns is None for batch in batches):
        return np.broadcast_to(0.0, (n,)), np.broadcast_to(0.0, (n, 3)), np.broadcast_to(np.int8(2), (n,))
    sweep, centre, normal = np.zeros(n), np.zeros((n, 3)), np.full(n, 2, dtype=np.int8)
    at = 0
    for batch in batches:
        part = slice(at, at := at + len(batch.line))
        if batch.turns is not None:
            sweep[part], centre[part], normal[part] = batch.turns
    return sweep, centre, normal
