"""What a block must state beside its axes: a feed, the centre or radius of an arc, the time of a dwell."""

from __future__ import annotations

from math import nan

from gearsim.programs.gcode.arcs import OFFSET_LETTERS
from gearsim.programs.gcode.block import Block
from gearsim.programs.gcode.dialect import Dialect
from gearsim.programs.gcode.lexer import Word
from gearsim.programs.gcode.moves import Arc
from gearsim.programs.gcode.state import State

LEAST_FEED = 1e-6
_MOST_TURNS = 10_000
_TURN = 1e-3  # how far P may be off a whole number


def feed_word(block: Block) -> float | None:
    """The F word of a block, or None."""
    feed = block.take("F")
    if feed is not None and feed.value < LEAST_FEED:
        raise block.error(feed, "a feed is above 0")
    return None if feed is None else feed.value


def check_feed(block: Block, state: State) -> None:
    """Refuse a block that cuts without a feed that tells its time."""
    word = first_word(block)
    if state.feed_mode == 93 and "F" not in block.letters:
        raise block.error(word, "F is missing; inverse time feed (G93) needs it in every block that cuts")
    if state.feed is None:
        raise block.error(word, f"F is missing; G{state.feed_mode} is in force and has no feed yet")
    if state.feed_mode == 95 and state.spindle == 0.0:
        raise block.error(word, "S is missing; feed per revolution (G95) needs a spindle speed")


def dwell_seconds(block: Block, word: Word, dialect: Dialect) -> float:
    """How long G4 waits."""
    letters = "XP" if dialect.dwell_unit < 1.0 else "P"
    found = [time for time in map(block.take, letters) if time is not None]
    if len(found) != 1:
        raise block.error(word, f"one time to wait is expected, behind {' or '.join(letters)}")
    unit = dialect.dwell_unit if found[0].letter == "P" else 1.0
    if found[0].value < 0.0:
        raise block.error(found[0], "a time to wait is not negative")
    if "X" in letters and block.open_axes:
        raise block.error(next(iter(block.open_axes.values())), "G4 moves no axis")
    return found[0].value * unit


def arc_words(block: Block, state: State) -> Arc:
    """I, J, K and R [mm] of a circular move, nan where absent, and its turns."""
    name, allowed, word = f"G{state.motion}", OFFSET_LETTERS[state.plane], first_word(block)
    _refuse_arc(block, state, word)
    found = {letter: block.take(letter) for letter in "IJKR"}
    given = [letter for letter in "IJKR" if found[letter] is not None]
    if not given:
        raise block.error(word, f"{name} needs the centre ({', '.join(allowed)}) or the radius (R)")
    for letter in given:
        if letter not in allowed + "R":
            raise block.error(block.letters[letter], f"{letter} does not belong to the plane G{state.plane}")
    if "R" in given and len(given) > 1:
        raise block.error(block.letters["R"], "an arc has a centre or a radius, not both")
    missing = next((letter for letter in allowed if letter not in given), None)
    if state.arc_absolute and "R" not in given and missing is not None:
        raise block.error(word, f"{missing} is missing; an absolute centre (G90.1) has both coordinates")
    i, j, k = (_centre(found["IJK"[axis]], axis, state) for axis in range(3))
    r = found["R"]
    return i, j, k, nan if r is None else r.value * state.scale, _turns(block, state)


def _centre(word: Word | None, axis: int, state: State) -> float:
    """A coordinate of the centre [mm]; an absolute one is programmed in the offset in force."""
    if word is None:
        return nan
    return word.value * state.scale + (state.shift[axis] if state.arc_absolute else 0.0)


def _turns(block: Block, state: State) -> float:
    """P of an arc: how many times the end is reached."""
    if not state.dialect.turns or "P" not in block.letters:
        return 1.0
    if "one block" in block.g:
        raise block.error(
            block.letters["P"], "P counts the time of G4 and the turns of the arc; give each its own block"
        )
    word = block.letters["P"]
    block.take("P")
    turns = round(word.value)
    if abs(turns - word.value) > _TURN or not 1 <= turns <= _MOST_TURNS:
        raise block.error(word, f"P of an arc is its number of turns, a whole number from 1 to {_MOST_TURNS}")
    return float(turns)


def _refuse_arc(block: Block, state: State, word: Word) -> None:
    axes = state.machine.axes
    if state.tip:
        reason = "arcs under tool centre point control are not read; write straight blocks or switch it off by G49"
        raise block.error(word, reason)
    if axes[:3] != ("X", "Y", "Z"):
        raise block.error(word, f"arcs need slides X, Y, Z; the machine has {', '.join(axes)}")


def first_word(block: Block) -> Word:
    """The word to show for a motion: its G code, else the first axis, else whatever there is."""
    if "motion" in block.g:
        return block.g["motion"][1]
    return next(iter((block.axes or block.letters).values()))
