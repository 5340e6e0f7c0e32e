"""FEDRAT and SPINDL in the spellings of CAM systems: feeds in mm/min, exact."""

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.programs.cldata import parse_cl

PATH = "GOTO/0,0,0\nGOTO/10,0,0\n"


def feed(head, path=PATH):
    return parse_cl(head + "\n" + path).feed


@pytest.mark.parametrize(
    ("spelling", "mm_min"),
    [
        ("FEDRAT/23.6,IPM", 599.44),
        ("FEDRAT/IPM,23.6", 599.44),
        ("FEDRAT / 1193.66,  IPM", 30318.964),
        ("fedrat/ 23.6 ipm", 599.44),
        ("FEDRAT/ MMPM,1101.5", 1101.5),
        ("FEDRAT/411.48,MMPM", 411.48),
        ("FEDRAT/MMPM 250.0000", 250.0),
        ("FEDRAT 300", 300.0),
        ("FEDRAT/900,PERMIN", 900.0),
        ("UNITS/INCHES\nFEDRAT/23.6", 599.44),
        ("UNITS/INCHES\nFEDRAT/23.6,PERMIN", 599.44),
        ("UNITS/INCHES\nFEDRAT/600,MMPM", 600.0),
        ("UNITS/MM\nFEDRAT/.1,IPM", 2.54),
        ("SPINDL/2245,RPM,CLW\nFEDRAT/ 0.1,MMPR", 224.5),
        ("SPINDL / RPM, 7957.75,  CLW\nFEDRAT/MMPR,0.1", 795.775),
        ("SPINDL/RPM,3600,CLW\nFEDRAT/0.01,IPR", 914.4),
        ("FEDRAT/0.01,IPR\nspindl/3600", 914.4),
        ("SPINDL/3000,CCLW\nUNITS/INCHES\nFEDRAT/0.001,PERREV", 76.2),
        ("SPINDL/3000,CLW\nSPINDL/OFF\nSPINDL/ON\nFEDRAT/0.1,MMPR", 300.0),
        ("SPINDL/RPM,3000,CLW,MAXRPM,9000\nFEDRAT/0.1,MMPR", 300.0),
    ],
)
def test_a_feed_in_any_unit_is_exact(spelling, mm_min):
    assert feed(spelling) == mm_min


def test_inverse_time_counts_moves_a_minute_and_says_so():
    program = parse_cl("FEDRAT/2,INVERS\nGOTO/0,0,0\nGOTO/10,0,0\nGOTO/10,0,4\n")
    assert program.feed == 8.0
    assert any("INVERS: read as inverse time, moves a minute (line 1)" in note for note in program.notes)


def test_the_slowest_feed_of_a_cutting_move_counts():
    assert feed("FEDRAT/300\nGOTO/0,0,0\nFEDRAT/200\nGOTO/1,0,0\nFEDRAT/250", "GOTO/2,0,0") == 200.0
    assert feed("SPINDL/3000\nFEDRAT/0.1,MMPR\nGOTO/0,0,0\nGOTO/1,0,0\nSPINDL/1000", "GOTO/2,0,0") == 100.0
    assert feed("FEDRAT/300\nGOTO/0,0,0\nFEDRAT/1\nRAPID\nGOTO/9,0,0\nFEDRAT/250", "GOTO/2,0,0") == 250.0


def test_a_feed_in_another_unit_after_a_bare_one_and_the_same_bare_again():
    assert feed("FEDRAT/300,MMPM\nGOTO/0,0,0\nGOTO/1,0,0\nFEDRAT/200", "GOTO/2,0,0") == 200.0


@pytest.mark.parametrize(
    ("head", "message"),
    [
        ("FEDRAT/0.1,MMPR", "line 3: MMPR is a feed per revolution, and no SPINDL states a spindle speed"),
        (
            "SPINDL/3000\nSPINDL/OFF\nFEDRAT/0.1,IPR",
            "line 5: IPR is a feed .*, and line 2 stops",
        ),
        ("SPINDL/150,SFM\nFEDRAT/0.1,IPR", r"SPINDL of line 1 states no speed \(SFM\)"),
        ("SPINDL/0\nFEDRAT/0.1,IPR", "states no one positive speed"),
        ("FEDRAT/10,IPMM", "line 1: FEDRAT: 'IPMM' is neither a number nor a unit"),
        ("FEDRAT/10IPM", "'10IPM' is neither a number nor a unit"),
        ("FEDRAT/IPM", "line 1: FEDRAT/IPM: 0 numbers and 1 units"),
        ("FEDRAT/10,20", "2 numbers and 0 units"),
        ("FEDRAT/10,IPM,MMPM", "1 numbers and 2 units"),
        ("FEDRAT/10,,IPM", "neither a number|1 numbers"),
        ("FEDRAT/", "neither a number|0 numbers"),
        ("FEDRAT/0,MMPM", "line 1: FEDRAT/0,MMPM: a feed must be positive"),
        ("FEDRAT/-3", "line 1: FEDRAT/-3: a feed must be positive"),
        ("FEDRAT/nan", "'NAN' is neither a number nor a unit"),
        ("FEDRAT/10,IPM\nFEDRAT/600", "line 2: FEDRAT/600 states no unit, and line 1 states IPM"),
        ("FEDRAT/2,INVERS\nFEDRAT/600", "line 2: FEDRAT/600 states no unit, and line 1 states INVERS"),
    ],
)
def test_feeds_that_cannot_be_known_are_refused_with_their_line(head, message):
    with pytest.raises(InputError, match=message):
        feed(head)


def test_a_rapid_move_needs_no_spindle_speed():
    assert feed("FEDRAT/0.1,MMPR\nGOTO/0,0,0\nRAPID\nGOTO/1,0,0\nFEDRAT/30,MMPM", "GOTO/2,0,0") == 30.0


def test_moves_before_the_first_feed_are_told():
    program = parse_cl("UNITS/MM\nGOTO/0,0,0\nGOTO/1,0,0\nFEDRAT/30\nGOTO/2,0,0\n")
    assert program.notes == ("cutting moves before the first FEDRAT state no feed (line 3)",)


def test_moves_take_the_time_that_their_feeds_say():
    head = "FROM/0,0,50\nRAPID\nGOTO/0,0,10\nFEDRAT/300,MMPM\n"
    text = head + "GOTO/0,0,0\nGOTO/30,0,0\nFEDRAT/120,INVERS\nGOTO/30,0,0,0.6,0,0.8\n"
    rapid, cut = parse_cl(text).paths
    assert np.isnan(rapid.seconds).all()
    assert np.isnan(cut.seconds[0])
    assert cut.seconds[1:] == pytest.approx([2.0, 6.0, 0.5])
