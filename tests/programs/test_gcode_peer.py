"""Programs in classes against what LinuxCNC's stand-alone interpreter made of them, move by move.

The answers are data (version: tests/peers/linuxcnc/peer.py); ``python -m tests.peers.linuxcnc --ask`` asks anew.
"""

from collections import Counter
from dataclasses import replace

import pytest

from tests.peers.linuxcnc import canon
from tests.peers.linuxcnc.answers import digest, load
from tests.peers.linuxcnc.control import Control
from tests.peers.linuxcnc.moves import differences
from tests.peers.linuxcnc.programs import CLASSES, programs
from tests.peers.linuxcnc.reading import read
from tests.peers.linuxcnc.verdict import AGREE, DIFFER, judge


@pytest.fixture(scope="module")
def asked():
    answers, found = load(), {}
    for name, program, control in programs():
        found.setdefault(name.split()[0], []).append((name, program, control, answers[name]))
    return found


@pytest.mark.parametrize(("kind", "least"), [(name, 0.25 if name == "broken" else 0.6) for name in (*CLASSES, "exact")])
def test_programs_agree_with_the_peer_or_are_refused(asked, kind, least):
    """Never a move that the peer does not make, nor a program read that it refuses; and most are read."""
    seen = Counter()
    for name, program, control, answer in asked[kind]:
        assert answer.digest == digest(program, control), f"{name} is not what the peer was asked; ask anew"
        verdict = judge(program, control, answer)
        assert verdict.name != DIFFER, f"{name}, {control}:\n{program}\n{verdict.detail}"
        seen[verdict.name] += 1
    assert seen[AGREE] >= least * len(asked[kind]), seen


def test_the_comparison_sees_what_differs():
    """Every column of a move counts."""
    program, control = "G21 F60\nG0 X1 B3\nG1 Y2\nG3 X3 Y4 I2 J0\nG4 P2\nM2\n", Control(offsets={"G54": {"Z": 5.0}})
    moves = read(program, control)
    assert [move.kind for move in moves] == ["rapid", "feed", "arc", "dwell"]
    assert moves[2].end == pytest.approx((3.0, 4.0, 0.0, 0.0, 3.0, 0.0))
    assert not differences(moves, moves)
    for i, name, value in [
        (0, "kind", "feed"), (0, "end", (1.0, 0.0, 1e-5, 0.0, 3.0, 0.0)), (1, "seconds", 2.001), (2, "sweep", 1.0),
        (2, "centre", (3.00001, 2.0)), (2, "plane", 18), (3, "seconds", 1.0), (2, "centre", (float("nan"), 2.0)),
    ]:  # fmt: skip
        changed = [replace(move, **{name: value}) if k == i else move for k, move in enumerate(moves)]
        assert differences(moves, changed), name
    assert differences(moves, moves[:-1])
    assert differences(moves[:-1], moves)


def test_canonical_calls_become_moves_of_the_machine():
    """Units, offsets, tool length, planes and feed modes of the peer's calls."""
    calls = [
        "USE_LENGTH_UNITS(CANON_UNITS_MM)", "SET_G5X_OFFSET(1, 10.0, 0.0, 3.0, 0.0, 0.0, 0.0)",
        "SET_FEED_RATE(120.0)", "USE_TOOL_LENGTH_OFFSET(0.0 0.0 50.0, 0.0 0.0 0.0, 0.0 0.0 0.0)",
        "STRAIGHT_TRAVERSE(1.0, 2.0, -3.0, 0.0, 0.0, 0.0)", "USE_LENGTH_UNITS(CANON_UNITS_INCHES)",
        "STRAIGHT_FEED(1.0, 0.0, 0.0, 0.0, 0.0, 0.0)", "SELECT_PLANE(CANON_PLANE_XZ)", "SET_FEED_RATE(2.0)",
        "ARC_FEED(1.0, 1.0, 0.5, 1.0, -2, 0.0, 0.0, 0.0, 0.0)", "DWELL(1.5)", "DWELL(0.0)",
    ]  # fmt: skip
    found = canon.moves(calls)
    assert [move.kind for move in found] == ["rapid", "feed", "arc", "dwell"]
    assert found[0].end == pytest.approx((11.0, 2.0, 50.0, 0.0, 0.0, 0.0))
    assert found[1].end == pytest.approx((35.4, 0.0, 53.0, 0.0, 0.0, 0.0))
    assert found[1].seconds == pytest.approx(((24.4**2 + 2.0**2 + 3.0**2) ** 0.5) / 2.0)
    assert found[2].plane == 18
    assert found[2].centre == pytest.approx((53.0 + 12.7, 35.4))
    assert found[2].sweep == pytest.approx(-3.0 * 3.141592653589793)
    assert found[3].seconds == 1.5
