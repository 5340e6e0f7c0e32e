"""A program of the user's own is cut only where tool, work offset and tool length of every move are known."""

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.metrology.gear_reach import ReachInspection
from gearsim.metrology.program_times import ProgramInspection
from gearsim.processes.run import plan
from gearsim.scene import check_scene, load_scene, scene_table, scene_text
from tests.processes.gears import gear_scene


@pytest.fixture(scope="module")
def text():
    return plan(gear_scene()).files["program.nc"]


def own(text, folder, *overrides):
    """The blocks of a program, written into the folder, as the job cuts them."""
    (folder / "own.nc").write_text(text, encoding="ascii")
    job = plan(gear_scene("program.file=own.nc", *overrides), folder)
    return next(i.program.blocks for i in job.inspections if isinstance(i, ProgramInspection))


def changed(text, old, new):
    assert old in text
    return text.replace(old, new, 1)


PASS = "G90 G94 G54 G43 H1\nG00 X40. Y0. Z-5.\nG01 X30. F100\n"
ABSOLUTE = "T1 M06\nG90 G94 G49 G54"
REFUSED = [
    (lambda t: changed(t, "T1 M06\n", PASS + "T1 M06\n"), r"line 15, column 1, G00: no tool is in the spindle here"),
    (lambda t: changed(t, "T1 M06\n", "G91 G01 X-1. F100\nT1 M06\n"), r"line 14, column 5, G01: no tool"),
    (lambda t: changed(t, "T1 M06\n", ""), r"line 19, column 1, G00: no tool is in the spindle here; .* T and M6"),
    (lambda t: t.replace("T1 M06\n", ""), r"line 19, column 1, G00: no tool"),
    (lambda t: changed(t, "T1 M06\n", "T1\n"), r"line 20, column 1, G00: no tool"),
    (lambda t: changed(t, "T1 M06\n", "T1 M06\nT0 M06\n"), r"line 21, column 1, G00: no tool"),
    (lambda t: changed(t, "M05\nG91 G28 Z0", "T0 M06\nG01 X1. F100"), r"column 1, G01: no tool is in the spindle"),
    (lambda t: changed(t, "G49 G54", "G49 G55"), r"line 20, column 1, G00: G55 is in force, .* known are G54"),
    (lambda t: t.replace("G49 G54", "G49 G54.1 P2"), r"line 20, column 1, G00: G54\.1 P2 is in force"),
    (lambda t: changed(t, "G43 H1 ", "G43 H12 "), r"line 23, column 9, Z-72\.5346: H12 is compensated, T1 is .* H1"),
    (lambda t: changed(t, "G43 H1 ", ""), r"line 23, column 1, Z-72\.5346: no tool length is compensated, .* G43 H1"),
    (lambda t: changed(t, "G43 H1 Z-72.5346", ""), r"line 24, column 14, Z-78\.4375: no tool length is compensated"),
    (lambda t: changed(t, "G43 H1 Z-72.5346\nG00 Y-1.5875 Z-78.4375", ""), r"line 24, column 5, G01: where Z stands"),
    (lambda t: changed(t, "G00 X124.1750 Y-1.8130\nG43 H1 Z-72.5346\nG00 Y-1.5875 Z", "G43 H1 Z"), "where Y stands"),
    (lambda t: changed(t, ABSOLUTE, "T1 M06\nG92 X0 Y0 Z0\n" + ABSOLUTE[7:]), r"line 15, .*, G92: it sets a zero"),
    (lambda t: changed(t, ABSOLUTE, "T1 M06\nG90 G10 L2 P1 X9\n" + ABSOLUTE[7:]), r"line 15, .*, G10: it states"),
    (lambda t: changed(t, "T1 M06", "T2 M06"), r"line 14, column 1, T2: tool T2 is not among the tools there are: T1"),
]  # fmt: skip


@pytest.mark.parametrize(("change", "match"), REFUSED, ids=[str(i) for i in range(len(REFUSED))])
def test_what_is_not_known_of_a_move_is_refused_by_line(text, tmp_path, change, match):
    with pytest.raises(InputError, match=r"own\.nc, " + match if match.startswith("line") else match):
        own(change(text), tmp_path)


