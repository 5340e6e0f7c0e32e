"""Runs one program, or the random ones, through the peer and through gearsim's reader, and says what differs."""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path

from gearsim.programs.gcode import ProgramError
from tests.peers.linuxcnc import canon, reading
from tests.peers.linuxcnc.control import Control
from tests.peers.linuxcnc.moves import differences
from tests.peers.linuxcnc.peer import Peer


def one(peer: Peer, program: str, control: Control, calls: bool) -> None:
    """Say what both make of one program."""
    answer = peer.run(program, control)
    if calls:
        print("\n".join(answer.calls))
    theirs = canon.moves(answer.calls)
    print(f"peer refuses: {answer.error}" if answer.error else f"peer runs {len(theirs)} moves")
    try:
        ours = reading.read(program, control)
    except ProgramError as error:
        print(f"ours refuses: {error}")
        return
    print(differences(theirs, ours) or "no difference" if not answer.error else f"ours runs {len(ours)} moves")


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m tests.peers.linuxcnc", description=__doc__)
    parser.add_argument("--peer", type=Path, default=Path(tempfile.gettempdir()) / "linuxcnc-peer",
                        help="folder the peer is fetched to (Debian, amd64)")  # fmt: skip
    parser.add_argument("--control", type=json.loads, default={}, help='tables as JSON: {"offsets": {"G55": {"X": 9}}}')
    parser.add_argument("--calls", action="store_true", help="print the peer's canonical calls")
    parser.add_argument("files", type=Path, nargs="*", help="programs to compare")
    given = parser.parse_args()
    tools = {int(number): length for number, length in given.control.pop("tools", {}).items()}
    control = Control(**given.control, tools=tools)
    with tempfile.TemporaryDirectory() as work:
        peer = Peer(given.peer, Path(work))
        for file in given.files:
            print(f"{file}:")
            one(peer, file.read_bytes().decode("latin-1"), control, given.calls)


if __name__ == "__main__":
    main()
