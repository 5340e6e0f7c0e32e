"""What the two readers make of one program, side by side."""

from __future__ import annotations

import re
from dataclasses import dataclass

from gearsim.programs.gcode import ProgramError
from tests.peers.linuxcnc import reading
from tests.peers.linuxcnc.answers import Kept
from tests.peers.linuxcnc.control import Control
from tests.peers.linuxcnc.moves import differences

AGREE, BOTH_REFUSE, OURS_REFUSES, DIFFER = "agree", "refused by both", "refused by ours alone", "differ"


@dataclass(frozen=True)
class Verdict:
    """One of the four above; ``detail``: our reason, or what differs."""

    name: str
    detail: str = ""


def judge(program: str, control: Control, answer: Kept) -> Verdict:
    """Compare our reading of a program with the peer's answer."""
    try:
        ours = reading.read(program, control)
    except ProgramError as error:
        reason = str(error).partition(": ")[2]
        return Verdict(BOTH_REFUSE if answer.refused else OURS_REFUSES, reason)
    if answer.refused:
        return Verdict(DIFFER, "the peer refuses it")
    found = differences(answer.moves, ours)
    return Verdict(DIFFER, found) if found else Verdict(AGREE)


def kind(reason: str) -> str:
    """A reason without the numbers and words of the one program."""
    return re.sub(r"[-+]?\d[\d.]*(e-?\d+)?", "#", re.sub(r"\bO<[^>]*>|\bO\d+", "O", reason))
