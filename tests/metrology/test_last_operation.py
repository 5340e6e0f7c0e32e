"""Which rows of a program made a surface last, and the heading under which they stand."""

from dataclasses import replace

import numpy as np

from gearsim.cutters.end_mills import flat
from gearsim.machines.catalogue import table_table_bc
from gearsim.metrology.deviation import Crossing, Deviation
from gearsim.metrology.last_operation import last_heading, made_last
from gearsim.programs.gcode import read_program
from gearsim.simulation.operation import Variant, operation
from gearsim.simulation.program import program_operations

TEXT = """%
O1
(ROUGHING)
T1 M06
G90 G94 G54 G21
G43 H1 Z5.
G01 X0. Y0. Z-1. F300
G01 X10.
(FINISHING)
T2 M06
G43 H2 Z5.
G01 X0. Y1. Z-2. F300
G01 X10.
G01 Y2.
G01 X0.
M30
%
"""


def variant(named=True):
    program = read_program(TEXT, table_table_bc())
    cutters = {1: flat(6.0, 20.0), 2: flat(4.0, 20.0)}
    headings = program.operations if named else ()
    found = program_operations(program.blocks, cutters, 1e-9, text=TEXT, headings=headings)
    return Variant("program", "", found)


def cut_by(*segments):
    n = len(segments)
    crossing = np.full(n, Crossing.MEASURED)
    return Deviation(np.zeros(n), crossing, np.array(segments), np.zeros(n, dtype=bool))


def rows_of(whole, *lines):
    """Segments that the lines of the text made, counted through all operations."""
    line = np.concatenate([o.line for o in whole.operations])
    return [int(np.flatnonzero(line == wanted)[0]) for wanted in lines]


def test_the_rows_between_the_first_and_the_last_that_cut_are_asked_again():
    whole = variant()
    last = made_last("last", whole, cut_by(*rows_of(whole, 8, 13, 15), -1))
    (made,) = last.operations
    assert made.name == "T2"
    assert sorted(set(made.line.tolist())) == [13, 14, 15]


def test_where_a_rapid_made_a_sample_the_envelope_road_is_asked_about_rapids_too():
    """Or it knew nothing of a cut that the removal road sees."""
    whole = variant()
    (tool,) = whole.operations[1:]
    rapid = replace(whole, operations=(whole.operations[0], replace(tool, rapid=tool.line == 14)))
    (made,) = made_last("last", rapid, cut_by(*rows_of(whole, 13, 14, 15))).operations
    assert sum(source.pieces for source in made.motions()) == 3
    (kept,) = made_last("last", rapid, cut_by(*rows_of(whole, 13, 15))).operations
    assert sum(source.pieces for source in kept.motions()) == 2


def test_what_earlier_headings_cut_alone_was_not_made_last():
    whole = variant()
    assert made_last("last", whole, cut_by(*rows_of(whole, 8))) is None
    assert made_last("last", whole, cut_by(-1)) is None


def test_the_last_heading_is_named_where_it_is_known():
    whole = variant()
    assert last_heading(whole) == "FINISHING"
    assert last_heading(whole.chosen(lambda i, o: np.full(len(o), i == 0))) == "ROUGHING"
    assert last_heading(variant(named=False)) == ""
    source = whole.operations[0].sources[0]
    assert last_heading(Variant("CL data", "", (operation("CL data", flat(6.0, 20.0), [source], 1e-9),))) == ""
