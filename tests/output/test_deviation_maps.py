from dataclasses import replace

import numpy as np
import pytest
from matplotlib import pyplot
from scipy.ndimage import gaussian_filter

from gearsim.metrology.grid import DENSE
from gearsim.output.charts import draw_grids, sorted_out
from gearsim.output.contours import draw_contours, place_labels
from gearsim.output.heat import averaged, draw_heat, is_perfect, shared_limits, span
from gearsim.output.saving import Save
from gearsim.surfaces.involute import InvoluteFlank
from gearsim.surfaces.part import Tolerance
from gearsim.surfaces.reached_flank import ReachedFlank
from tests.metrology.gears import gear_of
from tests.output.pages import overlaps

PANEL = np.array([[0.0, 0.0], [200.0, 100.0]])


def line(y, start=0.0, end=200.0):
    return np.column_stack([np.linspace(start, end, 20), np.full(20, y)])


def test_labels_have_room_or_are_left_out():
    crowded = [("-0.15", line(y)) for y in (50.0, 51.0, 52.0)]
    placed = place_labels(crowded, PANEL)
    middles = [place for _, place in placed]
    assert len(placed) == 3
    assert len({round(float(x)) for x, _ in middles}) == 3  # beside each other
    assert len(place_labels([("-0.15", line(50.0 + 0.1 * k)) for k in range(50)], PANEL)) == 3


def test_a_label_at_the_border_or_on_a_speck_is_left_out():
    assert place_labels([("0.1", line(1.0))], PANEL) == []
    assert place_labels([("0.1", line(50.0, 20.0, 30.0))], PANEL) == []
    assert place_labels([], PANEL) == []


def test_labels_of_drawn_contours_do_not_collide():
    figure = pyplot.figure(figsize=(4.0, 2.0))
    axis = figure.add_axes((0.1, 0.1, 0.8, 0.8))
    x, y = np.meshgrid(np.linspace(0.0, 1.0, 60), np.linspace(0.0, 1.0, 40))
    draw_contours(axis, x[0], y[:, 0], np.exp(-40.0 * (x - 0.95) ** 2) * np.sin(9.0 * y), levels=12)
    boxes = [(t.get_text(), t.get_window_extent()) for t in axis.texts]
    pyplot.close(figure)
    assert len(boxes) >= 3
    assert list(overlaps(boxes)) == []


def test_waves_are_not_filled_with_contours():
    figure = pyplot.figure(figsize=(4.0, 2.0))
    axis = figure.add_axes((0.1, 0.1, 0.8, 0.8))
    x, y = np.meshgrid(np.linspace(0.0, 1.0, 20), np.linspace(0.0, 1.0, 200))
    draw_contours(axis, x[0], y[:, 0], np.sin(60.0 * y))
    drawn = len(axis.texts), len(axis.collections)
    pyplot.close(figure)
    assert drawn == (0, 0)


def test_maps_of_a_row_share_a_scale_unless_one_would_be_pale():
    assert shared_limits([1.0, 0.25, 0.2, 8.0, 7.0], [0, 0, 0, 1, 1]) == [1.0, 1.0, 0.2, 8.0, 8.0]
    assert shared_limits([], []) == []


@pytest.mark.parametrize(
    ("tolerance", "strokes"),
    [(Tolerance.both(1.0), 2), (Tolerance(1.0, np.inf), 1), (Tolerance.both(2.0), 2), (Tolerance.both(2.1), 0),
     (Tolerance.both(0.01), 0), (None, 0)],
)  # fmt: skip
def test_the_tolerance_is_marked_on_a_scale_that_reaches_it(result, tolerance, strokes):
    figure = pyplot.figure()
    axis = figure.add_axes((0.1, 0.1, 0.8, 0.8))
    grid = dense(result)[0].grid
    draw_heat(axis, grid, np.zeros(grid.shape), "", 2.0, tolerance)
    marks = [len(c.get_segments()) for c in axis.collections]
    pyplot.close(figure)
    assert sum(marks) == strokes


