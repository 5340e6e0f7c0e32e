"""Programs of the other classes with a character too many, too few or wrong."""

from __future__ import annotations

from tests.peers.linuxcnc.control import Control
from tests.peers.linuxcnc.programs import motion, words
from tests.peers.linuxcnc.programs.dice import Dice
from tests.peers.linuxcnc.programs.flow import flow

SIGNS = "GXYZFIJRPMTN#[]()=.-+/*%;<>oO0123456789 \té"
MAKERS = (motion.moves, motion.circles, motion.zeros, motion.tools, words.lexical, words.expressions, flow)


def broken(dice: Dice) -> tuple[str, Control]:
    """One or two characters changed; the end stays, and no F comes to stand beside the word of a unit."""
    text, control = dice.pick(MAKERS)(dice)
    body, end = text[:-3], text[-3:]
    for _ in range(dice.whole(1, 2)):
        at = dice.whole(0, max(len(body) - 1, 0))
        body = body[:at] + dice.pick(("", dice.pick(SIGNS), body[at : at + 2])) + body[at + dice.whole(0, 1) :]
    return body + end, control
