"""The vector road gives what the interpreter gives line by line, to the last bit; numbers are Python's."""

import dataclasses
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from gearsim.machines.catalogue import table_table_bc
from gearsim.programs.gcode import ProgramError, ReadSettings, read_program
from gearsim.programs.gcode import reader as roads
from gearsim.programs.gcode.scan import Scanner

MACHINE = table_table_bc()
COLUMNS = (
    "start",
    "values",
    "rapid",
    "tip_control",
    "seconds",
    "line",
    "tool",
    "operation",
    "sweep",
    "centre",
    "normal",
)
OFFSETS = ReadSettings(offsets={"G55": {"X": 0.1, "C": 0.2}}, tool_lengths={1: 77.7, 2: 33.3}, arc_tolerance=1e9)


def outcome(program, short, **options):
    """What reading gives, with runs longer than ``short`` in vector form: columns and names, or the error's text."""
    with patch.object(roads, "SHORT", short), patch.object(roads, "_FIRST_WIDTH", 16):
        try:
            found = read_program(program, MACHINE, **options)
        except ProgramError as error:
            return str(error)
    columns = [getattr(found.blocks, name).copy() for name in COLUMNS]
    return columns, dataclasses.replace(found, blocks=None)


def both_roads_agree(program, **options):
    slow, fast = outcome(program, 10**9, **options), outcome(program, 1, **options)
    assert type(slow) is type(fast), (slow, fast)
    if isinstance(slow, str):
        assert slow == fast
        return
    for name, a, b in zip(COLUMNS, slow[0], fast[0], strict=True):
        assert_array_equal(a, b, err_msg=name)
    assert slow[1] == fast[1]


numbers = st.decimals(-200, 200, places=4).map(str) | st.integers(-50, 50).map(str) | st.just(".5")
feeds = st.integers(0, 40).map(lambda i: f"{i / 4}")
words = st.one_of(
    st.tuples(st.sampled_from("XYZBCIJKR"), numbers).map("".join),
    st.tuples(st.just("F"), feeds).map("".join),
    st.sampled_from(["G0", "G1", "G01", "G2", "G03", "G90", "G91", "G93", "G94"]),
)
good = st.tuples(
    st.sampled_from(["", "G0", "G1", "G1", "G00", "G90", "G91 "]),
    st.lists(st.tuples(st.sampled_from("XYZBC"), numbers).map("".join), max_size=4, unique_by=lambda w: w[0]),
    st.sampled_from(["F1.", "F2.5", "F100", " F3;"]),
).map(lambda parts: " ".join([parts[0], *parts[1], parts[2]]))
arc = st.tuples(st.sampled_from(["G2", "G3"]), numbers, numbers, st.sampled_from(["I1 J.5", "J-2", "I-3.25"])).map(
    lambda a: f"{a[0]} X{a[1]} Y{a[2]} {a[3]} F7"
)
special = st.sampled_from([
    "(COMMENT)", "N10 (OPERATION)", "G55", "G54", "T1 M6", "T2 M6", "G43 H1", "G49", "G43.4 H2", "M8", "G93",
    "G94 F3", "G20", "G21", "G18", "G17", "G91 G28 Z0", "G92 X0", "", "G80", "%", "G4 P10", "G95 S100", "/X1",
    "G53 G0 Z7", "N20", "G52 Y2", "G90.1", "G91.1", "G2 X1 I1 J1 P2", "G1", "G2", "G92.1 X1", "G10 L2 P2 X3",
    "X1 ; Y2", "G50.1 X0", "G5.1 Q1 X0 R5", "G54.1 P3", "T0 M6", "G43", "G43.1 Z3", "G92.2", "G92.3", "G20 F2",
    "F3 G21", "G10 L20 P1 X3",
])  # fmt: skip
lines = st.lists(good | good | good | arc | special | st.lists(words, max_size=5).map(" ".join), max_size=60)


