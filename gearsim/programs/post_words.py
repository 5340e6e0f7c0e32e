"""Blocks as words of the Fanuc dialect: all blocks of an operation at once, modal words only where they change.

F is rounded down, so that no block runs faster than asked. G93 states one over a block's minutes. G94 states the
length the control divides by: that of the tip on the workpiece under tip control, of the path in an arc's plane,
and else of all axes together, a degree counting as a millimetre. Arcs are always in G94: controls do not agree on
what G93 means in them (some take the radius, not the length, for the distance).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.programs.blocks import Blocks
from gearsim.programs.post_options import PostOptions

FEED_DECIMALS = 3
_LARGEST = 1e4
_SWEEP_RAD = 1e-2
_MOTION = np.array(["G00", "G01", "G02", "G03"], dtype=object)
_PLANES = np.array(["G19", "G18", "G17"], dtype=object)


@dataclass(frozen=True)
class Words:
    """An operation's blocks as a program states them; ``name`` of the operation stands in messages.

    Raises InputError for values that no program can state.
    """

    blocks: Blocks
    options: PostOptions
    name: str

    def __post_init__(self) -> None:
        self._check_values()
        self._check_arcs()

    @property
    def held(self) -> bool:
        """Whether the operation runs under tip control. Raises InputError where only a part of it does."""
        held = self.blocks.tip_control
        if held.any() and not held.all():
            raise InputError(
                f"operation {self.name!r}: block {int(np.argmax(held != held[0])) + 1} changes tip control; a tool's "
                "length is set once an operation, so make two operations of it"
            )
        return bool(held.any())

    @property
    def scale(self) -> NDArray[np.floating]:
        """Units of the last decimal a mm or degree, an axis each."""
        return 10.0 ** np.array(self.decimals)

    @property
    def decimals(self) -> list[int]:
        kinds = (self.options.linear_decimals, self.options.rotary_decimals)
        return [kinds[joint.is_rotary] for joint in self.blocks.machine.joints]

    @cached_property
    def stated(self) -> NDArray[np.floating]:
        """What is stated for the start and every block, (n + 1, k) [mm, deg], in units of the last decimal."""
        blocks = self.blocks
        values = np.concatenate([blocks.start[None], blocks.values])
        values[:, 3:] = np.degrees(values[:, 3:])
        if self.held:
            values[:, :3] = self.tips(np.concatenate([blocks.start[None], blocks.values]))
        return np.rint(values * self.scale) + 0.0

    def tips(self, values: NDArray) -> NDArray:
        """What X, Y, Z state under tip control: the tip on the workpiece [mm]."""
        return self.blocks.machine.forward(values)[0]

    @cached_property
    def rows(self) -> NDArray[np.integer]:
        """The blocks that state anything new."""
        return np.flatnonzero((np.diff(self.stated, axis=0) != 0.0).any(axis=1) | self._arc)

    @property
    def lines(self) -> list[str]:
        """The lines of the motion; nothing is taken for granted from before but the start."""
        rows, blocks = self.rows, self.blocks
        if not len(rows):
            raise InputError(f"operation {self.name!r}: no block moves the machine by a unit of its last decimal")
        kind = np.where(blocks.rapid, 0, np.where(self._arc, np.where(blocks.sweep > 0.0, 3, 2), 1))[rows]
        feeds, arcs = rows[kind > 0], rows[kind > 1]
        inverse = (self.options.feed_mode == "inverse-time") & ~self._arc
        mode = np.where(inverse, "G93 ", "G94 ").astype(object)
        columns = [
            self._column(arcs, _PLANES[blocks.normal[arcs]] + " ", _changes(blocks.normal[arcs])),
            self._column(feeds, mode[feeds], _changes(inverse[feeds])),
            self._column(rows, _MOTION[kind], _changes(kind)),
        ]
        moved = np.diff(self.stated, axis=0) != 0.0
        for i, (axis, decimals) in enumerate(zip(blocks.machine.axes, self.decimals, strict=True)):
            shown = np.flatnonzero(moved[:, i])
            columns.append(self._column(shown, number_words(axis, self.stated[shown + 1, i], decimals)))
        for i, letter in enumerate("IJK"):
            shown = arcs[blocks.normal[arcs] != i]
            words = number_words(letter, self._centres[shown, i], self.options.linear_decimals)
            columns.append(self._column(shown, words))
        feed = self._feed(feeds, inverse[feeds])
        shown = inverse[feeds] | _changes(feed) | _changes(inverse[feeds])
        columns.append(self._column(feeds, number_words("F", feed, FEED_DECIMALS), shown))
        return [line.strip() for line in sum(columns[1:], columns[0])[rows]]

    @property
    def _arc(self) -> NDArray[np.bool_]:
        return self.blocks.sweep != 0.0

    @cached_property
    def _centres(self) -> NDArray[np.floating]:
        """I, J, K of every block in units of the last decimal: from the stated start to the centre."""
        start = self.stated[:-1, :3]
        return np.where(self._arc[:, None], np.rint(self.blocks.centre * self.scale[:3]) - start, 0.0) + 0.0

    def _column(self, rows: NDArray, words: NDArray, shown: NDArray | None = None) -> NDArray:
        """Words that stand in ``rows`` where ``shown``, for all blocks."""
        column = np.full(len(self.blocks), "", dtype=object)
        some = slice(None) if shown is None else shown
        column[rows[some]] = words[some]
        return column

    def _feed(self, rows: NDArray, inverse: NDArray) -> NDArray:
        """F of feed blocks in units of its last decimal."""
        seconds = self.blocks.seconds[rows]
        wrong = np.flatnonzero(~(np.isfinite(seconds) & (seconds > 0.0)))
        if len(wrong):
            raise InputError(
                f"{self._where(rows[wrong[0]])}: it takes {seconds[wrong[0]]:g} s; a feed needs a positive time"
            )
        steps = np.diff(self.stated / self.scale, axis=0)[rows]
        linear, rotary = (np.linalg.norm(part, axis=1) for part in (steps[:, :3], steps[:, 3:]))
        length = np.where(linear > 0.0, linear, rotary) if self.held else np.hypot(linear, rotary)
        radius = np.linalg.norm(self._centres[rows] * (np.arange(3) != self.blocks.normal[rows, None]), axis=1)
        radius /= self.scale[0]
        length = np.where(self._arc[rows], radius * np.abs(self.blocks.sweep[rows]), length)
        feed = np.where(inverse, 60.0, 60.0 * length) / seconds
        units = np.floor(np.minimum(feed, self.options.max_feed) * 10**FEED_DECIMALS + 1e-6)
        return np.maximum(units, 1.0)

    def _where(self, block: int) -> str:
        return f"operation {self.name!r}, block {block + 1}"

    def _check_values(self) -> None:
        stated = self.stated / self.scale
        wrong = np.argwhere(~(np.abs(stated) < _LARGEST))
        if len(wrong):
            row, column = wrong[0]
            joint = self.blocks.machine.joints[column]
            where = self._where(row - 1) if row else f"operation {self.name!r}, start"
            raise InputError(
                f"{where}: {joint.name} would be {stated[row, column]:.3f} {'deg' if joint.is_rotary else 'mm'}; "
                "a word holds four digits before the point"
                + ("; wind the axis back between passes" if joint.is_rotary else "")
            )

    def _check_arcs(self) -> None:
        """Refuse arcs that would be read as other arcs, because they turn too far or rounding joins their ends."""
        rows = np.flatnonzero(self._arc)
        if self.held and len(rows):
            raise InputError(f"{self._where(rows[0])}: an arc cannot be stated under tip control")
        normal, sweep = self.blocks.normal[rows], self.blocks.sweep[rows]
        u, v, each = (normal + 1) % 3, (normal + 2) % 3, np.arange(len(rows))
        arm = -self._centres[rows]
        to = arm + np.diff(self.stated[:, :3], axis=0)[rows]
        angles = [np.arctan2(at[each, v], at[each, u]) for at in (arm, to)]
        turn = np.sign(sweep) * (angles[1] - angles[0]) % (2.0 * np.pi)
        turn = np.where(turn < 1e-12, 2.0 * np.pi, turn)
        wrong = np.flatnonzero(np.abs(turn - np.abs(sweep)) > _SWEEP_RAD)
        if len(wrong):
            i = wrong[0]
            raise InputError(
                f"{self._where(rows[i])}: its arc turns by {np.degrees(abs(sweep[i])):.6g} deg and would be read as "
                f"one of {np.degrees(turn[i]):.6g} deg; an arc turns once at most, and its ends must differ by more "
                "than the last decimal or not at all"
            )


def number_words(letter: str, units: NDArray, decimals: int) -> NDArray:
    """Words such as " X12.340" of numbers given in units of the last decimal."""
    words = [f" {letter}{value:.{decimals}f}" for value in (units / 10.0**decimals).tolist()]
    return np.array(words, dtype=object)


def joined(letters: Sequence[str], units: NDArray, decimals: Sequence[int]) -> str:
    """The words of some axes in one position, joined."""
    cells = zip(letters, units, decimals, strict=True)
    return "".join(number_words(letter, np.array([value]), digits)[0] for letter, value, digits in cells).strip()


def _changes(values: NDArray) -> NDArray[np.bool_]:
    """Where a value differs from the one before it; the first always does."""
    return np.concatenate([[True], values[1:] != values[:-1]])[: len(values)]
