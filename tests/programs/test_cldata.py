from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearsim.cutters.catalogue import apt, conical
from gearsim.errors import InputError, read_input
from gearsim.programs.cldata import CLPath, apt_parameters, assemble, format_cl, parse_cl

GOOD = """PARTNO test $$ a comment
UNITS/MM
CUTTER/6,0.5,2.5,0.5,0,0,20
MULTAX/ON
SPINDL/3000,CLW
FROM/0,0,50,0,0,1
RAPID
GOTO/0,0,10,0,0,1
PPRINT PASS convex
FEDRAT/300
GOTO/1,2,3,0,0.6,0.8
GOTO/4,5,$
6,0.6,0,0.8
GOTO/7,8,9
FINI
"""


def unit(rows):
    rows = np.asarray(rows, dtype=float)
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def test_reads_moves_modes_names_and_cutter():
    program = parse_cl(GOOD)
    assert [p.name for p in program.paths] == ["rapid", "convex"]
    cut = program.path("convex")
    assert np.allclose(cut.tips, [[0, 0, 10], [1, 2, 3], [4, 5, 6], [7, 8, 9]])
    assert np.allclose(cut.axes, [[0, 0, 1], [0, 0.6, 0.8], [0.6, 0, 0.8], [0.6, 0, 0.8]])
    assert apt_parameters(program.tools[0].sizes) == pytest.approx((6, 0.5, 2.5, 0.5, 0, 0, 20))


def test_a_new_start_point_begins_a_new_path():
    program = parse_cl("GOTO/0,0,0\nGOTO/1,0,0\nFROM/5,0,0\nGOTO/6,0,0\nGOTO/7,0,0")
    assert [p.tips[:, 0].tolist() for p in program.paths] == [[0, 1], [5, 6, 7]]


@pytest.mark.parametrize("cutter", [conical(1.04, 0.8, 0.26, 25.0), apt(6.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0)])
def test_what_is_written_is_read_back(cutter, rng):
    passes = [CLPath(n, rng.normal(size=(7, 3)), unit(rng.normal(size=(7, 3)))) for n in ("convex", "concave")]
    program = assemble(passes, 15.0, cutter)
    again = parse_cl(format_cl(program, "part", 600.0, 12))
    assert [p.name for p in again.paths] == ["rapid", "convex", "rapid", "concave", "rapid"]
    for name in ("convex", "concave"):
        assert np.allclose(again.path(name).tips, program.path(name).tips, atol=1e-11)
        assert np.allclose(again.path(name).axes, program.path(name).axes, atol=1e-11)
    assert np.allclose(again.tools[0].sizes.sizes, apt_parameters(cutter), atol=1e-7)
    assert np.allclose(again.paths[0].tips[0], passes[0].tips[0] + 15.0 * passes[0].axes[0], atol=1e-11)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("GOTO/0,0,0\nGOTO/1,nan,0", "line 2: nan is not a finite number"),
        ("GOTO/0,0,0\nGOTO/1,inf,0", "line 2: inf is not a finite number"),
        ("GOTO/0,0,0\nGOTO/1,x,0", "line 2: 'x' is not a number"),
        ("GOTO/0,0", "line 1: 2 numbers; expected GOTO/x,y,z"),
        ("GOTO/0,0,0,0,0,2", "line 1: tool axis 0,0,2 has length 2"),
        ("GOTO/0,0,0,0,0,0", "line 1: tool axis 0,0,0 has length 0"),
        ("UNITS/CUBITS\nGOTO/0,0,0", "line 1: UNITS/CUBITS: expected UNITS/MM or UNITS/INCHES"),
        ("CUTTER/6,1,3", "line 1: 3 numbers; expected CUTTER"),
        ("CUTTER/6,1,1.5,1,0,0,20", "line 1: impossible APT cutter"),
        ("FEDRAT/-3", "line 1: FEDRAT/-3: a feed must be positive"),
        ("PPRINT PASS rapid", "line 1: a pass cannot be called 'rapid'"),
        ("CYCLE/DRILL", "line 1: word 'CYCLE' is not supported"),
        ("GOTO/0,0,0", "no cutting moves"),
        ("RAPID\nGOTO/0,0,0\nRAPID\nGOTO/1,0,0", "no cutting moves"),
        ("", "no cutting moves"),
        ("GOTO/0,0,$", "line 1: the file ends in a line to be continued"),
    ],
)
def test_mistakes_are_named_with_their_line(text, message):
    with pytest.raises(InputError, match=message):
        parse_cl(text, "part.cl")


def test_an_unreadable_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"cannot read CL file .*missing\.cl"):
        read_input(tmp_path / "missing.cl", "CL file")
    (tmp_path / "binary.cl").write_bytes(b"\xff\xfe\x00GOTO")
    with pytest.raises(InputError, match=r"binary\.cl"):
        read_input(tmp_path / "binary.cl", "CL file")


words = st.sampled_from(
    ["GOTO/", "FROM/", "RAPID", "CUTTER/", "FEDRAT/", "UNITS/MM", "$", "\n", ",", "1", "-0.5", "nan"]
)


@settings(max_examples=300)
@given(st.lists(st.one_of(words, st.text(max_size=4)), max_size=30).map("".join))
def test_nothing_but_its_own_error_under_random_text(text):
    with suppress(InputError):
        parse_cl(text)


def test_repeated_points_are_dropped():
    path = parse_cl("GOTO/0,0,0\nGOTO/1,0,0\nGOTO/1,0,0\nGOTO/2,0,0").paths[0]
    assert np.allclose(path.tips[:, 0], [0, 1, 2])
