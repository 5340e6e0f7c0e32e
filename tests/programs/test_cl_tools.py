"""CUTTER, LOADTL, TOOLNO: which tool makes a move, and the same cutter within the digits that CAM systems print."""

from itertools import permutations

import pytest

from gearsim.cutters.catalogue import apt, ball, conical
from gearsim.errors import InputError
from gearsim.programs.cldata import check_cutter, parse_cl

MOVE = "GOTO/{},0,0\n"
BALL, MILL = "CUTTER/16.0,8.0,0,8.0,0,0,60\n", "CUTTER/6,0.5,2.5,0.5,0,0,20\n"
OURS = conical(1.04, 0.8, 0.2617993877991494, 25.0)  # CUTTER/3.30772318,0.8,1.04,0.8,0,15,25


def path(first=0):
    return MOVE.format(first) + MOVE.format(first + 1)


FIRST = {"CUTTER": BALL, "LOADTL": "LOADTL/1\n", "TOOLNO": "TOOLNO/1,MILL\n", "LOAD": "LOAD/TOOL,1\n"}
OTHER = {"CUTTER": MILL, "LOADTL": "LOADTL/2\n", "TOOLNO": "TOOLNO/2\n", "LOAD": "LOAD/TOOL,2\n",
         "SELECT": "SELECT/TOOL,2\n"}  # fmt: skip


@pytest.mark.parametrize("order", list(permutations(FIRST, 3)))
def test_one_tool_in_any_order_before_the_moves_and_stated_again(order):
    head = "".join(FIRST[word] for word in order)
    program = parse_cl("UNITS/MM\nFROM/9,9,9\n" + head + path() + head + path(5))
    assert len(program.paths[0].tips) == 5


def tools(text):
    """Of every path the tool's number and its sizes, as far as they are stated, to the diameter."""
    program = parse_cl(text)
    named = [program.tools[p.tool] for p in program.paths]
    return [(tool.number, tool.sizes and tool.sizes.sizes[0]) for tool in named]


@pytest.mark.parametrize("second", [("LOADTL/2\n", MILL), (MILL, "LOADTL/2\n"), ("TOOLNO/2\nFROM/2,0,0\n", MILL)])
@pytest.mark.parametrize(
    "first", [("LOADTL/1\n", BALL), (BALL, "LOADTL/1\n"), ("FROM/9,9,9\n" + BALL, "LOAD/TOOL,1\n")]
)
def test_number_and_sizes_change_together_in_any_order(first, second):
    text = "".join(first) + path() + "".join(second) + path(3) + "LOADTL/1\n" + path(6)
    assert tools(text) == [("1", 16.0), ("2", 6.0), ("1", 16.0)]
    program = parse_cl(text)
    assert [p.tool for p in program.paths] == [0, 1, 0]
    assert program.tools[1].line in (5, 6)


@pytest.mark.parametrize("word", ["LOADTL/2\n", "TOOLNO/2\n", "LOAD/TOOL,2\n"])
def test_a_number_alone_changes_the_tool_and_takes_no_sizes_with_it(word):
    assert tools("LOADTL/1\n" + path() + word + path(3)) == [("1", None), ("2", None)]
    assert tools("LOADTL/1\n" + BALL + path() + word + path(3)) == [("1", 16.0), ("2", None)]
    assert tools(BALL + path() + word + path(3)) == [("", 16.0), ("2", None)]


def test_sizes_alone_change_the_tool_and_the_number_is_not_known():
    assert tools("LOADTL/1\n" + BALL + path() + MILL + path(3)) == [("1", 16.0), ("", 6.0)]
    assert tools(BALL + path() + MILL + path(3) + BALL + path(6)) == [("", 16.0), ("", 6.0), ("", 16.0)]


def test_a_sister_tool_of_the_same_sizes_is_another_tool():
    assert tools("LOADTL/1\n" + BALL + path() + BALL + "LOADTL/2\n" + path(3)) == [("1", 16.0), ("2", 16.0)]


def test_what_is_loaded_and_does_not_move_is_not_used():
    text = BALL + "LOADTL/1\nLOADTL/2\n" + MILL + "LOADTL/10\n" + path()
    assert tools(text) == [("10", None)]
    assert len(parse_cl(text).tools) == 1


def test_a_number_with_other_sizes_than_before_is_refused_with_its_line():
    text = "LOADTL/1\n" + BALL + path() + "LOADTL/2\n" + path(3) + "LOADTL/1\n" + MILL + path(6)
    with pytest.raises(
        InputError, match=r"line 10: tool 1 is CUTTER/6, .*\(line 9\) here and was CUTTER/16, .* \(line 2\)"
    ):
        parse_cl(text)


@pytest.mark.parametrize("word", OTHER)
def test_a_tool_behind_moves_that_no_tool_is_named_for_is_refused_with_its_line(word):
    for before in (MOVE.format(0), path(), "RAPID\n" + path(), "FROM/0,0,0\n" + MOVE.format(0)):
        line = before.count(chr(10)) + 1
        with pytest.raises(InputError, match=rf"line {line}: {word}/.*(changes the tool behind|is not settled)"):
            parse_cl(before + OTHER[word] + path(3))


def test_a_selected_tool_is_the_one_in_the_spindle_or_refused():
    assert tools("SELECT/TOOL,1\nLOAD/TOOL,1\n" + path()) == [("1", None)]
    with pytest.raises(InputError, match=r"line 4: SELECT/TOOL,2: whether it loads the tool or makes it ready"):
        parse_cl("LOADTL/1\n" + path() + "SELECT/TOOL,2\n" + path(3))


