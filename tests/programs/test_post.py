import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.machines.catalogue import MACHINES, cradle, star, table_table_bc
from gearsim.programs.blocks import Blocks
from gearsim.programs.operation import Operation, Tool
from gearsim.programs.post import comment, write_program
from gearsim.programs.post_options import Header, PostOptions

FIVE_AXES = ("table-table-bc", "table-table-ac", "head-head-cb", "head-b-table-c", "head-b-table-a")
MILL = Tool(3, "end mill", 6.35, 25.4, 4)
APPROACH = 3  # lines that move before the first block
HEADER = Header(12, "spur gear", ("external (spur), z = 30", "pressure angle 20°"))


def block_table(machine, values, **columns):
    """Blocks between rows of axis values, feeds of one second unless ``columns`` say otherwise."""
    n = len(values) - 1
    columns = {
        "rapid": np.zeros(n, bool), "tip_control": np.zeros(n, bool), "seconds": np.ones(n),
        "line": np.zeros(n, int), "tool": np.full(n, 3), "operation": np.zeros(n, int),
        "sweep": np.zeros(n), "centre": np.zeros((n, 3)), "normal": np.full(n, 2),
    } | {name: np.asarray(column) for name, column in columns.items()}  # fmt: skip
    return Blocks(machine, np.asarray(values[0], float), np.asarray(values[1:], float), **columns)


def program(blocks, options=None, header=HEADER, tool=MILL):
    operation = Operation("finish left flanks", tool, 3000.0, blocks, comments=("down milling",))
    return write_program([operation], header, options or PostOptions())


def motion(text):
    """The lines behind the approach, up to coolant off."""
    lines = text.splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith(("G43 ", "G43.4 ")))
    return lines[start + 1 : lines.index("M09")]


def played(text, axes):
    """A control in a dozen lines: stated positions, F, feed mode, motion code and I, J, K of every motion line."""
    at, code, mode, feed, out = dict.fromkeys(axes, np.nan), None, 94, None, []
    for line in text.splitlines():
        words = [(w[0], float(w[1:])) for w in re.findall(r"[A-Z]-?\d+\.?\d*", re.sub(r"\(.*?\)", "", line))]
        for value in (v for letter, v in words if letter == "G"):
            mode = int(value) if value in (93, 94) else mode
            code = int(value) if value in (0, 1, 2, 3) else code
        here = dict(words)
        feed = here.get("F", None if mode == 93 else feed)
        if "G28" in line or not set(here) & {*axes, *"IJK"}:
            continue
        at |= {axis: here[axis] for axis in axes if axis in here}
        centre = [here.get(letter, 0.0) for letter in "IJK"]
        out.append(([at[axis] for axis in axes], feed, mode, code, centre))
    return out


def wandering(machine, rng, n):
    """Axis values that change a few axes at a time, rotary ones by many turns in the end."""
    scale = np.array([2.0 if joint.is_rotary else 20.0 for joint in machine.joints])
    steps = scale * rng.normal(size=(n, len(scale))) * (rng.random((n, len(scale))) < 0.6)
    return np.cumsum(steps, axis=0)


def test_a_program_reads_from_header_to_end():
    values = [[10.0, 0, 5, -0.1, 0], [10, 0, 2, -0.1, 0], [10, 4, 2, -0.1, 0.5], [10, 4, 5, -0.1, 0.5]]
    blocks = block_table(table_table_bc(), values, rapid=[True, False, True], seconds=[np.nan, 6.0, np.nan])
    assert (
        program(blocks).splitlines()
        == [
            "%",
            "O0012 (SPUR GEAR)",
            "(EXTERNAL [SPUR], Z = 30)",
            "(PRESSURE ANGLE 20 DEG)",
            "(MACHINE TABLE-TABLE-BC, AXES X Y Z B C)",
            "(WORK OFFSET G54, MILLIMETRES, DEGREES, FEED INVERSE TIME [G93])",
            "(T3 D6.35 4 FLUTES, FLUTE LENGTH 25.4: END MILL)",
            "G21 G17 G40 G49 G90 G94",
            "N10 (FINISH LEFT FLANKS)",
            "(DOWN MILLING)",
            "G91 G28 Z0",
            "T3 M06",
            "G90 G94 G49 G54",
            "S3000 M03",
            "M08",
            "M69",
            "M11",
            "G00 B-5.7296 C0.0000",
            "M68",
            "G00 X10.0000 Y0.0000",
            "G43 H3 Z5.0000",
            "G00 Z2.0000",
            "G93 G01 Y4.0000 C28.6479 F10.000",
            "G00 Z5.0000",
            "M09",
            "M05",
            "G91 G28 Z0",
            "G91 G28 X0 Y0",
            "G90 G49",
            "M68",
            "M10",
            "M30",
            "%",
            "",
        ][:-1]
    )


