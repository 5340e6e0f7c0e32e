"""A gear's verdict says nothing where nothing was judged or compared: unchecked, with the reason."""

from math import cos, radians

import pytest

from gearsim.errors import InputError
from gearsim.metrology.grid import DENSE
from gearsim.processes.run import plan, run
from gearsim.scene import load_scene

SMALL = (
    "metrology.spaces=2", "metrology.points=9", "metrology.rows=3", "metrology.columns=3",
    "metrology.section_pitch_mm=2", "simulation.dexel_pitch_mm=1.0", "toolpath.finishing.axial_step_mm=2.5",
)  # fmt: skip


@pytest.fixture(scope="module")
def own(tmp_path_factory):
    """Runs a program of the user's own, made from the planned lines of finishing alone."""
    scene, _ = load_scene("spur-external", SMALL)
    path = scene.toolpath.model_copy(update={"slots": None, "roughing": None})
    scene = scene.model_copy(update={"budget": None, "toolpath": path})
    folder = tmp_path_factory.mktemp("own")
    lines = plan(scene, folder).files["program.nc"].splitlines()

    def go(change=lambda lines: lines):
        (folder / "own.nc").write_text("\n".join([*change(list(lines)), ""]))
        table = scene.program.model_copy(update={"file": "own.nc"})
        return run(scene.model_copy(update={"program": table}), folder=folder)

    return go


def test_the_program_itself_is_judged(own):
    result = own()
    assert result.verdict != "unchecked"
    assert "2 of 15 spaces were probed, pitch was not judged" in result.headline
    assert "both roads measured space 1, one road alone the other 1 that were probed" in result.headline
    assert "13 of 15 spaces were measured by one road only" in result.headline
    assert all(result.measurements[side, "last operation", DENSE].gap.valid for side in ("left", "right"))


def test_a_header_behind_the_first_teeth_leaves_nothing_compared(own):
    result = own(lambda lines: [*lines[:900], "N99 (FINISHING, THE OTHER TEETH)", *lines[900:]])
    assert (result.verdict, result.exit_code) == ("unchecked", 3)
    for side in ("left", "right"):
        assert f"(FINISHING, THE OTHER TEETH) cuts no sample of {side}" in result.status


def test_a_space_that_is_left_out_is_named(own):
    def without_the_second(lines):
        ends = [i for i, line in enumerate(lines) if line.startswith("G00 X-")]  # of passes, four in a space
        return lines[: ends[3]] + lines[ends[7] :]

    result = own(without_the_second)
    assert (result.verdict, result.exit_code) == ("unchecked", 3)
    for side in ("left", "right"):
        assert f"no operation touches the {side} flank of space 2" in result.status
    assert "space 1" not in result.status


def test_a_space_that_is_not_probed_is_missed_or_measured_all_the_same(own):
    """Two of fifteen are probed: the fourth is left out, then cut 0.05 deg aside."""

    def changed(lines, change):
        ends = [i for i, line in enumerate(lines) if line.startswith("G00 X-")]
        return [*lines[: ends[11]], *change(lines[ends[11] : ends[15]]), *lines[ends[15] :]]

    result = own(lambda lines: changed(lines, lambda space: []))
    assert (result.verdict, result.exit_code) == ("unchecked", 3)
    assert "nothing cuts 1 of 15 spaces (4), though others are cut: not judged" in result.status

    def aside(line):
        head, word, angle = line.partition(" C")
        value, *rest = angle.split()
        return f"{head}{word}{float(value) + 0.05:.4f} {' '.join(rest)}".strip()

    def turned(space):  # its first line ends the space before, its last but two goes on to the next one
        moved = [aside(line) if " C" in line else line for line in space]
        return [space[0], *moved[1:]]

    result = own(lambda lines: changed(lines, turned))
    told = [f for f in result.findings if "in space 4" in f.text]
    assert [f.patch for f in told] == ["left", "right"]
    assert all(f.fails and f.kind == "out_of_tolerance" for f in told)
    arc = radians(0.05) * 37.5 * cos(radians(20.0))  # along the normal, whatever the radius
    assert sorted(f.depth_um for f in told) == pytest.approx([-1e3 * arc, 1e3 * arc], abs=1.5)


def test_a_program_that_moves_no_tool_is_refused(own):
    with pytest.raises(InputError, match="moves none of the scene's tools; expected T1 M06 and moves behind it"):
        own(lambda lines: ["%", "O1", "M30", "%"])


def test_a_program_beside_the_gear_touches_nothing(own):
    def lifted(lines):
        return [line.replace("G43 H1 Z5.0000", "G43 H1 Z55.0000").replace("Z-", "Z5") for line in lines]

    result = own(lifted)
    assert (result.verdict, result.exit_code) == ("unchecked", 3)
    assert "no operation touches the left flank of spaces 1, 2" in result.status