def test_many_surfaces_stand_in_more_rows_of_three(result):
    some = [m for m in dense(result) if m.variant == "program"]
    figures = []
    maps = [with_um(m, np.linspace(-1.0, 1.0, m.grid.shape[1]) * (1 + k)) for k, m in enumerate(some)]
    again = [replace(m, by=replace(m.by, name="x"), deviation=with_um(m, 9.0).deviation) for m in maps]
    draw_grids(result, [*maps, *again], lambda figure, name, dpi: figures.append(figure))
    boxes = np.round([a.get_position().get_points()[0] for a in figures[0].axes], 6)
    pyplot.close(figures[0])
    assert len(some) == 5
    assert [len(np.unique(boxes[:, k])) for k in (0, 1)] == [3, 4]
    assert len(np.unique(boxes, axis=0)) == 10


def dense(result):
    return [m for m in result.measurements.values() if getattr(m, "inspection", "") == DENSE]


def with_um(m, um):
    return replace(m, deviation=replace(m.deviation, value=1e-3 * np.broadcast_to(um, m.grid.shape)))


def test_what_is_alike_is_drawn_once_and_said(result):
    shown, told = sorted_out(dense(result))
    names = [(m.surface, m.variant) for m in shown]
    assert ("convex", "own pass") in names
    assert ("convex", "program") not in names
    assert told == ["the same to 1 nm, drawn once: convex under program as under own pass, "
                    "concave under program as under own pass"]  # fmt: skip


def test_what_differs_is_drawn_even_where_the_range_is_the_same(result):
    one, other = (m for m in dense(result) if m.surface == "convex" and m.variant in ("own pass", "program"))
    um = np.linspace(-1.0, 1.0, one.grid.shape[1])
    shown, told = sorted_out([with_um(one, um), with_um(other, um[::-1])])
    assert (len(shown), told) == (2, [])
    shown, told = sorted_out([with_um(one, um), with_um(other, um + 0.002)])
    assert (len(shown), told) == (2, [])


def test_a_surface_that_is_not_cut_somewhere_is_not_as_intended(result):
    m = dense(result)[0]
    holes = np.zeros(m.grid.shape)
    assert is_perfect(with_um(m, holes))
    holes[0, 0] = np.nan
    assert not is_perfect(with_um(m, holes))
    assert is_perfect(replace(with_um(m, holes), missing=np.isnan(holes)))
    _, told = sorted_out([with_um(m, holes)])
    assert told == ["grey: there is no machined surface, or it was not measured"]


def test_axes_say_what_they_are(result):
    figures = []
    draw_grids(result, dense(result), lambda figure, name, dpi: figures.append(figure))
    labels = {(a.get_xlabel(), a.get_ylabel()) for a in figures[0].axes}
    pyplot.close(figures[0])
    assert labels == {("toe to heel [mm]", "root to tip [share]"), ("toe to heel [mm]", "across the bottom [share]")}
    gear = gear_of(15, 10.0)
    for flank in (InvoluteFlank(gear, "left"), ReachedFlank(gear, "left", reached=(0.1, 0.6))):
        along, up = flank.ways
        u, v = flank.locate(np.array([0.0, 0.25, 1.0]), np.array([0.0, 0.5, 1.0]))
        assert up.at(np.array([0.0, 0.5, 1.0])) == pytest.approx(np.degrees(u))
        assert along.at(np.array([0.0, 0.25, 1.0])) == pytest.approx(v, abs=1e-2)
        assert ("mm" in along.what, "roll" in up.what) == (True, True)


def test_no_text_lies_over_another(result, texts, tmp_path):
    rows = [with_um(m, 10.0**k) for k, m in enumerate(dense(result)) if not m.surface.endswith("fillet")]
    for shown in (dense(result), rows):
        draw_grids(result, shown, Save(tmp_path))
    assert [pair for page in texts for pair in overlaps(page)] == []


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ([-0.519, -1.2e-6], "−0.519 to 0.000 µm"),
        ([-4490.4, 11727.0], "−4490 to 11727 µm"),
        ([0.0, 0.0], "0.00000 to 0.00000 µm"),
        ([], "nothing cut"),
    ],
)
def test_ranges_have_the_digits_that_matter(values, text):
    assert span(np.array(values)) == text


@pytest.mark.parametrize("shape", [(121, 81), (3, 5), (1, 9)])
def test_maps_are_averaged_as_by_scipy(shape):
    values = np.random.default_rng(1).normal(size=shape)
    values[shape[0] // 2, 0] = np.nan
    wanted = gaussian_filter(values, (shape[0] / 80.0, shape[1] / 40.0), mode="nearest")
    np.testing.assert_allclose(averaged(values), wanted, rtol=0.0, atol=1e-14)
