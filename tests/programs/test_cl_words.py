"""The words of CL files as CAM systems spell them: text, comments, continued lines, rapid moves, what is not read."""

import pytest

from gearsim.errors import InputError
from gearsim.programs.cldata import RAPID, parse_cl, read_cl_text

TEXT_WORDS = (
    "PARTNO",
    "PPRINT",
    "TPRINT",
    "REMARK",
    "INSERT",
    "PPWORD",
    "PRINT",
    "LETTER",
    "TITLES",
    "TITLE",
    "pprint",
)
START = "UNITS/MM\nFROM/0,0,0\n"


def moves(text):
    """(name, tip) of every move."""
    return [(p.name, tuple(tip)) for p in parse_cl(START + text).paths for tip in p.tips[1:].tolist()]


def names(text):
    return [name for name, _ in moves(text)]


@pytest.mark.parametrize("word", TEXT_WORDS)
@pytest.mark.parametrize("text", ["COSTS 5$", "A $$ B$", "/'A/B' $", "$", "A, $", " / IN / OUT $$"])
def test_a_text_word_has_neither_comments_nor_continuation(word, text):
    assert moves(f"{word} {text}\nRAPID\nGOTO/1,0,0\nGOTO/2,0,0\n") == [(RAPID, (1, 0, 0)), ("cut", (2, 0, 0))]


def test_the_text_may_follow_at_once_and_hold_a_slash():
    assert names("PARTNOPART 1/2\nINSERTM08$\nREMARK\nGOTO/1,0,0\n") == ["cut"]


def test_text_for_the_machine_and_moves_in_a_text_are_told():
    notes = parse_cl(START + "INSERT M08\nGOTO/1,0,0\nINSERT G0 Z9\nPPRINT PASS convexGOTO/2,0,0\n").notes
    assert notes[0] == (
        "INSERT: text for the machine's program, not read; what it moves there is not cut (2 times, first in line 3)"
    )
    assert "the text of PPRINT holds a motion word, which is text there and moves nothing (line 6)" in notes


@pytest.mark.parametrize(
    "text",
    [
        "GOTO/1,2,$\n3\nGOTO/4,5,6\n",
        "GOTO/1,$ $$ more to come $\n 2, $\n\n$$ a comment between\n3\nGOTO/4,5,6\n",
        "GOTO/1,2,3 $$ the end costs 5$\nGOTO/4,5,6\n",
        "$$ costs 5$\nGOTO/1,2,3\n$$\n$$$\nGOTO/4,5,6\n",
        "$$-> CSYS / 1.0, 0.0, -0.0, 0.0,  $\n   0.0, 1.0, 0.0, 0.0,  $\n 0.0, 0.0, 1.0, 0.0\nGOTO/1,2,3\nGOTO/4,5,6",
        "$$ size 4 $\n0.5, 0.5 $\n,7\nGOTO/1,2,3\nGOTO/4,5,6\n",
        "goto  /  1. , 2.0000000000,+3\r\nGOTO/ 4 5 6\rGOTO 4,5,6\n",
        "\tGOTO\t/ 1,.2e1,0.3D+1\n GODLTA/3,3,3 \n",
        "INTOL /0.1\nCUTCOM/OFF\nCYCLE / off\nCOOLNT/ON\nMACHIN/X,1\nGOTO/1,2,3\nPAINT/A,4\nGOTO/4,5,6\nEND\nFINI\n",
    ],
)
def test_continued_lines_comments_and_spellings(text):
    assert moves(text) == [("cut", (1, 2, 3)), ("cut", (4, 5, 6))]


@pytest.mark.parametrize("spelling", ["RAPID\n", "RAPID/\n", "RAPID \n", " rapid / \n", "RAPID,", "rapid, ", "RAPID "])
@pytest.mark.parametrize("move", ["GOTO/1,0,0", "godlta/1,0,0", "GOTO / 1,0,0,0,0,1"])
def test_a_rapid_in_any_spelling_holds_for_the_next_move_only(spelling, move):
    assert moves(f"{spelling}{move}\nGOTO/2,0,0\n") == [(RAPID, (1, 0, 0)), ("cut", (2, 0, 0))]


def test_a_rapid_waits_for_its_move_and_a_move_to_the_same_place_takes_it():
    assert names("GOTO/1,0,0\nRAPID\nFEDRAT/300\nSPINDL/100\nGOTO/2,0,0\nGOTO/3,0,0\n") == ["cut", RAPID, "cut"]
    assert names("GOTO/1,0,0\nRAPID\nGOTO/1,0,0\nGOTO/2,0,0\n") == ["cut", "cut"]
    assert parse_cl(START + "GOTO/1,0,0\nFROM/5,0,0\nGOTO/6,0,0\n").notes == (
        "FROM sets the tool elsewhere than where it was; nothing is cut between (line 4)",
    )
    assert names("GOTO/1,0,0\nRAPID\nFROM/5,0,0\nGOTO/6,0,0\nGOTO/7,0,0") == ["cut", RAPID, "cut"]


def test_passes_are_named_by_exact_words_only():
    text = (
        "PPRINT PASS Convex\nGOTO/1,0,0\nPPRINT PASSAGE ONE\nPPRINT BYPASS concave\nPPRINT PASS 1 OF 3\nPPRINT PASS\n"
        "GOTO/2,0,0\nPPRINT/'PASS concave'\nGOTO/3,0,0\n"
    )
    program = parse_cl(START + text)
    assert [(p.name, len(p.tips)) for p in program.paths] == [("convex", 3), ("concave", 2)]
    assert program.named == (("convex", 3), ("concave", 10))
    assert program.notes == (
        "PPRINT 'PASS 1 OF 3' names no pass; expected PPRINT PASS and one word (line 7)",
        "PPRINT 'PASS' names no pass; expected PPRINT PASS and one word (line 8)",
    )


