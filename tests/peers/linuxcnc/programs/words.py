"""Programs whose difficulty lies in how they are written: forms of lines and numbers, expressions, parameters."""

from __future__ import annotations

from tests.peers.linuxcnc.control import Control
from tests.peers.linuxcnc.programs import motion
from tests.peers.linuxcnc.programs.dice import Dice

COMMENTS = ("(c)", "(G0 X9)", "()", "(a;b)", "(MSG, hi)", "(debug, #1)", "( % )", "(café)")
FUNCTIONS = ("ABS", "ACOS", "ASIN", "COS", "EXP", "FIX", "FUP", "LN", "ROUND", "SIN", "SQRT", "TAN")
OPERATORS = (
    "+",
    "-",
    "*",
    "/",
    "**",
    " MOD ",
    " EQ ",
    " NE ",
    " GT ",
    " GE ",
    " LT ",
    " LE ",
    " AND ",
    " OR ",
    " XOR ",
)
SAFE = tuple(operator for operator in OPERATORS if operator not in ("/", "**", " MOD "))


def lexical(dice: Dice) -> tuple[str, Control]:
    """A program of moves or arcs written in a strange form; sometimes between signs %."""
    text, control = dice.pick((motion.moves, motion.circles, motion.tools))(dice)
    lines = [_written(dice, line) if dice.chance(0.8) else line for line in text.splitlines()]
    if not control.tools:  # Z behind a tool change and the end must not be passed over
        lines[:-1] = [dice.pick(("/", " /", "/ ")) + line if dice.chance(0.1) else line for line in lines[:-1]]
    if dice.chance(0.2):
        lines = ["%", *lines[:-1], "%"]
    if dice.chance(0.1):
        lines.insert(0, dice.pick(("", "   ", "(head)", "O1000", "o<part> (name)", ";")))
    ends = "\r\n" if dice.chance(0.2) else "\n"
    deleted = Control(control.offsets, control.tools, control.home, block_delete=dice.chance(0.5))
    return ends.join(lines) + ends, deleted


def _written(dice: Dice, line: str) -> str:
    """The line with blanks, comments, cases, line numbers."""
    out = []
    for char in line:
        if char.isalpha() and dice.chance(0.08):
            out.append(dice.pick(COMMENTS))
        out.append(char.lower() if dice.chance(0.3) else char)
        if dice.chance(0.06):
            out.append(dice.pick((" ", "\t", "  ")))
    found = "".join(out)
    if "(" in line or ";" in line:
        found = line
    if dice.chance(0.2):
        found += dice.pick(
            (" ;", "; G0 X1", "(end)", " ", "\t", "  (a) (b)", ";(((", " )" if dice.chance(0.05) else "")
        )
    if dice.chance(0.2):
        found = f"N{dice.whole(0, 9999)}{dice.pick((' ', '', '  '))}{found}"
    return found


def expression(dice: Dice, depth: int, names: tuple[str, ...] = ("#1", "#2", "#3", "#<size>")) -> str:
    """An expression that may stand between brackets."""
    if depth == 0 or dice.chance(0.15):
        return _operand(dice, names)
    kind = dice.whole(0, 9)
    if kind < 5:
        parts = [expression(dice, depth - 1, names)]
        for _ in range(dice.whole(1, 3)):
            parts += [dice.pick(OPERATORS if dice.chance(0.2) else SAFE), expression(dice, depth - 1, names)]
        return "".join(parts)
    if kind < 7:
        safe = ("ABS", "FIX", "FUP", "ROUND", "SIN", "COS", "TAN")
        return f"{dice.pick(safe if dice.chance(0.8) else FUNCTIONS)}[{expression(dice, depth - 1, names)}]"
    if kind < 8:
        return f"ATAN[{expression(dice, depth - 1, names)}]/[{expression(dice, depth - 1, names)}]"
    return f"[{expression(dice, depth - 1, names)}]"


def _operand(dice: Dice, names: tuple[str, ...]) -> str:
    kind = dice.whole(0, 9)
    if kind < 6:
        value = dice.pick((0, 1, 2, 3, 4, 5, 7, 10, 30, 45, 60, 90, 180, 0.5, 2.5, 1.0001, 0.99995, 0.3, -1, -2.5))
        return str(value)
    if kind < 9:
        return dice.pick(names)
    return dice.pick(("-#1", "+2", "EXISTS[#<size>]", "EXISTS[#<none>]", "#[1+1]", "-[2]", "--1", ".5", "5."))


def expressions(dice: Dice) -> tuple[str, Control]:
    """Parameters set and used."""
    lines = [f"#1={dice.whole(-3, 9)} #2={dice.length()} #3={dice.whole(1, 3)}", "#<size>=4", "G0"]
    for _ in range(dice.whole(3, 9)):
        kind = dice.whole(0, 9)
        if kind < 3:
            target = dice.pick(("#1", "#2", "#<size>", "#<_all>", "#[2-1]", "#31", "#<Si ze>"))
            lines.append(f"{target} = [{expression(dice, 2)}]")
        elif kind < 4:
            lines.append(f"#1=[{expression(dice, 1)}] X#1 #1=[#1+1] Y#1")
        else:
            lines.append(f"{dice.pick('XYZ')}[{expression(dice, dice.whole(1, 3))}]")
    return motion.text(lines), Control()