def test_a_tool_is_changed_only_where_it_changes():
    values = np.array([[0.0, 0, 0, 0, 0], [1, 0, 0, 0, 0]])
    blocks = block_table(table_table_bc(), values)
    first = Operation("rough", MILL, 2500.0, blocks, coolant=False)
    other = Operation("finish", replace(MILL, number=4), 3000.4, blocks)
    text = write_program([first, replace(first, name="more"), other], Header(1), PostOptions(number_step=5))
    assert re.findall(r"T\d M06", text) == ["T3 M06", "T4 M06"]
    assert re.findall(r"^N\d+ \(.*\)$", text, re.M) == ["N5 (ROUGH)", "N10 (MORE)", "N15 (FINISH)"]
    assert text.count("M08") == text.count("M09") == 1
    assert "S3000 M03" in text


@given(st.sampled_from(FIVE_AXES), st.booleans(), st.sampled_from([3, 4, 6]), st.integers(0, 10_000))
@settings(max_examples=40, deadline=None)
def test_what_is_written_is_the_motion_to_half_a_unit_of_the_last_decimal(name, held, decimals, seed):
    rng = np.random.default_rng(seed)
    machine = MACHINES[name]()
    values = wandering(machine, rng, 30)
    seconds = rng.uniform(0.01, 30.0, 29)
    blocks = block_table(machine, values, seconds=seconds, tip_control=np.full(29, held))
    text = program(blocks, PostOptions(linear_decimals=decimals, rotary_decimals=decimals - 1))
    found = played(text, machine.axes)[APPROACH:]
    stated = values * np.where([j.is_rotary for j in machine.joints], np.degrees(1.0), 1.0)
    if held:
        stated[:, :3] = machine.forward(values)[0]
    moves = np.flatnonzero((np.diff(values, axis=0) != 0.0).any(axis=1))
    assert len(found) == len(moves)
    half = 0.5000001 * np.array([10.0**-decimals] * 3 + [10.0 ** (1 - decimals)] * 2)
    for (position, feed, mode, code, _), block in zip(found, moves, strict=True):
        assert (np.abs(position - stated[block + 1]) <= half).all()
        assert (mode, code) == (93, 1)
        assert 60.0 / seconds[block] - 0.001000001 <= feed <= 60.0 / seconds[block] + 1e-6


def test_words_stand_only_where_they_change_and_an_inverse_time_always():
    values = [[0.0, 0, 0, 0, 0], [1, 0, 0, 0, 0], [1, 0, 0, 0, 0], [2, 0, 0, 0, 0], [2, 1, 0, 0, 0], [2, 1, -1, 0, 0]]
    blocks = block_table(table_table_bc(), values, rapid=[False, False, False, True, False])
    assert motion(program(blocks)) == [
        "G93 G01 X1.0000 F60.000",
        "X2.0000 F60.000",
        "G00 Y1.0000",
        "G01 Z-1.0000 F60.000",
    ]
    minutes = PostOptions(feed_mode="per-minute", linear_decimals=3, work_offset="G54.1 P7")
    text = program(blocks, minutes)
    assert motion(text) == ["G94 G01 X1.000 F60.000", "X2.000", "G00 Y1.000", "G01 Z-1.000"]
    assert "G90 G94 G49 G54.1 P7" in text


def test_no_minus_stands_before_zero():
    values = [[1.0, 1, 0, 0, 0], [-1e-9, 1, 0, 0, -1e-9], [-1e-9, -4e-5, 0, 0, -1e-9]]
    assert motion(program(block_table(table_table_bc(), values))) == ["G93 G01 X0.0000 F60.000", "Y0.0000 F60.000"]


