"""What a block that cuts must state beside its axes: a feed, and the centre or radius of an arc."""

from __future__ import annotations

from math import nan

from gearsim.programs.gcode.arcs import OFFSET_LETTERS
from gearsim.programs.gcode.block import Block
from gearsim.programs.gcode.lexer import Word
from gearsim.programs.gcode.state import State

Arc = tuple[float, float, float, float]


def check_feed(block: Block, state: State) -> None:
    """Refuse a block that cuts without a feed that tells its time."""
    word = _first(block)
    if state.feed_mode == 93 and "F" not in block.letters:
        raise block.error(word, "F is missing; inverse time feed (G93) needs it in every block that cuts")
    if state.feed is None:
        raise block.error(word, f"F is missing; G{state.feed_mode} is in force and has no feed yet")
    if state.feed_mode == 95 and state.spindle == 0.0:
        raise block.error(word, "S is missing; feed per revolution (G95) needs a spindle speed")


def arc_words(block: Block, state: State) -> Arc:
    """I, J, K and R [mm] of a circular move, nan where absent."""
    name, allowed, word = f"G{state.motion}", OFFSET_LETTERS[state.plane], _first(block)
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
    i, j, k, r = (nan if entry is None else entry.value * state.scale for entry in found.values())
    return i, j, k, r


def _refuse_arc(block: Block, state: State, word: Word) -> None:
    axes = state.machine.axes
    if state.tip:
        reason = "arcs under tool centre point control are not read; write straight blocks or switch it off by G49"
        raise block.error(word, reason)
    if axes[:3] != ("X", "Y", "Z"):
        raise block.error(word, f"arcs need slides X, Y, Z; the machine has {', '.join(axes)}")


def _first(block: Block) -> Word:
    """The word to show for a motion: its G code, else the first axis, else whatever there is."""
    if "motion" in block.g:
        return block.g["motion"][1]
    return next(iter((block.axes or block.letters).values()))
