#!/bin/sh
# nc-gcode-interpreter 0.1.9, which says that it interprets Sinumerik programs: other positions than a Sinumerik's.
#
# 1. Expressions are worked out from left to right: 2+3*4 is 20.
# 2. TRANS without an axis is skipped, and a second TRANS keeps the axes of the first; SUPA and G53 are listed, and the
#    offset stays in.
# 3. X=IC(1) under TRANS X10 adds the offset again at every step.
#
# Expected, from Siemens' programming manuals: * before +; TRANS deletes the earlier offset and, without values, clears
# it; SUPA and G53 suppress it; IC is a step from the position reached. Exits 0 while this is so. Version 0.1.9 is the
# newest that pip installs on Python 3.11; there are later ones for other versions of Python.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q nc-gcode-interpreter==0.1.9 polars==1.36.1 >/dev/null 2>&1 ||
    { echo "the packages cannot be fetched (they are for Python 3.11)"; exit 2; }
venv/bin/python - <<'END'
import sys
from importlib.metadata import version

from nc_gcode_interpreter import nc_to_dataframe

print("nc-gcode-interpreter", version("nc-gcode-interpreter"))
changed = False
for what, program, expected, before in (
    ("1. * before +", "G1 X=2+3*4\n", 14, 20),
    ("1. the same with brackets", "G1 X=2+(3*4)\n", 14, 14),
    ("1. - from the left", "G1 X=10-2*3+1\n", 5, 25),
    ("2. TRANS clears", "TRANS X10\nG1 X1\nTRANS\nG1 X2\n", 2, 12),
    ("2. TRANS X0 clears X", "TRANS X10\nG1 X1\nTRANS X0\nG1 X2\n", 2, 2),
    ("2. TRANS Y5 ends TRANS X10", "TRANS X10\nTRANS Y5\nG1 X2 Y2\n", 2, 12),
    ("2. SUPA suppresses TRANS", "TRANS X10\nSUPA G0 X1\n", 1, 11),
    ("3. two steps of 1 from 0 + 10", "TRANS X10\nG1 X0\nX=IC(1)\nX=IC(1)\n", 12, 32),
    ("3. two steps without TRANS", "G1 X0\nX=IC(1)\nX=IC(1)\n", 2, 2),
):
    seen = nc_to_dataframe(program)[0]["X"].to_list()[-1]
    print(f"{what}: X expected {expected}, seen {seen}")
    changed |= seen != before
print("CHANGED" if changed else "as before")
sys.exit(changed)
END
