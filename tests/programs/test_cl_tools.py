"""CUTTER, LOADTL, TOOLNO: one tool a file, and the same cutter within the digits that CAM systems print."""

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


@pytest.mark.parametrize("word", OTHER)
@pytest.mark.parametrize("first", ["CUTTER", "LOADTL", "TOOLNO"])
def test_a_second_tool_is_refused_with_its_line(word, first):
    kind = "CUTTER" if word == "CUTTER" else first if first != "CUTTER" else "LOADTL"
    for before in (FIRST[kind], FIRST[kind] + path()):
        text = before + OTHER[word] + path(3)
        with pytest.raises(InputError, match=rf"line {before.count(chr(10)) + 1}: {word}/.* is another tool than that"):
            parse_cl(text)


@pytest.mark.parametrize("word", OTHER)
def test_a_tool_behind_the_first_move_is_a_change_of_tool(word):
    for before in (MOVE.format(0), path(), "RAPID\n" + path(), "FROM/0,0,0\n" + MOVE.format(0)):
        with pytest.raises(InputError, match=rf"line {before.count(chr(10)) + 1}: {word}/.* changes the tool behind"):
            parse_cl(before + OTHER[word] + path(3))


def test_both_orders_of_number_and_sizes_are_refused_at_the_first_change():
    one, two = BALL + "LOADTL/1\n", "LOADTL/2\n" + MILL
    with pytest.raises(InputError, match="line 5: LOADTL/2 is another tool than that of line 2, LOADTL/1; one tool"):
        parse_cl(one + path() + two + path(5))
    with pytest.raises(InputError, match=r"line 5: CUTTER/6, .* is another tool than that of line 2, CUTTER/16"):
        parse_cl("LOADTL/1\n" + BALL + path() + MILL + "LOADTL/2\n" + path(5))


@pytest.mark.parametrize("same", ["LOADTL/1", "LOADTL/01", "LOADTL/1.0,2,75.0", "TOOLNO/1", "loadtl / 1 , 5"])
def test_the_same_number_in_another_spelling_is_no_change(same):
    assert parse_cl(f"LOADTL/1,1\n{path()}{same}\n{path(3)}").paths


def test_a_tool_without_a_number_is_refused():
    with pytest.raises(InputError, match="line 1: LOADTL names no tool; expected LOADTL/number"):
        parse_cl("LOADTL\n" + path())
    with pytest.raises(InputError, match="line 3: LOADTL/DRILL is another tool than that of line 1, LOADTL/MILL"):
        parse_cl("LOADTL/MILL\nGOTO/0,0,0\nLOADTL/DRILL\nGOTO/1,0,0")


def compared(cutter, head="", ours=OURS):
    return check_cutter(parse_cl(f"{head}{cutter}\n{path()}").cutter, ours, "my.cl")


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
    assert parse_cl(f"CUTTER/3.3078,0.8000,1.0400,0.8000,0,15,25\n{path()}").cutter.sizes[0] == 3.3078
    with pytest.raises(InputError, match="d differ"):
        compared("CUTTER/3.3078,0.8000,1.0400,0.8000,0,15,25")