@pytest.mark.parametrize("same", ["LOADTL/1", "LOADTL/01", "LOADTL/1.0,2,75.0", "TOOLNO/1", "loadtl / 1 , 5"])
def test_the_same_number_in_another_spelling_is_no_change(same):
    assert parse_cl(f"LOADTL/1,1\n{path()}{same}\n{path(3)}").paths


def test_a_tool_without_a_number_is_refused_and_a_name_is_a_number():
    with pytest.raises(InputError, match="line 1: LOADTL names no tool; expected LOADTL/number"):
        parse_cl("LOADTL\n" + path())
    assert tools("LOADTL/MILL\nFROM/0,0,0\nGOTO/1,0,0\nLOADTL/DRILL\nGOTO/2,0,0") == [("MILL", None), ("DRILL", None)]


def compared(cutter, head="", ours=OURS):
    return check_cutter(parse_cl(f"{head}{cutter}\n{path()}").tools[0].sizes, ours, "my.cl")


@pytest.mark.parametrize(
    "cutter",
    [
        "CUTTER/3.30772318,0.8,1.04,0.8,0,15,25",
        "CUTTER/3.3077,0.8000,1.0400,0.8000,0.0000,15.0000,25.0000",
        "CUTTER/3.30772,0.8,1.04,.8,0,15.,25",
        "CUTTER/3.308,0.800,1.040,0.800,0.000,15.000,25.000",
        "CUTTER/3.31,0.80,1.04,0.80,0.00,15.00,25.00",
        "CUTTER/ 3.3077 , 0.8 , 1.04 , 0.8 , 0 , 15 , 25 ,",
        "CUTTER/3.3077,0.8,1.04,0.8,0,15,$\n25",
    ],
)
def test_the_same_cutter_within_the_printed_digits(cutter):
    assert compared(cutter) == ()


def test_in_inches_the_digits_are_inches():
    cutter = "CUTTER/0.1302,0.0315,0.0409,0.0315,0,15,0.9843"
    assert compared(cutter, "UNITS/INCHES\n") == ()
    with pytest.raises(InputError, match="d differ"):
        compared(cutter.replace("0.1302", "0.1303"), "UNITS/INCHES\n")


@pytest.mark.parametrize(
    ("cutter", "letters"),
    [
        ("CUTTER/3.3079,0.8000,1.0400,0.8000,0.0000,15.0000,25.0000", "d"),
        ("CUTTER/3.3077,0.8000,1.0400,0.8000,0.0000,15.0002,25.0000", "b"),
        ("CUTTER/3.33,0.8,1.04,0.8,0,15,25", "d"),
        ("CUTTER/3.1543,0.7,1.04,0.7,0,15,25", "d, r, f"),
        ("CUTTER/3", "d"),
        ("CUTTER/3.31,0.5", "r"),
    ],
)
def test_another_cutter_is_refused_with_what_differs(cutter, letters):
    with pytest.raises(InputError, match=rf"my\.cl is for CUTTER/.*; the scene's \[cutter\] is .*: {letters} differ"):
        compared(cutter)


@pytest.mark.parametrize(("height", "told"), [(60, "60"), (24, "24"), (25.1, "25.1")])
def test_another_shank_is_no_other_cutter_and_told(height, told):
    (note,) = compared(f"CUTTER/3.3077,0.8,1.04,0.8,0,15,{height}")
    assert f"{told} has its height, the scene's [cutter] 25 mm; the scene's is cut" in note
    assert parse_cl(f"CUTTER/3.3077,0.8,1.04,0.8,0,15,25\n{path()}CUTTER/3.3077,0.8,1.04,0.8,0,15,60\n{path(4)}").paths


@pytest.mark.parametrize("cutter", ["CUTTER/16", "CUTTER/16.000", "CUTTER/16.,8", "$$-> CUTTER / 16.0000"])
def test_a_cutter_of_one_or_two_numbers_is_compared_as_far_as_it_goes(cutter):
    (note,) = compared(cutter, ours=ball(16.0, 60.0))
    assert "states no more of the tool" in note
    with pytest.raises(InputError, match=r"is for CUTTER/16.*: d(, r)? differ"):
        compared(cutter, ours=ball(15.6, 60.0))


def test_a_sharp_corner_has_no_place():
    assert compared("CUTTER/6,0,0,0,0,0,20", ours=apt(6.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0)) == ()
    assert compared("CUTTER/6,0,3,0,0,0,20", ours=apt(6.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0)) == ()


@pytest.mark.parametrize(
    ("cutter", "message"),
    [
        ("CUTTER/6,1,2,1,20", "line 1: 5 numbers, of which the fifth has no settled meaning"),
        ("CUTTER/OPTION", "line 1: 'OPTION' is not a number; expected CUTTER/d, CUTTER/d,r or CUTTER/d,r,e,f,a,b,h"),
        ("CUTTER/", "line 1: nothing stands where a number should"),
        ("CUTTER/6,1,1.5,1,0,0,20", "line 1: impossible APT cutter"),
        ("CUTTER/0", "line 1: impossible CUTTER/0"),
        ("CUTTER/-6,1", "line 1: impossible"),
        ("CUTTER/6,1,2,1,0,0,nan", "line 1: nan is not a finite number"),
    ],
)
def test_what_states_no_tool_is_refused(cutter, message):
    with pytest.raises(InputError, match=message):
        parse_cl(f"{cutter}\n{path()}")


def test_digits_rounded_the_wrong_way_make_no_cutter_impossible():
    assert parse_cl(f"CUTTER/3.3078,0.8000,1.0400,0.8000,0,15,25\n{path()}").tools[0].sizes.sizes[0] == 3.3078
    with pytest.raises(InputError, match="d differ"):
        compared("CUTTER/3.3078,0.8000,1.0400,0.8000,0,15,25")
