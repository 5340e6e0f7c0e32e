"""How lines are written: encodings, blanks, comments, labels, line numbers, the program's begin and end."""

import pytest

from gearsim.machines.catalogue import table_table_bc
from gearsim.programs.gcode import ProgramError, read_program
from gearsim.programs.gcode.errors import Line
from gearsim.programs.gcode.squeeze import squeezed

MACHINE = table_table_bc()
PLAIN = "".join(f"G1 X{i}. F100\n" for i in range(100))


def read(program, dialect="linuxcnc"):
    return read_program(program, MACHINE, dialect=dialect)


def x(program, dialect="linuxcnc"):
    return read(program, dialect).blocks.values[:, 0].tolist()


def refused(program, match, dialect="linuxcnc"):
    with pytest.raises(ProgramError, match=match):
        read(program, dialect)


@pytest.mark.parametrize("dialect", ["fanuc", "linuxcnc"])
@pytest.mark.parametrize(
    "raw",
    [
        "(Fräser Ø12 – grob)\nG0 X1\n".encode(),
        "(Fräser Ø12)\nG0 X1 (fertig größer)\n".encode("latin-1"),
        "(荒加工 エンドミル)\nG0 X1 (完了)\n".encode("shift-jis"),
        "(荒加工)\nG0 X1\n".encode("euc-jp"),
        "(粗加工 刀具)\nG0 X1 (结束)\n".encode("gb18030"),
        "(черновая)\nG0 X1\n".encode("cp1251"),
        "\ufeff(Fräser)\nG0 X1\n".encode(),
        "\ufeff(Fräser)\r\nG0 X1\r\n".encode("utf-16-le"),
        "\ufeff(Fräser)\r\nG0 X1\r\n".encode("utf-16-be"),
        b"(bell \x07, escape \x1b[1m, nothing \x00)\nG0 X1\n",
        b"(c)\r\nG0 X1\r\r\n",
    ],
)
def test_comments_have_any_encoding(tmp_path, raw, dialect):
    (tmp_path / "part.nc").write_bytes(raw)
    assert x(tmp_path / "part.nc", dialect) == [1.0]


def test_titles_keep_their_letters(tmp_path):
    (tmp_path / "part.nc").write_bytes("(Fräser Ø12)\nG0 X1\n".encode())
    assert read(tmp_path / "part.nc").title == "Fräser Ø12"
    assert read("(荒加工)\nG0 X1\n").title == "荒加工"


def test_words_are_ascii_and_columns_count_characters():
    refused("(größe) G0 Xö1", r"line 1, column 13, '\\xf6': outside of comments")
    refused("(größe) G0 X1 X2", r"line 1, column 15, X2: the letter X stands twice")
    refused("G0 X1\x1a", r"line 1, column 6.*ASCII", "fanuc")
    refused("G0 X1 (a\rG0 X2)", r"line 1, column 9: a carriage return ends no line")


def test_linuxcnc_passes_over_blanks_even_in_numbers():
    assert x("G 0 X 1 0 . 5\nG0\tX-\t2\n N 1 0 G 0 X 7 ( 8 ) Y 9") == [10.5, -2.0, 7.0]
    assert x("# 1 = 3 0 # < a B > = 4\nG0 X [ S I N [ # 1 ] + #<AB> ]") == [4.5]
    assert x("O 5 I F [ 1 E Q 1 ]\nG0 X1\no5 END IF") == [1.0]
    assert x(PLAIN + "G0 X1 2")[-1] == 12.0
    refused("G0 X1 2", r"column 7, 2: a word begins with a letter; a blank ends a number", "fanuc")
    assert x("G0 X 1 (2 3)", "fanuc") == [1.0]


