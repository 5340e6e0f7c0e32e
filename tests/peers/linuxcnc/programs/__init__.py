"""Random LinuxCNC programs, valid and nearly valid, in classes; a class and a number always give the same one."""

from __future__ import annotations

from collections.abc import Callable
from zlib import crc32

from tests.peers.linuxcnc.control import Control
from tests.peers.linuxcnc.programs import motion, words
from tests.peers.linuxcnc.programs.broken import broken
from tests.peers.linuxcnc.programs.dice import Dice
from tests.peers.linuxcnc.programs.exact import EXACT
from tests.peers.linuxcnc.programs.flow import flow

CLASSES: dict[str, tuple[int, Callable[[Dice], tuple[str, Control]]]] = {
    "motion": (250, motion.moves),
    "arcs": (300, motion.circles),
    "offsets": (250, motion.zeros),
    "units": (200, motion.units),
    "tables": (200, motion.tools),
    "lexical": (250, words.lexical),
    "expressions": (250, words.expressions),
    "flow": (250, flow),
    "broken": (200, broken),
}


def programs(salt: str = "") -> list[tuple[str, str, Control]]:
    """All programs: name, text, the control they run on; another ``salt`` gives others."""
    found = [
        (f"{name} {i}", *make(Dice(crc32(f"{name} {i}{salt}".encode()))))
        for name, (count, make) in CLASSES.items()
        for i in range(count)
    ]
    return found + [(f"exact {i}", text + ("" if "%" in text else "\nM2\n"), Control()) for i, text in enumerate(EXACT)]
