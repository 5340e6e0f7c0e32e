"""Codes that move the program's zero: work offsets, G10, G52, G92 and what belongs to it. No axis moves.

LinuxCNC 2.9 has one register for G52 and G92, the later word of an axis holds (``interp_convert.cc``); on a Fanuc
G92 ends the local zero of the axes it names (operator's manual, G52, note 4).
"""

from __future__ import annotations

from gearsim.programs.gcode.block import Block
from gearsim.programs.gcode.lexer import Word
from gearsim.programs.gcode.state import State

_OFFSETS = ("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3")


def refuse_tip(block: Block, word: Word, state: State) -> None:
    """Refuse what nobody can tell the sense of under tool centre point control."""
    if state.tip:
        raise block.error(word, "tool centre point control is on; switch it off by G49 before")


def work_offset(block: Block, code: int, word: Word, state: State) -> None:
    """G54 and its like."""
    name = f"G{code / 10:g}"
    if code == 541:
        name += f" P{_number(block, word, 300)}"
    state.offsets.active = name
    state.refer()


def local(block: Block, word: Word, state: State) -> None:
    """G52: a zero of the program's own, seen from the work offset."""
    _need_axes(block, word, state)
    register = state.offsets.shifted if state.dialect.one_register else state.offsets.local
    for i, value in state.stated(block).items():
        register[i] = value
    _keep(state)


def shift_here(block: Block, word: Word, state: State) -> None:
    """G92: the place where the tool stands gets the programmed values."""
    _need_axes(block, word, state)
    offsets = state.offsets
    for i, value in state.stated(block).items():
        offsets.shifted[i] += offsets.local[i] + state.position[i] - (value + state.shift[i])
        offsets.local[i] = 0.0
    _keep(state)


def shift_kept(block: Block, code: int, word: Word, state: State) -> None:
    """G92.1 clears the register, G92.2 sets it aside, G92.3 brings it back."""
    refuse_tip(block, word, state)
    offsets, none = state.offsets, [0.0] * len(state.position)
    offsets.shifted = offsets.saved[:] if code == 923 else none[:]
    if code == 921:
        offsets.saved = none
    state.refer()


def is_where_it_stands(block: Block, code: int, state: State) -> bool:
    """Whether a code sets the zero by the place where the tool stands."""
    kind = block.letters.get("L")
    return code == 920 or (code == 100 and state.dialect.one_register and kind is not None and round(kind.value) == 20)


def table(block: Block, word: Word, state: State) -> None:
    """G10 L2 and L20: the place of a work offset, stated, or such that the tool stands at the programmed values."""
    refuse_tip(block, word, state)
    kind = block.whole(block.need("L", word, "what is set"))
    if kind not in (2, 20):
        reason = f"G10 L{kind} is not read; put tool lengths and parameters into the settings"
        raise block.error(block.letters["L"], f"{reason}; L2 and L20 set work offsets")
    turn = block.take("R") if state.dialect.one_register else None
    if turn is not None and (turn.value != 0.0 or kind == 20):
        raise block.error(turn, "a rotation of the work offset is not read; rotate the program")
    name, offsets = _named(block, word, kind, state), state.offsets
    place = offsets.of(name)
    for i, value in state.stated(block).items():
        if kind == 20 and state.dialect.one_register:
            place[i] = offsets.of(offsets.active)[i] + state.position[i] - (value + state.shift[i])
        else:
            place[i] = value + (place[i] if state.dialect.incremental_tables and not state.absolute else 0.0)
    offsets.put(name, place)
    state.refer()


def _named(block: Block, word: Word, kind: int, state: State) -> str:
    """The work offset that P of G10 means."""
    if not state.dialect.one_register:
        return f"G54.1 P{_number(block, word, 300)}" if kind == 20 else _OFFSETS[_number(block, word, 6) - 1]
    number = block.whole(block.need("P", word, "the number of the work offset"), len(_OFFSETS))
    return _OFFSETS[number - 1] if number else state.offsets.active


def _number(block: Block, word: Word, largest: int) -> int:
    number = block.need("P", word, "the number of the work offset")
    found = block.whole(number)
    if not 1 <= found <= largest:
        kind = "additional work offsets" if largest == 300 else "work offsets"
        raise block.error(number, f"{kind} are P1 to P{largest}")
    return found


def _need_axes(block: Block, word: Word, state: State) -> None:
    refuse_tip(block, word, state)
    if not block.axes:
        raise block.error(word, "axis words are missing")


def _keep(state: State) -> None:
    state.offsets.saved = state.offsets.shifted[:]
    state.refer()