def test_errors_name_the_line_as_it_is_written():
    refused("G0 X 1 Y 2 . 3 . 4", r"line 1, column 10, 2 . 3 . 4: 2.3.4 is not a number")
    refused("G0 ( a ) X [ 1 + ]", r"line 1, column 18, \]: expected a number")
    refused("  o1 if [ 1 ] G0 X1\no1 endif", r"line 1, column 15, G0 X1: only values in \[ \] follow IF")
    refused("G0 X", r"line 1, column 4, X: a number is missing behind X")
    line = squeezed(Line("p", 3, " G0 (a b) X 1 ;x y\r"), 99)
    assert line.text == "G0(a b)X1;x y"
    assert str(line.error(7, 9, "so")) == "p, line 3, column 11, X 1: so"
    assert str(line.error(13, 13, "end")) == "p, line 3, column 19: end"


def test_a_line_of_linuxcnc_has_up_to_252_characters():
    assert x("G0 X1" + " " * 247) == [1.0]
    refused("G0 X1" + " " * 248, "the line has 253 characters; up to 252 are read")
    assert x(PLAIN + "G0 X1" + " " * 247)[-1] == 1.0
    refused(PLAIN + "G0 X1" + " " * 248, "line 101, column 253: the line has 253 characters")
    assert x("G0 X1" + " " * 251, "fanuc") == [1.0]


def test_line_numbers_stand_first():
    assert x("N5G0X1\n/N5.5 G0 X2\nN0 X3") == [1.0, 2.0, 3.0]
    refused("G0 N5 X1", "column 4, N5: a line number is digits, and stands first")
    refused("N#1 G0 X1", "column 1, N: a line number is digits")
    refused(PLAIN + "G0 N5 X1", "line 101, column 4, N5: a line number")
    assert x("G0 N5 X1", "fanuc") == [1.0]
    refused("/1 G0 X1", "column 2, 1: a word begins with a letter")
    assert x("/1 G0 X1", "fanuc") == [1.0]


def test_a_label_alone_names_the_program():
    program = read("O1000 (bracket)\nG0 X1\nM2")
    assert (program.number, program.title, program.blocks.values[:, 0].tolist()) == (1000, "bracket", [1.0])
    assert x("%\nN1 o<part>\nG0 X1\n%") == [1.0]
    refused("O1000 G0 X1", "column 1, O1000 G: the O word has no keyword")
    refused("G0 O5 X1", "no words with the letter O")
    refused("o1 sub\nO5\no1 endsub\nG0 X1", "a label alone begins a program")
    assert x("o<7> if [1]\nG0 X1\no7 endif") == [1.0]


def test_comments_that_are_orders_are_refused():
    refused("G0 X1\n(ABORT, tool broken)", r"line 2, column 1, \(ABORT, tool broken\): this comment stops the control")
    refused("( py, x=1) ", "runs Python")
    assert x("G0 X1 (abort, no) (only the last comment is one)\n(MSG, abort, x)\n(PRINT,#<none>)\nX2") == [1.0, 2.0]


def test_signs_percent_of_linuxcnc():
    assert x("\n % \nG0 X1\n%\nG0 X2") == [1.0]
    refused("G0 X1\n%\nM2", "line 2, column 1, %: the sign % ends a program that begins with it")
    refused("(head)\n%\nG0 X1\n%", "line 2, column 1, %: the sign %")
    refused("%\no1 if [0]\n%\no1 endif\n%", "the program ends inside of what is passed over")
    assert x("G0 X1\n%\nG0 X2", "fanuc") == [1.0]


def test_a_program_that_is_cut_off_is_told():
    assert "cut off" in read("G0 X1").notes[-1]
    for program in ("G0 X1\nM2", "G0 X1 M30\n", "%\nG0 X1\n%\n", "o1 sub\nG0 X1\no1 endsub\no1 call\nM2"):
        assert read(program).notes == ()
    assert read("G0 X1.", "fanuc").notes == ()


def test_lines_passed_over_are_read_for_their_comments():
    assert x("o1 if [0]\nG0 X1 X2 nonsense\no1 endif\nG0 X3") == [3.0]
    refused("o1 if [0]\n(a (b))\no1 endif\nG0 X1", "line 2, column 4.*do not nest")
    refused("o1 sub\n(a\no1 endsub\nG0 X1", r"line 2, column 1, \(a: the comment is not finished")
    assert x("G0 X1\nM2\n(not read any more") == [1.0]


