"""What is done to a part: operations of one tool each, and the variants under which their effect is measured."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.flutes import fluted
from gearsim.cutters.profile import Profile
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.rigid import Rigid
from gearsim.motion.segments import SegmentTable, compile_motion, join
from gearsim.motion.sources import MotionSource, MovedMotion

_COLUMNS = ("rapid", "step", "line", "section", "seconds")


@dataclass(frozen=True)
class Pieces:
    """Consecutive pieces of a longer motion, ``chosen`` (n,)."""

    source: MotionSource
    chosen: NDArray[np.integer]

    @property
    def pieces(self) -> int:
        return len(self.chosen)

    def pose(self, piece: NDArray, t: NDArray, order: int) -> PoseSeries:
        return self.source.pose(self.chosen[np.asarray(piece)], t, order)


@dataclass(frozen=True)
class Operation:
    """One tool, its exact motions one after the other, and the table compiled from them; in the part's frame.

    ``table.path`` numbers the ``sources``. Of the table's rows, all shape (rows,), ``rapid`` says whether they are run
    by rapid, ``step`` which move of the whole program they belong to, in its order, ``line`` in which line of
    ``text``, the program they came from, it stands (0: in none), and ``section`` under which of the program's
    ``headings``, where they are known; ``seconds`` how long a row takes (nan: no feed says it, or it is by rapid).
    ``holder`` is what stands above the cutter's flutes, where it is given: it may begin below the cutter's top.
    """

    name: str
    cutter: Profile
    sources: tuple[MotionSource, ...]
    table: SegmentTable
    rapid: NDArray[np.bool_]
    step: NDArray[np.integer]
    line: NDArray[np.integer]
    section: NDArray[np.integer]
    seconds: NDArray[np.floating]
    text: str = ""
    headings: tuple[str, ...] = ()
    holder: Profile | None = None

    def __len__(self) -> int:
        """Rows of the table."""
        return len(self.table)

    def part(self, rows: NDArray | slice) -> Operation:
        """The same operation with the chosen rows alone: a mask, indices or a slice."""
        columns: dict[str, Any] = {name: getattr(self, name)[rows] for name in _COLUMNS}
        return replace(self, table=self.table.part(rows), **columns)

    def carried(self, tolerance: float) -> Operation:
        """What its holder does meanwhile, as an operation of its own, compiled to a tolerance [mm].

        Its rows have the columns of the same pieces here. Raises ValueError where there is no holder.
        """
        if self.holder is None:
            raise ValueError(f"operation {self.name} has no holder")
        table = join([compile_motion(source, self.holder.reach, tolerance) for source in self.sources])
        wide = 1 + max(int(t.piece.max(initial=0)) for t in (self.table, table))
        here, there = (t.path * wide + t.piece for t in (self.table, table))
        kept, row = np.unique(here, return_index=True)
        table = table.part(np.isin(there, kept))
        same = row[np.searchsorted(kept, there[np.isin(there, kept)])]
        columns: dict[str, Any] = {name: getattr(self, name)[same] for name in _COLUMNS}
        return replace(self, cutter=self.holder, holder=None, table=table, **columns)

    def by_flutes(self) -> Operation:
        """What it cuts with its flutes alone, where its holder begins below the cutter's top; else itself."""
        if self.holder is None or not self.holder.box[2] < self.cutter.height:
            return self
        return replace(self.part(slice(None)), cutter=fluted(self.cutter, self.holder.box[2]))

    def motions(self) -> list[MotionSource]:
        """The exact motions of its rows in feed, cut up where rows are missing or run by rapid."""
        found: list[MotionSource] = []
        for path, source in enumerate(self.sources):
            pieces = np.unique(self.table.piece[(self.table.path == path) & ~self.rapid])
            if len(pieces) == source.pieces:
                found.append(source)
            elif len(pieces):
                runs = np.split(pieces, np.flatnonzero(np.diff(pieces) > 1) + 1)
                found += [Pieces(source, run) for run in runs]
        return found


