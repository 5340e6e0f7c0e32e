import numpy as np
import pytest
from matplotlib import colormaps

from gearsim.output.canvas import Canvas, add_map, add_mesh
from gearsim.output.colours import DIVERGING, EXCESS, OVERCUT, diverging, rgb
from gearsim.output.draw_swept import _close_to, tool_skin
from gearsim.output.meshes import joined, points_of, quads, segments, values_of
from gearsim.output.slot import from_tip_to_tip, machined, seams
from gearsim.output.view import Look, add_legend, aim, aim_alike

POINTS = np.random.default_rng(3).uniform(size=(200, 3)) * [40.0, 8.0, 3.0]
SQUARE = np.stack([*np.meshgrid([0.0, 1.0, 2.0], [0.0, 1.0]), np.zeros((2, 3))], axis=-1)


@pytest.fixture
def canvas():
    return Canvas()


@pytest.fixture
def view(canvas):
    return canvas.views()[0]


def seen(view, points):
    """Places in the view, from -1 to 1 across and up."""
    camera, (width, height) = view.GetActiveCamera(), view.GetSize()
    toward = np.subtract(camera.GetPosition(), camera.GetFocalPoint())
    toward /= np.linalg.norm(toward)
    right = np.cross(camera.GetViewUp(), toward)
    offset = points - np.array(camera.GetFocalPoint())
    half = camera.GetParallelScale()
    return np.stack([offset @ right / (half * width / height), offset @ np.cross(toward, right) / half], axis=1)


def picture(canvas, file):
    from matplotlib.image import imread

    canvas.save(file)
    return imread(file)[..., :3]


@pytest.mark.parametrize("way", [(1.0, 0.2, 0.4), (0.1, -1.0, 0.3), (0.3, 0.3, 2.0)])
def test_everything_is_in_the_view_above_its_foot(view, way):
    aim(view, POINTS, way, (0.0, 0.0, 1.0), "text", foot=0.3)
    places = seen(view, POINTS)
    assert np.abs(places).max() < 1.0
    assert places[:, 1].min() > -1.0 + 2.0 * 0.3
    assert np.ptp(places, axis=0).max() > 1.1  # and fills it


def test_views_side_by_side_have_one_scale(canvas):
    views = canvas.views(2)
    looks = [Look(v, f * POINTS, (1.0, 0.2, 0.4), (0.0, 0.0, 1.0), "") for v, f in zip(views, (1.0, 0.3), strict=True)]
    aim_alike(looks)
    one, other = (v.GetActiveCamera().GetParallelScale() for v in views)
    assert one == other
    assert np.ptp(seen(views[0], POINTS), axis=0).max() > 1.1
    assert np.abs(seen(views[1], 0.3 * POINTS)).max() < 1.0


def test_of_a_tool_that_dwarfs_its_cut_the_part_about_it_is_shown():
    outline = np.array([[100.0, 0.0], [101.0, 0.0], [101.0, 5.0], [100.0, 5.0]])
    tool = tool_skin(outline, np.zeros(3), np.array([0.0, 0.0, 1.0]))
    cut = np.array([100.0, 0.0, 0.0]) + POINTS
    part = points_of(_close_to(cut, tool))
    assert 0 < len(part) < 0.3 * len(points_of(tool))
    assert np.linalg.norm(part - cut.mean(axis=0), axis=1).max() < 40.0
    assert _close_to(10.0 * cut, tool) is tool


def test_seams_join_patches_row_to_row_whichever_way_they_lie():
    rows = np.linspace(0.0, 1.0, 4)
    patch = np.stack([*np.meshgrid(np.linspace(0.0, 3.0, 5), rows), np.zeros((4, 5))], axis=-1)
    above, below = (np.add(patch, [0.0, y, 0.0]) for y in (1.1, -1.2))
    ordered = from_tip_to_tip([above, patch[::-1], below])
    assert [np.diff(p[:2, 0, 1])[0] < 0.0 for p in ordered] == [True] * 3
    upper, lower = seams(ordered)
    assert sorted(set(points_of(upper)[:, 1])) == pytest.approx([1.0, 1.1])
    assert sorted(set(points_of(lower)[:, 1])) == pytest.approx([-0.2, 0.0])
    data = {"patch:a:point": patch, "patch:a:normal": 0.0 * patch + [0.0, 0.0, 1.0],
            "patch:a:deviation_um": np.where(patch[..., 0] > 2.9, np.nan, 2.0)}  # fmt: skip
    assert np.unique(machined(data, "a")[..., 2]) == pytest.approx([0.0, 2e-3])


