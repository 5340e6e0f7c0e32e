"""The LinuxCNC dialect: parameters, expressions, O words, and where it differs from Fanuc."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from gearsim.machines.catalogue import table_table_bc
from gearsim.programs.gcode import ProgramError, ReadSettings, read_program

MACHINE = table_table_bc()


def read(program, **settings):
    return read_program(program, MACHINE, dialect="linuxcnc", settings=ReadSettings(**settings))


def x(program, **settings):
    return read(program, **settings).blocks.values[:, 0].tolist()


def refused(program, match, **settings):
    with pytest.raises(ProgramError, match=match):
        read(program, **settings)


EXPRESSIONS = [
    ("1+2*3", 7.0), ("[1+2]*3", 9.0), ("2**3**2", 64.0), ("10-4-3", 3.0), ("7 MOD 4", 3.0), ("-7 MOD 4", 1.0),
    ("8/4/2", 1.0), ("SIN[30]", 0.5), ("COS[60]", 0.5), ("TAN[45]", 1.0), ("ATAN[1]/[-1]", 135.0), ("ASIN[1]", 90.0),
    ("ACOS[0]", 90.0), ("SQRT[16]", 4.0), ("ABS[-3]", 3.0), ("FIX[-2.5]", -3.0), ("FUP[2.1]", 3.0), ("ROUND[2.5]", 3.0),
    ("LN[EXP[2]]", 2.0), ("3 GT 2", 1.0), ("3 LE 2", 0.0), ("1 EQ 1 AND 2 NE 2", 0.0), ("1 XOR 0 OR 0", 1.0),
    ("#5", 0.0), ("EXISTS[#<none>]", 0.0), ("EXISTS[#5]", 1.0), ("-[2+1]", -3.0), ("1 + -2", -1.0), ("2--1", 3.0),
]  # fmt: skip


@pytest.mark.parametrize(("text", "value"), EXPRESSIONS)
def test_expressions_have_their_value(text, value):
    assert_allclose(x(f"G0 X[{text}]"), [value], atol=1e-12)


def pairs(inner):
    return st.tuples(inner, st.sampled_from("+-*"), inner).map(lambda parts: f"[{''.join(parts)}]")


@given(st.recursive(st.integers(0, 99).map(str), pairs, max_leaves=12))
def test_bracketed_arithmetic_is_pythons(text):
    expected = eval(text.replace("[", "(").replace("]", ")"))
    assert abs(expected) > 1e9 or x(f"G0 X{text}") == [expected]


def test_parameters_are_set_at_the_end_of_their_line():
    program = "#1=2\nG0 X#1 #1=5\nX#1\n#<my Name> = [#1*2] (comment)\nX#<myname>\n#[1+1]=8\nX#2\n"
    assert x(program) == [2, 5, 10, 8]
    assert x("#3=4 #4=17\nG0 X##3 Y-#4") == [17]


def test_subroutines_have_parameters_of_their_own():
    program = """#1=100 #<kept>=1 #<_all>=2
    o<step> sub
      #<kept>=50
      G0 X[#1+#2+#<_all>]
    o<step> endsub [#1*2]
    o100 sub
      o<step> call [1] [10]
      o100 return
      G0 X999
    o100 endsub
    o100 call
    G0 X#1
    X#<kept>
    X[10+#<_value>]
    o<step> call [3]
    X#<_value>
    M2"""
    assert x(program) == [13, 100, 1, 10, 5, 6]


def test_loops_and_branches():
    program = """#1=0
    o1 while [#1 LT 6]
      #1=[#1+1]
      o2 if [#1 EQ 2]
        o1 continue
      o2 elseif [#1 EQ 5]
        o1 break
      o2 else
        G0 X#1
      o2 endif
    o1 endwhile
    o3 do
      o4 repeat [3]
        #1=[#1+10]
        o5 if [#1 GT 30]
          o3 break
        o5 endif
        G0 X#1
      o4 endrepeat
    o3 while [1]
    o6 do
      #1=[#1-20]
      G0 X#1
    o6 while [#1 GT 0]
    o7 repeat [0]
      G0 X999
    o7 endrepeat
    """
    assert x(program) == [1, 3, 4, 15, 25, 15, -5]


def test_errors_name_line_column_and_word():
    refused("G0 X[1+", r"line 1, column 8: expected a number")
    refused("G0 X[1", r"line 1, column 5, \[1: the expression is not finished")
    refused("G0 X[1/0]", r"line 1, column 7, /: this has no value")
    refused("G0 X[SQRT[-1]]", r"line 1, column 6, SQRT\[-1\]: this has no value")
    refused("G0 X[FOO[1]]", r"line 1, column 6, FOO: no function of that name")
    refused("G0 X#<none>", r"line 1, column 5, #<none>: the parameter has no value yet")
    refused("G0 X#5420", r"#5420: parameters of the program are #1 to #5000")
    refused("G0 X#<a", r"column 5, #<a: the parameter's <name> is not finished")
    refused("#1 5", r"line 1, column 1, #1 5: a parameter that stands alone is set; = is missing")
    refused("G0 X" + "[" * 60 + "1" + "]" * 60, "nested more than 30 deep")
    refused("G0 X[10**300*10**300]", "this has no value")
    refused("G0 X[10**200]", "the number is too large")
    refused("o1 if [1]\nG0 X1", r"line 1, column 1, o1 if: O1 ENDIF is missing")
    refused("o1 endif", r"line 1, column 1, o1 endif: O1 IF is not open here")
    refused("o1 if [1]\no2 while [0]\no1 endif\no2 endwhile", r"line 3.*O1 IF is not open here; O2 WHILE is still open")
    refused("o1 else", r"O1 IF is not open")
    refused("o1 if [1]\no1 else\no1 else\no1 endif", r"line 3.*ELSE is the last branch")
    refused("o1 break", r"no loop O1 is open")
    refused("o1 return", r"no subroutine O1 is open")
    refused("o1 call", r"no subroutine O1 in this program")
    refused("o1 sub\no1 endsub\no1 sub\no1 endsub", r"line 3.*defined twice")
    refused("o1 if [1]\no2 sub\no2 endsub\no1 endif", r"line 2.*stands outside")
    refused("o1 if\no1 endif", r"line 1, column 1, o1 if: IF is followed by one value")
    refused("o1 if [1] G0\no1 endif", r"line 1, column 11, G0: only values")
    refused("o1 jump", r"column 1, o1 jump: the O word has no keyword")
    refused("o sub", r"an O word has a number")
    refused("o1 sub\no1 call\no1 endsub\no1 call", r"line 2.*more than 9 deep")
    refused("o1 while [1]\no1 endwhile", r"after 100 lines run", block_limit=100)
    refused("o1 while [1]\n o2 do\n o2 while [1]\no1 endwhile", r"after 100 lines run", block_limit=100)


def test_what_differs_from_fanuc():
    refused("X1", "no motion is in force")
    assert read_program("X1", MACHINE).blocks.rapid.all()
    refused("G0 X1\nG80\nX1", r"line 3, column 1, X1: no motion is in force")
    refused("G0 G80", "G80 and G0 are both of the group motion")
    refused("G0 G28 X0", "column 1, G0: G28 and G0 both want the axis words")
    refused("M428", r"M428 is not read: switchable kinematics")
    refused("M129", "command of the machine's owner")
    refused("M10", "no such M code")
    refused("G43.4 H1", "LinuxCNC has tool centre point control in its kinematics")
    refused("G54.1 P1", "no such G code")
    refused("G5.1 Q1", "quadratic spline")
    assert_allclose(read("G0 X1\nG4 P1.5").blocks.seconds[1], 1.5)
    assert_allclose(read("G1 X30 C40 F500\nC0").blocks.seconds, [3.6, 4.8])
    offsets = {"G59.3": {"X": 5.0}}
    assert x("G0 X1\nG59.3 X1", offsets=offsets) == [1, 6]
    assert x("G0 X5\nG92 X0\nX1\nG92.1\nX1") == [5, 6, 1]
    assert read("G0 X9 Y9 Z9\nG28").blocks.values[-1].tolist() == [0, 0, 500, 0, 0]
    assert read("T1 M6\nG43\nG0 Z0", tool_lengths={1: 50.0}).blocks.values[-1, 2] == 0.0
    arcs = read("G90.1 F10\nG0 X10 Y0 Z0\nG3 X0 Y10 I0 J0\nG91.1\nG2 X10 Y0 J-10").blocks
    assert_allclose(arcs.centre[1:], np.zeros((2, 3)), atol=1e-12)
    assert_allclose(np.degrees(arcs.sweep), [0, 90, -90])
