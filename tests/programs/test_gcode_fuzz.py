"""Whatever the bytes, reading ends, and with its own error or a program."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from gearsim.machines.catalogue import table_table_bc
from gearsim.programs.blocks import Blocks
from gearsim.programs.gcode import ProgramError, ReadSettings, read_program

MACHINE = table_table_bc()
SETTINGS = ReadSettings(block_limit=300)
CHARACTERS = "GXYZBCFIJKRNTMHSPOD#[]<>()/%;=+-*. \t\r\n\n\n\x00\xff"
PIECES = [
    "0", "1", "2", "9", "10", "G1", "G2", "G43.4", "G28", "G92", "M6", "T1", "F100", "H1", "I1", "R2", "X1.5", "B90",
    "sub", "call", "endsub", "while", "endwhile", "if", "endif", "do", "repeat", "endrepeat", "o1", "o2", "#1", "#<a>",
    "SIN[", "EXISTS[", "MOD", "**", "EQ", "G93", "G95", "S5", "e5", "1e999", "99999999999999999999", "inf", "nan",
]  # fmt: skip
FLOW = ["o1 sub", "o1 call", "o1 endsub", "o2 while [1]", "o2 endwhile", "o3 if [#1]", "o3 endif", "o4 do",
        "o4 while [#2]", "o5 repeat [3]", "o5 endrepeat", "#1=[#1+1]", "G0 X#1", "o5 break", "o4 continue",
        "o1 return"]  # fmt: skip


def ends_well(program, dialect):
    """Reading gives a program or the reader's own error, which says where."""
    found = error = None
    try:
        found = read_program(program, MACHINE, dialect=dialect, settings=SETTINGS)
    except ProgramError as caught:
        error = caught
    if error is None:
        assert isinstance(found.blocks, Blocks)
    else:
        assert min(error.line, error.column) >= 1
        assert str(error).startswith(f"{error.source}, line {error.line}, column {error.column}")


@pytest.mark.parametrize("dialect", ["fanuc", "linuxcnc"])
@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.binary(max_size=300))
def test_random_bytes(tmp_path, dialect, data):
    path = tmp_path / "random.nc"
    path.write_bytes(data)
    ends_well(path, dialect)


@pytest.mark.parametrize("dialect", ["fanuc", "linuxcnc"])
@settings(max_examples=400, deadline=None)
@given(st.lists(st.sampled_from([*CHARACTERS, *PIECES]), max_size=60).map("".join))
def test_random_words(dialect, program):
    ends_well(program, dialect)


@settings(max_examples=300, deadline=None)
@given(st.lists(st.sampled_from(FLOW), max_size=25).map("\n".join))
def test_random_flow(program):
    ends_well(program, "linuxcnc")


@settings(max_examples=100, deadline=None)
@given(st.text(max_size=100))
def test_random_text(program):
    ends_well(program, "fanuc")