def test_calls_and_their_values():
    sub = "o<s> sub\nG0 X#1 Y#2\no<s> endsub [#1+1]\n"
    assert x(sub + "o<s> call (a) [1] (b) [2] ; c\nX#<_value>\nX[9*#<_value_returned>]\nM2") == [1.0, 2.0, 9.0]
    assert x("o<s> call [3]\nM2\n" + sub) == [3.0]
    assert x(sub + "G0 X#<_value>\nX[#<_call_level>-1]\nM2") == [1.0, -1.0]  # evaluated at the definition, too
    refused("o<s> call [3]\n" + sub + "M2", "line 2, column 1, o<s> sub: .* was called before the program came here")
    refused(sub + "o<s> call " + "[1]" * 31, "takes up to 30 values; these are 31")
    refused(sub + "o<s> call [1] [2", "is not finished")
    refused("o1 sub\no1 endsub [1] [2]\nG0 X1", "returns one value")
    refused("o1 sub\no1 return [1/#1]\no1 endsub\nG0 X1", "line 2.*this has no value")
    refused("#<_value>=3", "control's own and cannot be set")
    refused("G0 X#<_metric>", "what the control says about itself in this parameter is not known here")
    assert x("G0 X[EXISTS[#<_metric>]+EXISTS[#<none>]*10+EXISTS[#5602]*100+EXISTS[#5601]*1000]") == [1001.0]


def test_marks_that_loops_leave():
    """As linuxcnc-uspace 2.9 does (findings/linuxcnc_loops.sh)."""
    first = "#1=0 #2=0\no1 while [#2 LT 2]\n#2=[#2+1]\no2 if [#2 GT {n}]\no1 break\no2 endif\no1 endwhile\n"
    do = "o3 do\n#1=[#1+1]\nG0 X#1\no3 while [#1 LT 3]\n"
    assert x(first.format(n=0) + do) == [1.0]
    assert x(first.format(n=9) + do) == [1.0]
    assert x("#1=0\n" + do) == [1.0, 2.0, 3.0]
    goes_on = "#1=0 #2=0\no1 do\n#2=[#2+1]\no1 continue\no1 while [#2 LT 2]\n"
    repeat = "o3 repeat [{n}]\n#1=[#1+1]\nG0 X#1\no3 endrepeat\n"
    assert x(goes_on + repeat.format(n=2)) == [1.0, 2.0, 3.0, 4.0]
    assert [len(x("#1=0 G0\n" + repeat.format(n=n) + "G0 X9")) - 1 for n in (2.5, 3.5, 2.6, -2, 0.5)] == [2, 4, 3, 0, 0]
    refused("o1 repeat [2]\no1 break\no1 endrepeat", "no loop O1 is open here; BREAK and CONTINUE are for WHILE and DO")
    refused("o1 if [1]\no1 endif\no1 if [1]\no1 endif", "line 3.*O1 is taken by line 1")
    assert x("o1 sub\no5 if [1]\nG0 X1\no5 endif\no1 endsub\no5 if [1]\no1 call\no5 endif") == [1.0]


def test_numbers_near_whole_ones():
    assert x("#[1.00009]=5\nG0 X#0.99995") == [5.0]
    refused("G0 X#1.001", "a parameter's number is whole; this is 1.001")
    assert x("G0 X[FIX[SIN[30]*2]]\nX[2+FIX[TAN[45]]]\nX[4+FUP[COS[90]]]") == [1.0, 3.0, 4.0]
    assert x("G0 X[1 EQ 1.00009]\nX[3-[1 NE 1.00009]]\nX[5-[1.00009 LE 1]]") == [1.0, 3.0, 5.0]
    assert x("G0 X[0 EQ 0.0001]\nX[ROUND[-2.5]]\nX[ROUND[2.5]]") == [0.0, -3.0, 3.0]
    refused("G0 X[ROUND[3000000000]]", "this has no value")