@pytest.mark.parametrize(("seconds", "feed"), [(1e-4, 9999.0), (1e7, 0.001), (0.6, 100.0), (0.7, 85.714)])
def test_inverse_time_is_capped_never_zero_and_never_too_fast(seconds, feed):
    blocks = block_table(table_table_bc(), [[0.0, 0, 0, 0, 0], [1, 0, 0, 0, 0]], seconds=[seconds])
    assert played(program(blocks), "XYZBC")[-1][1] == feed


def test_feed_per_minute_is_what_a_control_divides_by():
    machine = MACHINES["head-head-cb"]()
    values = np.array([[0.0, 0, 0, 0, 0], [3, 4, 0, 0, 0], [3, 4, 0, 0, np.radians(90)], [3, 4, 30, 0, np.radians(50)]])
    values[:, 3:] = values[:, :2:-1]
    minutes = PostOptions(feed_mode="per-minute")
    blocks = block_table(machine, values, seconds=[30.0, 60.0, 60.0])
    assert [feed for _, feed, *_ in played(program(blocks, minutes), "XYZBC")[APPROACH:]] == [10, 90, 50]
    held = replace(blocks, tip_control=np.full(3, True))
    tips = machine.forward(values)[0]
    feeds = [feed for _, feed, *_ in played(program(held, minutes), "XYZBC")[APPROACH:]]
    lengths = np.linalg.norm(np.diff(tips, axis=0), axis=1)
    assert np.allclose(feeds, lengths * [2, 1, 1], atol=2e-3)


@pytest.mark.parametrize(("normal", "plane"), [(0, "G19"), (1, "G18"), (2, "G17")])
@pytest.mark.parametrize("degrees", [90.0, -135.0, 360.0, -300.0])
def test_arcs_come_back_from_centre_and_sense(normal, plane, degrees):
    u, v, sweep = (normal + 1) % 3, (normal + 2) % 3, np.radians(degrees)
    centre = np.array([3.0, -4.0, 5.0])
    ends = np.tile(centre, (2, 1))
    for end, angle in zip(ends, (0.3, 0.3 + sweep), strict=True):
        end[[u, v]] += 6.0 * np.cos(angle), 6.0 * np.sin(angle)
    ends[1, [u, v]] = ends[0, [u, v]] if degrees == 360.0 else ends[1, [u, v]]
    ends[1, normal] += 1.5
    values = np.hstack([[ends[0], *ends], np.zeros((3, 2))])
    values[0, 0] += 1.0
    blocks = block_table(
        table_table_bc(), values, sweep=[0.0, sweep], centre=[[0, 0, 0], centre], normal=[2, normal], seconds=[1.0, 2.0]
    )
    text = program(blocks)
    (start, *_), (end, feed, mode, code, offset) = played(text, "XYZBC")[-2:]
    assert plane in motion(text)[1]
    assert mode == 94
    assert code == (3 if sweep > 0 else 2)
    assert offset[normal] == 0.0
    centre[normal] = start[normal]
    assert np.allclose(np.array(start[:3]) + offset, centre, atol=1.1e-4)
    assert np.allclose(end[:3], ends[1], atol=0.6e-4)
    assert feed == pytest.approx(30.0 * 6.0 * abs(sweep), abs=0.02)


def test_axes_that_stand_are_clamped_and_all_are_released_before():
    values = np.array([[0.0, 0, 0, 0, 0], [1, 0, 0, 0.2, 0]])
    lines = program(block_table(table_table_bc(), values)).splitlines()
    approach = lines[lines.index("M08") + 1 : lines.index("G00 X0.0000 Y0.0000")]
    assert approach == ["M69", "M11", "G00 B0.0000 C0.0000", "M10"]
    without = program(block_table(table_table_bc(), values), PostOptions(clamps=()))
    assert not set(without.splitlines()) & {"M10", "M11", "M68", "M69"}


