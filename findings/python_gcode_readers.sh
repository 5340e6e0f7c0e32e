#!/bin/sh
# gcodeparser 0.3 and pygcode 0.2.1: words of valid blocks are lost or changed without an error.
#
# 1. gcodeparser reads G43.4 H1, tool centre control, as G43 without H, and G38.2 Z-5 as G38 without Z; what stands in
#    front of the first G, M or T of a block, or behind a comment in brackets, is gone, and so are whole blocks that
#    rely on the G1 before them. (X1. with nothing behind the point is refused.)
# 2. pygcode's Machine counts inches and millimetres alike: G20 G0 X1 and then G21 G0 Y1 ends at X1 Y1.
#
# Expected: every word, or an error; X25.4 Y1 (docs: gcodeparser parses a gcode file into python objects; pygcode's
# machine keeps the position). Exits 0 while this is so.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q gcodeparser==0.3.0 pygcode==0.2.1 >/dev/null 2>&1 ||
    { echo "the packages cannot be fetched"; exit 2; }
venv/bin/python -W ignore - <<'END'
import sys
from importlib.metadata import version

from gcodeparser import parse_gcode_lines
from pygcode import Line, Machine

print(", ".join(f"{name} {version(name)}" for name in ("gcodeparser", "pygcode")))
changed = False


def look(what, expected, seen, before):
    global changed
    print(f"{what}: expected {expected}, seen {seen}")
    changed |= seen != before


def words(program):
    """The words that gcodeparser has of a program, a blank between them."""
    return " ".join(
        f"{line.command[0]}{line.command[1]}" + "".join(f" {letter}{value}" for letter, value in line.params.items())
        for line in parse_gcode_lines(program)
    )


for program, before in (
    ("G43.4 H1", "G43"),
    ("G59.1", "G59"),
    ("G38.2 Z-5 F10", "G38"),
    ("S1000 M3", "M3"),
    ("F100 G1 X2", "G1 X2"),
    ("G1 X1 (contact) Y3", "G1 X1"),
    ("G1 X1 Y2\nY3", "G1 X1 Y2"),
):
    look(f"1. {program!r}", "all its words", words(program), before)
machine = Machine()
for block in ("G20 G0 X1", "G21 G0 Y1"):
    machine.process_block(Line(block).block)
look("2. G20 G0 X1, G21 G0 Y1 in mm", "X25.4 Y1", f"X{machine.pos.X:g} Y{machine.pos.Y:g}", "X1 Y1")
print("CHANGED" if changed else "as before")
sys.exit(changed)
END