def test_what_does_not_exist_is_not_looked_at(view):
    holes = np.vstack([POINTS, np.full((3, 3), np.nan)])
    aim(view, holes, (1.0, 0.2, 0.4), (0.0, 0.0, 1.0), "text")
    assert np.isfinite(seen(view, POINTS)).all()


def test_the_scale_bar_is_as_long_as_it_says(view):
    aim(view, POINTS, (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), "text")
    flat = [prop for prop in view.GetViewProps() if prop.GetClassName() == "vtkActor2D"]
    low, high = flat[0].GetMapper().GetInput().GetBounds()[:2]
    texts = [p.GetInput() for p in view.GetViewProps() if hasattr(p, "GetInput") and p.GetInput()]
    told = next(float(text.split()[0]) for text in texts if text.endswith(" mm"))
    (left, _), (right, _) = seen(view, np.array([[0.0, 0.0, 0.0], [told, 0.0, 0.0]]))
    assert high - low == pytest.approx(0.5 * (right - left), abs=0.004)  # its ends are strokes


def test_a_long_legend_asks_for_room(view):
    short, long = add_legend(view, {"a": "#ff0000"}), add_legend(view, dict.fromkeys("abcdefgh", "#000000"))
    assert long > 8 * 0.03 > short


def test_our_colours_are_those_of_the_charts():
    shares = np.linspace(-1.0, 1.0, 256)
    assert np.abs(diverging(shares) - colormaps[DIVERGING](np.linspace(0.0, 1.0, 256))[:, :3]).max() < 1.0 / 255.0
    assert diverging(np.array([-0.8, 0.8])) == pytest.approx(np.array([rgb(OVERCUT), rgb(EXCESS)]))


def test_a_mesh_holds_the_quads_that_exist_and_their_values():
    holed = SQUARE.copy()
    holed[1, 2] = np.nan
    shape = quads(holed, {"um": np.arange(6.0).reshape(2, 3)})
    assert shape.GetNumberOfPolys() == 1
    np.testing.assert_array_equal(values_of(shape, "um"), [0.0, 1.0, 3.0, 4.0])
    both = joined([shape, quads(SQUARE, {"um": np.zeros((2, 3)), "other": np.zeros((2, 3))})])
    assert (both.GetNumberOfPolys(), len(points_of(both))) == (3, 10)
    assert len(values_of(both, "um")) == 10
    assert both.GetPointData().GetArray("other") is None


def test_a_map_shows_overcut_excess_and_what_is_missing_in_their_colours(canvas, tmp_path):
    (view,) = canvas.views()
    um = np.array([[-5.0, np.nan, 9.0]] * 2)
    for k, value in enumerate(um[0]):
        patch = SQUARE[:, :2] + np.array([1.0 * k, 0.0, 0.0])
        add_map(view, quads(patch, {"um": np.full((2, 2), value)}), "um", 5.0, ambient=1.0, diffuse=0.0)
    aim(view, SQUARE + np.array([0.5, 0.0, 0.0]), (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), "")
    shown = picture(canvas, tmp_path / "map.png")
    for colour in (*diverging(np.array([-1.0, 1.0])), (0.0, 0.0, 0.0)):
        assert (np.abs(shown - colour).max(axis=-1) < 0.01).mean() > 0.02


def test_one_canvas_draws_page_after_page_each_from_white(canvas, tmp_path):
    for count, name in ((1, "one.png"), (2, "two.png"), (1, "three.png")):
        for view in canvas.views(count):
            line = segments(np.zeros((1, 3)), np.array([[count, 1.0, 0.0]]))
            add_mesh(view, line, "#00ff00" if count == 1 else "#ff0000", ambient=1.0, diffuse=0.0, width=5.0)
            aim(view, SQUARE, (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), "")
        shown = picture(canvas, tmp_path / name)
        green, red = (shown[..., 1] - shown[..., 0] > 0.5).any(), (shown[..., 0] - shown[..., 1] > 0.5).any()
        assert (green, red) == (count == 1, count == 2)
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "three.png").read_bytes()