def test_all_unknown_words_are_told_at_once_with_counts_and_the_nearest():
    text = "RAPD\nCIRCLE/1,2,3\nGOTO/1,0,0\nCIRCLE/1,2,3\nTLON,GOFWD/(CIRCLE/0,0,$\n1)\n0.5,0.5\nGOTO/2,0,nan\n"
    with pytest.raises(InputError) as caught:
        parse_cl(START + text, "my.cl")
    message = str(caught.value)
    assert message.startswith("my.cl, line 3: 4 words are not supported: ")
    for told in (
        "'RAPD' (line 3, did you mean RAPID?)", "'CIRCLE' (2 times, first in line 4)", "'TLON GOFWD' (line 7)",
        "'0.5,0.5' (line 9)", "supported are CLPRNT, ",
    ):  # fmt: skip
        assert told in message


def test_a_file_of_another_kind_is_told_by_its_first_words_alone():
    with pytest.raises(InputError, match=r"line 3: 30 words are not supported: .*'N7' \(line 10\) and 22 more "):
        parse_cl(START + "".join(f"N{i}\n" for i in range(30)), "my.cl")


@pytest.mark.parametrize("far", ["1e30", "-1.1E6"])
def test_places_where_no_nanometre_can_be_told_are_refused_by_line(far):
    with pytest.raises(InputError, match=r"line 3: .*farther than 1e\+06 mm"):
        parse_cl(START + f"GOTO/1,{far},0\nGOTO/2,0,0\n", "my.cl")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("CIRCLE/1,2\nCIRCLE/3,4", r"line 3: 1 word is not supported: 'CIRCLE' \(2 times, first in line 3\)"),
        ("ROTABL/1.5708", "line 3: word 'ROTABL' is not supported"),
        ("TOOL PATH/A,TOOL,B", "line 3: word 'TOOL PATH' is not supported"),
        ("GO TO/1,0,0", "line 3: word 'GO TO' is not supported"),
        ("GOTO/1,0,$\nGOTO/2,0,0", "line 4: a statement begins here, but '\\$' carries on the one of line 3"),
        ("COOLNT/ON$\nRAPID\nGOTO/1,0,0", "line 4: a statement begins here"),
        ("COOLNT/ON$\nPPRINT PASS convex", "line 4: a statement begins here"),
        ("COOLNT/ON GOTO/1,0,0", "line 3: GOTO stands within COOLNT"),
        ("COOLNT/ONGOTO/1,0,0", "line 3: GOTO stands within COOLNT"),
        ("STOP GODLTA 1,0,0", "line 3: GODLTA stands within STOP"),
        ("SPINDL/300,CLWRAPID", "line 3: RAPID stands within SPINDL"),
        ("COOLNT/ONMULTAX/OFF", "line 3: COOLNT/ONMULTAX/OFF: a second '/'"),
        ("GOTO/1,$2,3", "line 3: '\\$' carries a line on and stands at its end"),
        ("GOTO/1,2,3,", "line 3: nothing stands where a number should; expected GOTO/x,y,z or GOTO/x,y,z,i,j,k"),
        ("GOTO/1,,3", "line 3: nothing stands where a number should"),
        ("GOTO/1_0,0,0", "'1_0' is not a number"),
        ("GOTO/1,0,1e9999", "line 3: 1e9999 is not a finite number"),
        ("GOTO/1,2,3,4,5,6,7", "line 3: 7 numbers"),
        ("GODLTA/1", "line 3: 1 numbers; expected GODLTA/x,y,z"),
        ("CUTCOM/OFF\nCUTCOM/LEFT,XYPLAN,1", "line 4: word 'CUTCOM' is not supported, but CUTCOM/OFF"),
        ("CYCLE/DRILL,5\nCYCLE/OFF\nCYCLE/TAP", r"'CYCLE' \(2 times, first in line 3, but CYCLE/OFF\)"),
        ("RAPID/XAXIS", "line 3: RAPID/XAXIS: which way such a rapid move takes is not known"),
        ("GOTO/1,0,0\nFINI\nGOTO/2,0,0", "line 5: GOTO/2,0,0 behind FINI of line 4, where the program ends"),
        ("GOTO/1,0,0\nEND\nRAPID\nGOTO/2,0,0", "line 5: RAPID behind END of line 4"),
    ],
)
def test_what_would_be_dropped_or_misread_is_refused_with_its_line(text, message):
    with pytest.raises(InputError, match=message):
        parse_cl(START + text, "my.cl")


def test_stray_text_behind_the_end_is_told():
    assert parse_cl(START + "GOTO/1,0,0\nEND\nasdf jkl\n77\n").notes == (
        "text behind END or FINI is not read (2 times, first in line 5)",
    )


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1", "cp1252", "utf-16"])
def test_comments_in_any_encoding_do_not_stop_a_program(tmp_path, encoding):
    text = "PARTNO Stück ä ß\n$$ Fräser Ø10\nUNITS/MM\r\nGOTO/0,0,0\nGOTO/1,0,0\n\x1a"
    (tmp_path / "my.cl").write_bytes(text.encode(encoding))
    assert len(parse_cl(read_cl_text(tmp_path / "my.cl")).paths) == 1


def test_a_file_that_is_not_there_and_one_that_is_no_text(tmp_path):
    with pytest.raises(InputError, match=r"cannot read CL file .*missing\.cl: No such file"):
        read_cl_text(tmp_path / "missing.cl")
    (tmp_path / "binary.cl").write_bytes(bytes(range(256)) * 4)
    with pytest.raises(InputError, match=r"binary\.cl, line 3"):
        parse_cl(read_cl_text(tmp_path / "binary.cl"), "binary.cl")
