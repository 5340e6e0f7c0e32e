"""What a program makes the machine do, in one form for both readers: moves of the spindle nose."""

from __future__ import annotations

import math
from dataclasses import dataclass

TURN = 2.0 * math.pi
FUZZ = 1e-6  # [rad] an arc this short is a whole turn (posemath's CIRCLE_FUZZ)


@dataclass(frozen=True)
class Move:
    """One move: ``kind`` rapid, feed, arc or dwell.

    ``end``: X Y Z A B C in machine coordinates [mm, degrees]; ``seconds``: nan for rapids; arcs turn about
    ``centre`` [mm] in the plane (G17: X Y) by ``sweep`` [rad].
    """

    kind: str
    end: tuple[float, ...]
    seconds: float = math.nan
    centre: tuple[float, float] = (0.0, 0.0)
    sweep: float = 0.0
    plane: int = 17


def stands(move: Move, before: tuple[float, ...], tolerance: float = 1e-7) -> bool:
    """Whether a straight move goes nowhere: not every reader reports such a block."""
    return move.kind in ("rapid", "feed") and max(abs(a - b) for a, b in zip(move.end, before, strict=True)) < tolerance


def differences(peer: list[Move], ours: list[Move], tolerance: float = 1e-6) -> str:
    """What differs first, in words; empty if nothing does. ``tolerance`` [mm, degrees] is what the peer prints."""
    for i, (a, b) in enumerate(zip(peer, ours, strict=False)):
        found = _difference(a, b, tolerance)
        if found:
            return f"move {i + 1}: {found}\n   peer {a}\n   ours {b}"
    if len(peer) != len(ours):
        longer, name = (peer, "peer") if len(peer) > len(ours) else (ours, "ours")
        return f"peer has {len(peer)} moves, ours {len(ours)}; {name} goes on with {longer[min(len(peer), len(ours))]}"
    return ""


def _difference(a: Move, b: Move, tolerance: float) -> str:
    if a.kind != b.kind:
        return f"kind {a.kind}, ours {b.kind}"
    if not all(abs(p - q) <= tolerance for p, q in zip(a.end, b.end, strict=True)):
        return "end"
    if a.kind != "rapid" and not abs(a.seconds - b.seconds) <= 1e-6 * max(1.0, abs(a.seconds)):
        return f"time {a.seconds:.6g} s, ours {b.seconds:.6g} s"
    if a.kind == "arc":
        if a.plane != b.plane:
            return "plane"
        if not all(abs(p - q) <= tolerance for p, q in zip(a.centre, b.centre, strict=True)):
            return "centre"
        if not abs(a.sweep - b.sweep) <= 1e-5:
            return f"sweep {math.degrees(a.sweep):.6g} deg, ours {math.degrees(b.sweep):.6g} deg"
    return ""
