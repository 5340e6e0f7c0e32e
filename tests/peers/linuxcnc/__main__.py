"""Runs given programs, or the random ones, through the peer and through gearsim's reader, and says what differs."""

from __future__ import annotations

import argparse
import json
import tempfile
from collections import Counter
from pathlib import Path

from tests.peers.linuxcnc import answers, canon
from tests.peers.linuxcnc.control import Control
from tests.peers.linuxcnc.peer import Peer
from tests.peers.linuxcnc.programs import programs
from tests.peers.linuxcnc.verdict import DIFFER, OURS_REFUSES, judge, kind


def ask(peer: Peer, program: str, control: Control, calls: bool = False) -> answers.Kept:
    """The peer's answer to a program."""
    answer = peer.run(program, control)
    if calls:
        print("\n".join(answer.calls))
    if answer.error:
        print(f"peer: {answer.error}") if calls else None
    moves = [] if answer.error and not calls else canon.moves(answer.calls)
    return answers.Kept(answers.digest(program, control), bool(answer.error), moves)


def count(kept: dict[str, answers.Kept], shown: int, salt: str) -> None:
    """Print how the readers compare over all random programs."""
    found, alone, rest = Counter[tuple[str, str]](), Counter[str](), shown
    for name, program, control in programs(salt):
        verdict = judge(program, control, kept[name])
        found[name.split()[0], verdict.name] += 1
        if verdict.name == OURS_REFUSES:
            alone[kind(verdict.detail)] += 1
        if verdict.name == DIFFER and rest:
            rest -= 1
            print(f"--- {name} {control}\n{program}{verdict.detail}\n")
    for (name, verdict), number in sorted(found.items()):
        print(f"{name:12} {verdict:22} {number:5}")
    print(Counter({v: sum(n for (_, w), n in found.items() if w == v) for v in {w for _, w in found}}))
    for reason, number in alone.most_common():
        print(f"{number:5} {reason}")


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m tests.peers.linuxcnc", description=__doc__)
    parser.add_argument("--peer", type=Path, default=Path(tempfile.gettempdir()) / "linuxcnc-peer",
                        help="folder the peer is fetched to (Debian 12, amd64)")  # fmt: skip
    parser.add_argument("--control", type=json.loads, default={}, help='tables as JSON: {"offsets": {"G55": {"X": 9}}}')
    parser.add_argument("--calls", action="store_true", help="print the peer's canonical calls")
    parser.add_argument("--count", type=int, metavar="N", help="compare the random programs, show N differences")
    parser.add_argument("--ask", action="store_true", help="ask the peer all random programs and keep its answers")
    parser.add_argument("--salt", default="", help="other random programs than those whose answers are kept")
    parser.add_argument("files", type=Path, nargs="*", help="programs to compare")
    given = parser.parse_args()
    tools = {int(number): length for number, length in given.control.pop("tools", {}).items()}
    control = Control(**given.control, tools=tools)
    with tempfile.TemporaryDirectory() as work:
        peer = Peer(given.peer, Path(work)) if given.files or given.ask or given.salt else None
        for file in given.files if peer else []:
            program = file.read_bytes().decode("latin-1")
            verdict = judge(program, control, ask(peer, program, control, given.calls))
            print(f"{file}: {verdict.name} {verdict.detail}")
        if peer and (given.ask or given.salt):
            kept = {name: ask(peer, program, told) for name, program, told in programs(given.salt)}
    if given.ask and not given.salt:
        answers.save(kept)
    if given.count is not None:
        count(kept if given.salt else answers.load(), given.count, given.salt)


if __name__ == "__main__":
    main()