def test_tip_control_goes_straight_down_to_the_stated_tip():
    """X and Y stand by the linear axes before G43.4 states the tip, and its length is taken back before G28."""
    machine = table_table_bc()
    values = np.array([[10.0, 2, 5, 0.5, 1.0], [11.0, 2, 5, 0.5, 1.0]])
    lines = program(block_table(machine, values, tip_control=[True])).splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith("G43.4 H3 "))
    assert lines[at - 1] == "G00 X10.0000 Y2.0000"
    stated = [float(w[1:]) for w in lines[at].split()[2:]]
    assert np.allclose(stated, machine.forward(values)[0][0], atol=0.6e-4)
    assert lines[lines.index("M05") + 1] == "G49"


def test_comments_are_plain_and_do_not_nest():
    assert comment("Zähne (z = 30); β 20°, 100 % %") == "(ZAHNE [Z = 30]   20 DEG, 100    )"


def test_all_text_is_ascii_in_short_lines():
    header = Header(1, "gear", (50 * "größe ", ""))
    text = program(block_table(table_table_bc(), np.array([[0.0, 0, 0, 0, 0], [1, 0, 0, 0, 0]])), header=header)
    assert text.isascii()
    assert text.count("GRO") == 50
    assert max(map(len, text.splitlines())) < 80
    assert all(line.count("(") == line.count(")") <= 1 for line in text.splitlines())


def refused(match, blocks=None, **changes):
    values = np.array([[0.0, 0, 0, 0, 0], [1, 0, 0, 0, 0], [2, 0, 0, 0, 0]])
    with pytest.raises(InputError, match=match):
        program(blocks or block_table(table_table_bc(), values, **changes))


def test_blocks_that_no_program_can_state_are_refused():
    machine = table_table_bc()
    far = [[0.0, 0, 0, 0, 0], [1, 0, 0, 0, 60 * np.pi]]
    refused(r"block 1: C would be 10800.000 deg.*wind", block_table(machine, far))
    refused(r"block 2: Z would be nan mm", block_table(machine, [[0.0] * 5, [1.0] * 5, [1, 1, np.nan, 1, 1]]))
    refused(r"block 2: it takes 0 s", seconds=[1.0, 0.0])
    refused(r"block 2: it takes nan s", seconds=[1.0, np.nan])
    refused(r"block 2 changes tip control", tip_control=[True, False])
    refused(r"block 1: an arc cannot be stated under tip control", tip_control=[True, True], sweep=[1.0, 0.0])
    refused(r"no block moves the machine", block_table(machine, [[0.0] * 5, [1e-7] * 5]))
    ends = [[1.0, 0, 0, 0, 0], [1.0, 2e-5, 0, 0, 0], [1.0, 2e-5, 0, 0, 0]]
    refused("turns by 720 deg and would be read as one of 360", block_table(machine, ends, sweep=[0, 4 * np.pi]))
    refused("turns by 0.0011.* deg and would be read as one of 360", block_table(machine, ends, sweep=[2e-5, 0]))


def test_operations_that_do_not_go_together_are_refused():
    values = np.array([[0.0, 0, 0, 0, 0], [1, 0, 0, 0, 0]])
    one = Operation("one", MILL, 3000.0, block_table(table_table_bc(), values))
    with pytest.raises(InputError, match="at least one operation"):
        write_program([], HEADER)
    with pytest.raises(InputError, match="T3 is both 'end mill' and 'drill'"):
        write_program([one, replace(one, tool=replace(MILL, name="drill"))], HEADER)
    other = replace(one, blocks=block_table(MACHINES["table-table-ac"](), values))
    with pytest.raises(InputError, match="cannot share a program"):
        write_program([one, other], HEADER)
    for machine in (star(), cradle()):
        some = block_table(machine, np.zeros((2, len(machine.axes))))
        with pytest.raises(InputError, match="a program needs X, Y, Z and rotary axes"):
            write_program([replace(one, blocks=some)], HEADER)


@pytest.mark.parametrize(
    "wrong",
    [{"linear_decimals": 0}, {"rotary_decimals": 20}, {"max_feed": 1e5}, {"work_offset": "G60"}, {"number_step": 0}],
)
def test_options_that_no_control_takes_are_refused(wrong):
    with pytest.raises(InputError, match=next(iter(wrong))):
        PostOptions(**wrong)


def test_a_program_number_must_fit_its_word():
    with pytest.raises(InputError, match="O word holds 1 to 9999"):
        Header(0)
