"""Units, tool axis and coordinate system of CL files: converted, told or refused."""

import pytest

from gearsim.errors import InputError
from gearsim.programs.cldata import parse_cl


def last(text):
    path = parse_cl(text).paths[-1]
    return path.tips[-1].tolist(), path.axes[-1].tolist()


@pytest.mark.parametrize("word", ["UNITS/INCHES", "UNIT/INCHES", "UNITS / INCH ", "units/ inches", "UNIT/IN"])
def test_inches_are_converted_exactly_and_told(word):
    program = parse_cl(f"{word}\nFROM/0,0,0\nGOTO/0.1,-23.6,3.\nGODLTA/0.1,0,0\n")
    assert program.paths[0].tips[1:].tolist() == [[2.54, -599.44, 76.2], [5.08, -599.44, 76.2]]
    assert len(program.notes) == 1
    assert "(line 1): converted to millimetres, tips lie up to 599.4 mm off" in program.notes[0]


def test_an_axis_is_no_length():
    assert last("UNITS/INCHES\nGOTO/0,0,0,0,0,1\nGOTO/1,0,0,0.6,0,0.8\n") == ([25.4, 0, 0], [0.6, 0, 0.8])


def test_inches_that_look_like_millimetres_are_obeyed_and_doubted():
    program = parse_cl("UNITS/INCHES\nGOTO/0,0,0\nGOTO/250,0,0\n")
    assert program.paths[0].tips[1, 0] == 6350.0
    assert "the numbers look like millimetres, but the file says inches" in program.notes[0]


@pytest.mark.parametrize("word", ["UNITS/MM", "UNIT/MM", "UNITS/ MM ", "UNITS/MILLIMETERS"])
def test_millimetres_are_as_they_stand(word):
    program = parse_cl(f"{word}\nGOTO/0,0,0\nGOTO/0.1,0,0\n{word}\nGOTO/0.2,0,0\n")
    assert (program.paths[0].tips[:, 0].tolist(), program.notes) == ([0.0, 0.1, 0.2], ())


def test_without_a_unit_millimetres_are_assumed_and_told():
    assert parse_cl("GOTO/0,0,0\nGOTO/1,0,0\n").notes == ("no UNITS: lengths are read as millimetres",)


TILTED = "0.6,0,0.8"


@pytest.mark.parametrize(
    ("text", "axis"),
    [
        ("GOTO/0,0,0\nGOTO/1,0,0", [0, 0, 1]),
        (f"MULTAX/ON\nGOTO/0,0,0,{TILTED}\nGOTO/1,0,0", [0.6, 0, 0.8]),
        (f"MULTAX\nGOTO/0,0,0,{TILTED}\nGOTO/1,0,0", [0.6, 0, 0.8]),
        (f"multax / on\nGOTO/0,0,0,{TILTED}\nGODLTA/1,0,0", [0.6, 0, 0.8]),
        (f"MULTAX/ON\nGOTO/0,0,0,{TILTED}\nMULTAX/OFF\nGOTO/1,0,0", [0, 0, 1]),
        (f"MULTAX/ON\nGOTO/0,0,0,{TILTED}\nMULTAX/OFF\nGODLTA/1,0,0", [0, 0, 1]),
        (f"MULTAX/ON\nGOTO/0,0,0,{TILTED}\nMULTAX/OFF\nMULTAX/ON\nGOTO/1,0,0", [0, 0, 1]),
        (f"GOTO/0,0,0,{TILTED}\nMULTAX/OFF\nGOTO/1,0,0,0,0,1", [0, 0, 1]),
        (f"TLAXIS/{TILTED}\nGOTO/0,0,0\nGOTO/1,0,0", [0.6, 0, 0.8]),
        ("MULTAX/OFF\nGOTO/0,0,0\nGOTO/1,0,0,0,0,1", [0, 0, 1]),
        ("GOTO/0,0,0,0,0,1\nGOTO/1,0,0", [0, 0, 1]),
    ],
)
def test_the_axis_of_points_that_state_it_or_not(text, axis):
    assert last(text) == ([1, 0, 0], axis)


IDENTITY = "1.0, 0, -0.0, 0, 0, 1, 0, 0, 0, 0, 1.000, 0"
SHIFTED = IDENTITY.replace("-0.0, 0", "0, 12.5")


@pytest.mark.parametrize("word", ["CSYS/", "$$-> CSYS / "])
def test_a_coordinate_system_other_than_the_parts_is_refused(word):
    path = "GOTO/0,0,0\nGOTO/1,0,0\n"
    assert last(f"{word}{IDENTITY}\n{path}")[0] == [1, 0, 0]
    with pytest.raises(InputError, match=r"line 2: CSYS/.*12\.5.* is not the part's own system"):
        parse_cl(f"UNITS/MM\n{word}{SHIFTED}\n{path}")


def test_a_matrix_in_comments_is_a_coordinate_system():
    rows = "$$*CATIA0\n$$ Program.1\n$$   1.00000 0.00000 0.00000 {}\n$$ 0. 1. 0. 0.\n$$ 0 0 1 0\nPARTNO A\n"
    path = "GOTO/0,0,0\nGOTO/1,0,0\n"
    assert last(rows.format("0.00000") + path)[0] == [1, 0, 0]
    with pytest.raises(InputError, match=r"line 3: CSYS/.*12\.5.* is not the part's own system"):
        parse_cl(rows.format("12.5") + path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("UNITS/FEET", "line 1: UNITS/FEET: expected UNITS/MM or UNITS/INCHES"),
        ("UNITS", "line 1: UNITS/: expected"),
        ("GOTO/0,0,0\nUNITS/INCHES\nGOTO/1,0,0", "line 2: UNITS/INCHES behind numbers: they count as millimetres"),
        ("UNITS/MM\nFEDRAT/9\nUNITS/INCHES", "line 3: UNITS/INCHES behind numbers: line 1 states UNITS/MM"),
        ("MULTAX/MAYBE", "line 1: MULTAX/MAYBE: expected MULTAX/ON or MULTAX/OFF"),
        (f"MULTAX/OFF\nGOTO/0,0,0,{TILTED}", "line 2: tool axis 0.6,0,0.8 under MULTAX/OFF"),
        (f"GOTO/0,0,0,{TILTED}\nGOTO/1,0,0", "line 2: no tool axis, and the last one is 0.6,0,0.8: whether it stays"),
        (f"TLAXIS/{TILTED}\nMULTAX/OFF", "line 2: MULTAX/OFF and a TLAXIS of 0.6,0,0.8"),
        (f"MULTAX/OFF\nTLAXIS/{TILTED}", "line 2: MULTAX/OFF and a TLAXIS of 0.6,0,0.8"),
        (f"TLAXIS/0,0,1\nGOTO/0,0,0,{TILTED}\nGOTO/1,0,0", "line 3: no tool axis, and the last one is 0.6,0,0.8"),
        ("TLAXIS/0,0,2", "line 1: tool axis 0,0,2 has length 2"),
        ("TLAXIS/NORMPS", "line 1: 'NORMPS' is not a number; expected TLAXIS/i,j,k"),
        ("GODLTA/1,0,0", "line 1: GODLTA/1,0,0 before the first point"),
        ("CSYS/1,0,0", "line 1: 3 numbers; expected CSYS of 12 numbers"),
    ],
)
def test_what_is_open_is_refused_with_its_line(text, message):
    with pytest.raises(InputError, match=message):
        parse_cl(text)