@settings(max_examples=150, deadline=None)
@given(lines, st.sampled_from(["fanuc", "linuxcnc"]), st.sampled_from(["\n", "\r\n"]), st.booleans(), st.booleans())
def test_both_roads_agree_on_programs(program, dialect, end, deletes, cuts):
    chosen = dataclasses.replace(OFFSETS, block_delete=deletes, tools=(1, 2) if cuts else None)
    program = ["T1 M6", "G43 H1", "G0 X1 Y1 Z1", *program] if cuts else program
    both_roads_agree("G0 F9\n" + end.join(program), dialect=dialect, settings=chosen)


@settings(max_examples=100, deadline=None)
@given(st.lists(good | arc, min_size=20, max_size=60), st.integers(0, 2))
def test_both_roads_agree_on_programs_without_errors(program, mode):
    head = ["G0 X0 Y0 Z0 F1", "G93 G1", "G43.4 H1"][: mode + 1]
    both_roads_agree("\n".join(head + [line for line in program if mode < 2 or line[:2] not in ("G2", "G3")]))


def test_both_roads_agree_on_the_plane_of_what_is_no_arc():
    both_roads_agree("G0 F9\nG18\nG2 X.5 Y.5 I-3.25 F7\nG4 P10", settings=OFFSETS)


NUMBER = st.from_regex(r"[+-]?([0-9]{1,9}(\.[0-9]{0,25})?|\.[0-9]{1,25})", fullmatch=True)


@given(st.lists(NUMBER, min_size=1, max_size=40))
def test_numbers_are_pythons_to_the_last_bit(texts):
    scan = Scanner(MACHINE.axes).scan("".join(f"X{text}\n" for text in texts).encode())
    expected = np.array([float(text) for text in texts])
    assert not scan.special.any()
    assert_array_equal(scan.values[0], expected)


NOT_PLAIN = [
    "X1.2.3", "X.", "X-.", "X+-1", "X1-", "X", "1", "X1 2", "X 1", "X1;Y2", "X1 X2", "G0G1", "N1.5", "N-1", "G5", "X1(",
    "M3", "X1\rY2", "X1é", "G0 #1", "X1" + " " * 260, "/X1", "%",
]  # fmt: skip


@pytest.mark.parametrize("line", NOT_PLAIN)
def test_what_is_not_plain_is_left_to_the_interpreter(line):
    scan = Scanner(MACHINE.axes).scan(f"X1\n{line}\nY2\n".encode("latin-1"))
    assert scan.special[1]


def test_one_bad_line_leaves_its_neighbours_plain():
    scan = Scanner(MACHINE.axes).scan(b"G1X1Y-.5F3\n(COMMENT)\ng0 z5. ; \nG1 X1;\r\n\n")
    assert scan.special.tolist() == [False, True, True, False, False]


def test_a_long_program_is_read_in_pieces_and_tells_its_progress():
    told = []
    program = "G93 G1 F2\n" + "".join(f"N{i} X{i / 1000} B{i % 90} F{1 + i % 7}\n" for i in range(100_000)) + "M30"
    found = read_program(program, MACHINE, progress=told.append)
    i = np.arange(100_000)
    assert_array_equal(found.blocks.values[:, 0], i / 1000)
    assert_array_equal(found.blocks.values[:, 3], np.radians(i % 90))
    assert_array_equal(found.blocks.seconds, 60.0 / (1 + i % 7))
    assert_array_equal(found.blocks.line, i + 2)
    assert len(told) > 1
    assert sum(told) == 100_002


def test_modes_that_change_in_every_line_are_read_in_reasonable_time():
    """A run that breaks off at once must not be scanned again and again: counted, not timed."""
    program = "G0 X0\n" + "G91 X1\nG90 X0\n" * 2000
    with patch.object(roads, "PlainRun", wraps=roads.PlainRun) as tried:
        read_program(program, MACHINE)
    assert tried.call_count < 200
