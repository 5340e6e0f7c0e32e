"""CL files changed at random: one clear error, or every move that a person sees in the text is in the paths."""

import re

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.programs.cldata import RAPID, parse_cl

SOURCE = """PARTNO PART 1/2 COSTS 5$
$$-> CSYS / 1.0, 0.0, 0.0, 0.0, $
   0.0, 1.0, 0.0, 0.0, $
   0.0, 0.0, 1.0, 0.0
UNITS/MM
LOADTL/1,1
CUTTER/6,0.5,2.5,0.5,0,0,20
MULTAX/ON
SPINDL/RPM,3000,CLW
FROM/0,0,50,0,0,1
RAPID
GOTO/0,0,10,0,0,1
PPRINT PASS convex $$ text
FEDRAT/0.1,MMPR
GOTO/1,2,3,0,0.6,0.8
GOTO/4,5,$ $$ more
6,0.6,0,0.8
COOLNT/ON
REMARK GO$
GODLTA/7,0,0
MULTAX/OFF
rapid,goto / 7,8,9
LOADTL/1
FEDRAT/ 23.6 IPM
GOTO/10,11,12
END
FINI
"""
LINES = SOURCE.splitlines()
PIECES = [
    "$", "$$", "\n", "/", ",", " ", "-", "1", ".", "PPRINT ", "RAPID", "RAPID\n", "GOTO/1,1,1\n", "CUTTER/6\n",
    "LOADTL/2\n", "MULTAX/ON\n", "UNITS/INCHES\n", "REMARK ", "$$ ", "E3", "COOLNT/ON", "\r", "\ufeff", "ß",
    "FINI\n", "CIRCLE/1\n",
]  # fmt: skip

cuts = st.tuples(st.just("cut"), st.integers(0, len(SOURCE) - 1), st.integers(1, 12))
inserts = st.tuples(st.just("insert"), st.integers(0, len(SOURCE)), st.sampled_from(PIECES))
doubles = st.tuples(st.just("double"), st.integers(0, len(LINES) - 1), st.integers(0, len(LINES) - 1))
changes = st.lists(st.one_of(cuts, inserts, doubles), min_size=1, max_size=4)


def changed(text, how):
    kind, at, what = how
    if kind == "cut":
        return text[:at] + text[at + what :]
    if kind == "insert":
        return text[:at] + what + text[at:]
    lines = text.splitlines(keepends=True)
    return "".join([*lines[:at], LINES[what] + "\n", *lines[at:]])


SEEN = re.compile(r"\s*(?P<rapid>RAPID\s*[,\s]\s*)?(?P<word>GOTO|FROM|GODLTA)\s*/(?P<rest>[^$]*)", re.I)
FIRST_THREE = re.compile(r"[\s,]*([-+.\dED]+)[\s,]+([-+.\dED]+)(?:[\s,]+([-+.\dED]+))?", re.I)


def seen(text):
    """The motion words at the beginning of lines, as a person sees them: (word, its three numbers or None)."""
    out = []
    for line in re.split(r"\r\n|\r|\n", text):
        if found := SEEN.match(line.strip("\ufeff")):
            values = FIRST_THREE.match(found["rest"])
            out.append((found["word"].upper(), None if not values or values[3] is None else values.groups()))
    return out


def read(text):
    """The program, or what is said against it."""
    try:
        return parse_cl(text, "my.cl"), "my.cl"
    except InputError as error:
        return None, str(error)


def points(program):
    return {tuple(tip) for path in program.paths for tip in np.round(path.tips, 9).tolist()}


@settings(max_examples=800, deadline=None)
@given(changes)
def test_no_traceback_and_no_move_dropped(how):
    text = SOURCE
    for change in how:
        text = changed(text, change)
    program, said = read(text)
    assert said.startswith("my.cl")
    if program is None or "INCH" in text:
        return
    found = points(program)
    visible = seen(text)
    assert sum(len(p.tips) - 1 for p in program.paths) <= len(visible)
    for word, values in visible:
        if word == "GOTO" and values is not None:
            point = tuple(round(float(v.upper().replace("D", "E")), 9) for v in values)
            assert point in found or any("FROM sets the tool elsewhere" in note for note in program.notes), text


@settings(max_examples=300, deadline=None)
@given(st.integers(0, len(SOURCE)), st.sampled_from(["\n", "$\n", "$", "$$", " ", "\r\n", "$$\n"]))
def test_one_break_anywhere_loses_no_rapid_and_no_point(at, piece):
    text = SOURCE[:at] + piece + SOURCE[at:]
    program, said = read(text)
    if program is None:
        assert said.startswith("my.cl, line")
        return
    right = parse_cl(SOURCE)
    visible = [v for _, v in seen(text)]
    if len(visible) == len(seen(SOURCE)) and "$$" not in piece:
        assert points(program) == points(right)
        rapids = [sum(len(p.tips) - 1 for p in q.paths if p.name == RAPID) for q in (program, right)]
        assert rapids[0] == rapids[1]