def test_the_work_offset_of_the_scene_stands_on_the_gear(text, tmp_path):
    job = own(text.replace("G54", "G55"), tmp_path, "program.work_offset=G55")
    assert job.values.shape == own(text, tmp_path).values.shape


def test_what_is_known_is_cut(text, tmp_path):
    """Retracts before the first tool, a zero set where the tool is known to stand, its length by LinuxCNC's G43."""
    plain = own(text, tmp_path)
    head = changed(text, "T1 M06\n", "G90 G53 G00 Z0\nG91 G28 X0 Y0\nT1 M06\n")
    assert own(head, tmp_path).values[-1].tolist() == plain.values[-1].tolist()
    shifted = changed(text, "G00 Y-1.5875 Z-78.4375", "G92 X124.175\nG52 X0\nG00 Y-1.5875 Z-78.4375")
    assert len(own(shifted, tmp_path)) == len(plain)
    linuxcnc = text.replace("G43 H1", "G43").replace("O0001 ", "").replace("M68\n", "").replace("M69\n", "")
    linuxcnc = linuxcnc.replace("M10\n", "").replace("M11\n", "").replace(" G93", "").replace(" G94", "")
    found = own(linuxcnc, tmp_path, "program.dialect=linuxcnc")
    assert found.values.shape == plain.values.shape


def test_the_tool_at_the_start_is_cut_where_the_scene_names_it(text, tmp_path):
    plain = own(text, tmp_path)
    blocks = own(text.replace("T1 M06\n", ""), tmp_path, "control.start_tool=1")
    assert blocks.values.tolist() == plain.values.tolist()
    assert set(blocks.tool.tolist()) == {1}
    gouge = own(changed(text, "T1 M06\n", PASS + "T1 M06\n"), tmp_path, "control.start_tool=1")
    assert (gouge.tool == 1).all()
    assert len(gouge) > len(plain)


def test_work_offsets_and_lengths_of_the_scene_are_where_they_are(text, tmp_path):
    """G55 100 mm beside the part's, H12 longer by 5 mm than T1: the cuts of G54 and H1 elsewhere."""
    plain = own(text, tmp_path)
    places = "control.work_offsets={G54 = {X = 10.0, Y = 20.0}, G55 = {X = 110.0, Y = 20.0, C = 90.0}}"
    moved = own(text.replace("G54", "G55"), tmp_path, places)
    cut = ~plain.rapid
    difference = (moved.values - plain.values)[cut]
    assert difference[:, 0] == pytest.approx(100.0)
    assert difference[:, 4] == pytest.approx(1.5707963)
    lengths = "control.tool_lengths_mm={1 = 50.0, 12 = 55.0}"
    longer = own(text.replace("G43 H1", "G43 H12"), tmp_path, lengths)
    assert (longer.values[~longer.rapid] - plain.values[cut])[:, 2] == pytest.approx(5.0)


def test_what_nobody_states_is_zero_only_where_the_scene_says_so(text, tmp_path):
    for change in (lambda t: t.replace("G49 G54", "G49 G55"), lambda t: t.replace("G43 H1 ", "")):
        with pytest.raises(InputError, match="is not known here"):
            own(change(text), tmp_path)
        assert len(own(change(text), tmp_path, "control.unstated_is_zero=true")) == len(own(text, tmp_path))


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("control.start_tool=2", "control.start_tool: no tool 2; tools has 1"),
        ("control.work_offsets={G55 = {X = 1.0}}", "control.work_offsets: G54, which stands on the part, is missing"),
        ("control.work_offsets={G54 = {A = 1.0}}", r"control.work_offsets.G54: machine .* has no axis A"),
        ("control.work_offsets={G99 = {X = 1.0}}", "control.work_offsets.G99"),
        ("control.work_offsets={G54 = {X = nan}}", "control.work_offsets.G54.X: got nan"),
        ("control.tool_lengths_mm={H1 = 5.0}", "control.tool_lengths_mm.H1"),
        ("control.tool_lengths_mm={1 = true}", "control.tool_lengths_mm.1: got True"),
        ("control.least_increment_mm=1.0", "control.least_increment_mm: got 1.0"),
        ("control.lest_increment_mm=0.001", "did you mean 'least_increment_mm'"),
        ('program.work_offset="G99"', "expected G54 to G59"),
    ],
)
def test_what_a_control_cannot_be_told_is_refused_by_its_key(text, tmp_path, override, message):
    with pytest.raises(InputError, match=message):
        own(text, tmp_path, override)


