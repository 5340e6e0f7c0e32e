"""The inspection sheet of flanks: its scale, what it says of extremes and of columns that alias with a path's steps."""

from dataclasses import replace

import numpy as np
import pytest

from gearsim.metrology.grid import COARSE, DENSE
from gearsim.output.driving_sides import driving_sides
from gearsim.output.flank_sheet import (
    Sheet,
    aliasing_um,
    draw_sheet,
    missed_extreme,
    number,
    sheet_words,
    whisker_scale,
)
from gearsim.output.saving import Save
from gearsim.output.wanted import Wanted


@pytest.fixture
def sheet(result):
    return Sheet(*(result.measurements["convex", "program", grid] for grid in (COARSE, DENSE)))


def with_um(sheet, coarse=0.0, dense=0.0):
    """A sheet with other deviations, functions of the shares along and up."""

    def put(m, um):
        grid = np.meshgrid(m.grid.length, m.grid.height)
        values = um(*grid) if callable(um) else np.full(m.grid.shape, um)
        return replace(m, deviation=replace(m.deviation, value=1e-3 * values))

    return Sheet(put(sheet.coarse, coarse), put(sheet.dense, dense))


@pytest.mark.parametrize(("um", "share"), [(0.0, 0.42), (2.5, 0.42), (5.0, 0.42), (10.0, 0.21), (1e6, 0.021)])
def test_a_whisker_shows_the_tolerance_unless_deviations_need_the_room(sheet, um, share):
    assert 5.0 * whisker_scale([with_um(sheet, um), with_um(sheet, 0.0)], 5.0) == pytest.approx(share)


def test_the_worst_point_is_named_from_root_and_toe(sheet):
    (text, warns), *_ = sheet_words(with_um(sheet, lambda x, y: 3.0 * x * y), 5.0)
    assert not warns
    assert "worst 2.43 µm at row 5 from the root, column 9 from the toe" in text
    assert "tolerance ±5 µm" in text


def test_what_lies_outside_the_inspectors_grid_is_told(sheet):
    def corner(x, y):
        return np.where((x > 0.95) & (y < 0.05), -121.0, 0.0)

    cut = with_um(sheet, 0.0, corner)
    value, along, up = missed_extreme(cut, 5.0)
    assert value == -121.0
    assert along > 95.0
    assert up < 5.0
    assert any(warns and "misses −121 µm at" in text for text, warns in sheet_words(cut, 5.0))
    assert missed_extreme(with_um(sheet, 0.0, 0.4), 5.0) is None
    assert missed_extreme(with_um(sheet, 0.0, 0.6), 5.0) is not None


def test_columns_that_fall_on_like_phases_of_the_steps_are_warned_of(sheet):
    """The columns lie 0.1 of the face apart: waves of that length, or a half or a third of it, do not show."""
    fine = replace(sheet.dense.grid, length=np.linspace(0.01, 0.99, 401))
    value = np.tile(1e-3 * np.cos(20.0 * np.pi * fine.length), (fine.shape[0], 1))
    waves = replace(sheet.dense, grid=fine, deviation=replace(sheet.dense.deviation, value=value))
    assert aliasing_um(Sheet(sheet.coarse, waves)) == pytest.approx(2.0, abs=0.1)
    value = np.tile(1e-3 * np.cos(13.0 * np.pi * fine.length), (fine.shape[0], 1))
    seen = replace(waves, deviation=replace(waves.deviation, value=value))
    assert aliasing_um(Sheet(sheet.coarse, seen)) == 0.0
    assert aliasing_um(with_um(sheet)) == 0.0


def test_an_unmeasured_flank_is_said_to_be(sheet):
    assert sheet_words(with_um(sheet, np.nan, np.nan), 5.0) == [("nothing of this flank was measured", True)]


def test_the_page_is_drawn_at_any_size(sheet, tmp_path):
    save = Save(tmp_path, Wanted(formats=("svg",)))
    for um in (np.nan, 0.0, 1e-9, 3.0, 1e4):
        draw_sheet("title", ["a line"], [with_um(sheet, um, um)] * 2, 5.0, "sheet.png", save)
        assert (tmp_path / "sheet.svg").stat().st_size > 10_000


@pytest.mark.parametrize(("um", "text"), [(0.123, "0.12"), (-12.34, "−12.3"), (123.4, "123"), (-0.0, "−0.00")])
def test_numbers_keep_the_digits_that_matter(um, text):
    assert number(um) == text


@pytest.mark.parametrize(
    ("surface", "drive"),
    [
        ({"teeth": 33, "mate_teeth": 9, "spiral_angle_deg": 32.0}, "convex"),
        ({"teeth": 9, "mate_teeth": 33, "spiral_angle_deg": 32.0}, "concave"),
    ],
)
def test_the_drive_side_is_named_by_custom(surface, drive):
    (line,) = driving_sides({"surface": surface})
    assert f"{drive} flank = drive side" in line
    assert "turned the other way round they change places" in line


def test_without_a_custom_no_side_is_named():
    alike = {"teeth": 20, "mate_teeth": 20, "spiral_angle_deg": 35.0}
    for surface in (alike, {"teeth": 33, "mate_teeth": 9, "spiral_angle_deg": 0.0}, {"kind": "cylindrical-gear"}, {}):
        assert driving_sides({"surface": surface}) == []


def test_the_sheet_says_it(result):
    from gearsim.output.grids import _lines

    assert _lines(result)[-1].startswith("this wheel of 33 teeth against 9: convex flank = drive side")