@dataclass(frozen=True)
class Variant:
    """Operations that cut together, by a ``name`` under which their effect is told, and what they are in words.

    ``surfaces`` it is meant for (none: all of the part's).
    """

    name: str
    text: str
    operations: tuple[Operation, ...]
    surfaces: tuple[str, ...] = ()

    def __len__(self) -> int:
        """Rows of all its tables."""
        return sum(map(len, self.operations))

    def motions(self) -> list[MotionSource]:
        """The exact motions of its one operation. Raises ValueError where it has several."""
        (operation,) = self.operations
        return operation.motions()

    @property
    def cutter(self) -> Profile:
        """The tool of its one operation. Raises ValueError where it has several."""
        (operation,) = self.operations
        return operation.cutter

    def chosen(self, choose: Callable[[int, Operation], NDArray[np.bool_]]) -> Variant:
        """The rows that ``choose`` picks of every operation; operations of which nothing is left are gone."""
        rows = [choose(i, operation) for i, operation in enumerate(self.operations)]
        left = (o.part(r) for o, r in zip(self.operations, rows, strict=True) if r.any())
        return replace(self, operations=tuple(left))


def operation(
    name: str, cutter: Profile, sources: Sequence[MotionSource], tolerance: float, *, rapid: Sequence[bool] = (),
    holder: Profile | None = None, lines: Sequence[Sequence[int]] = (), seconds: Sequence[Sequence[float]] = (),
    tables: Sequence[SegmentTable] = (),
) -> Operation:  # fmt: skip
    """Compile motions of one tool to a tolerance [mm], a step each; ``rapid`` says which are (none given: none is).

    ``tables``: what the motions are compiled to, where that is known.

    Of each motion the points, one more than its pieces: ``lines`` of the program that state them, and ``seconds`` on
    the way to them; a piece goes to the end of its line.
    """
    table = join(list(tables) or [compile_motion(source, cutter.reach, tolerance) for source in sources])
    fast = np.array(rapid or [False] * len(sources))[table.path]
    line = _at_the_end(table, lines, 0).astype(int)
    time = _at_the_end(table, seconds, np.nan) * (table.end - table.start)
    still = np.zeros(len(table), dtype=int)
    return Operation(name, cutter, tuple(sources), table, fast, table.path, line, still, time, holder=holder)


def _at_the_end(table: SegmentTable, values: Sequence[Sequence[float]], without: float) -> NDArray:
    """Of every row what is given for the point at its piece's end."""
    if not values:
        return np.full(len(table), without)
    first = np.cumsum([0, *map(len, values)])
    return np.concatenate([np.asarray(given) for given in values])[first[table.path] + table.piece + 1]


def turned_copies(once: Operation, count: int) -> Operation:
    """An operation done ``count`` times, the part indexed about its z axis by as many equal steps in a whole turn."""
    angles = 2.0 * np.pi * np.arange(count) / count
    cos, sin, zero = np.cos(angles), np.sin(angles), np.zeros(count)
    rotations = np.stack([cos, -sin, zero, sin, cos, zero, zero, zero, zero + 1.0], axis=1).reshape(-1, 3, 3)
    turns = [Rigid(rotation, np.zeros(3)) for rotation in rotations]
    sources = [
        once.sources if k == 0 else tuple(MovedMotion(s, turn) for s in once.sources) for k, turn in enumerate(turns)
    ]
    table = join([once.table if k == 0 else once.table.moved(turn) for k, turn in enumerate(turns)])
    number = np.repeat(np.arange(count), len(once))
    columns: dict[str, Any] = {name: np.tile(getattr(once, name), count) for name in _COLUMNS}
    columns["step"] = columns["step"] + number * (1 + int(once.step.max(initial=-1)))
    path = np.tile(once.table.path, count) + number * len(once.sources)
    return replace(once, table=replace(table, path=path), sources=tuple(s for some in sources for s in some), **columns)