def test_a_control_without_a_program_to_read_is_refused():
    with pytest.raises(InputError, match=r"control: the planned program states all it needs"):
        load_scene("spur-external", ["control.start_tool=1"])


def test_three_operations_are_cut_with_their_own_tools_whatever_the_comments_say(tmp_path):
    """Slots, roughing and finishing by T3, T1 and T2, with comments that begin operations in which nothing moves."""
    mill = "name = 'mill', flute_length_mm = 12.7, flutes = 3"
    sizes = {3: 2.5, 1: 3.0, 2: 3.175}
    tools = ", ".join(f"{{number = {n}, diameter_mm = {d}, {mill}}}" for n, d in sizes.items())
    coarse = ("toolpath.roughing.axial_step_mm=2.5", "toolpath.slots.radial_step_mm=5.0")
    used = [f"toolpath.{name}.tool={n}" for name, n in (("slots", 3), ("roughing", 1), ("finishing", 2))]
    tables = scene_text("spur-external")[0]
    head, tail = tables.split("[[tools]]")
    tail = tail[tail.index("# Further operations") :]
    (tmp_path / "three.toml").write_text(f"tools = [{tools}]\n{head}{tail}")
    planned = plan(gear_scene(*coarse, *used, of=tmp_path / "three.toml"), tmp_path)
    text = planned.files["program.nc"]
    assert [line[:2] for line in text.splitlines() if "M06" in line] == ["T3", "T1", "T2"]
    text = text.replace("M30", "(FINISHING, THE OTHER TEETH)\nN90 (THE REST)\nM30")
    (tmp_path / "own.nc").write_text(changed(text, "G21 G17", "(FURTHER)\nN5 (COMMENTS)\nG21 G17"))
    scene = gear_scene(*coarse, *used, "program.file=own.nc", of=tmp_path / "three.toml")
    mine, theirs = (job.variant("program").operations for job in (plan(scene, tmp_path), planned))
    assert {o.name: 2.0 * o.cutter.max_radius for o in mine} == {"T1": 3.0, "T2": 3.175, "T3": 2.5}
    assert [o.table.tip.shape for o in mine] == [o.table.tip.shape for o in theirs]
    assert all(np.array_equal(a.table.tip, b.table.tip) for a, b in zip(mine, theirs, strict=True))


def own_tools(text, folder, finishing):
    """The job of a program cut with T1 and T2, the second thicker, where one of them is said to finish."""
    (folder / "own.nc").write_text(text, encoding="ascii")
    tables = scene_table(gear_scene("program.file=own.nc"))
    tables["toolpath"]["finishing"]["tool"] = finishing
    tables["tools"] = [tables["tools"][0], tables["tools"][0] | {"number": 2, "diameter_mm": 4.0}]
    return plan(check_scene(tables, "s"), folder)


def reached(job):
    (found,) = (i for i in job.inspections if isinstance(i, ReachInspection))
    return found.diameter


def test_what_the_tool_reaches_that_finishes_the_user_s_program_is_probed(text, tmp_path):
    """[toolpath] of a built-in scene stays when program.file replaces its program: it may name an idle tool."""
    second = text.replace("T1 M06", "T2 M06").replace("G43 H1 ", "G43 H2 ")
    with pytest.raises(InputError, match=r"toolpath\.finishing\.tool: T2 cuts nothing in own\.nc, T1 does"):
        own_tools(text, tmp_path, 2)
    with pytest.raises(InputError, match=r"toolpath\.finishing\.tool: T1 cuts nothing in own\.nc, T2 does"):
        own_tools(second, tmp_path, 1)
    assert reached(own_tools(second, tmp_path, 2)) == 4.0


def test_a_program_that_ends_with_another_tool_is_told(text, tmp_path):
    before, end, after = text.rpartition("M09\nM05\n")
    both = before + "T2 M06\nG90 G54 G94 G43 H2 Z5.\nG01 X-50. F100\n" + end + after
    told = "toolpath.finishing.tool is T1, and what it reaches is probed; own.nc ends with T2"
    assert told in own_tools(both, tmp_path, 1).notes
    assert not any("own.nc ends with" in note for note in own_tools(both, tmp_path, 2).notes)
