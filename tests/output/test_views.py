import numpy as np
import pytest

from gearsim.output.view import add_legend, aim, plotter_with

POINTS = np.random.default_rng(3).uniform(size=(200, 3)) * [40.0, 8.0, 3.0]


@pytest.fixture
def plotter():
    view = plotter_with()
    yield view
    view.close()


def seen(plotter, points):
    """Places in the view, from -1 to 1 across and up."""
    camera, (width, height) = plotter.camera, plotter.renderer.GetSize()
    toward = np.subtract(camera.position, camera.focal_point)
    toward /= np.linalg.norm(toward)
    right = np.cross(camera.up, toward)
    offset = points - np.array(camera.focal_point)
    half = camera.parallel_scale
    return np.stack([offset @ right / (half * width / height), offset @ np.cross(toward, right) / half], axis=1)


@pytest.mark.parametrize("way", [(1.0, 0.2, 0.4), (0.1, -1.0, 0.3), (0.3, 0.3, 2.0)])
def test_everything_is_in_the_view_above_its_foot(plotter, way):
    aim(plotter, POINTS, way, (0.0, 0.0, 1.0), "text", foot=0.3)
    places = seen(plotter, POINTS)
    assert np.abs(places).max() < 1.0
    assert places[:, 1].min() > -1.0 + 2.0 * 0.3
    assert np.ptp(places, axis=0).max() > 1.1  # and fills it


def test_what_does_not_exist_is_not_looked_at(plotter):
    holes = np.vstack([POINTS, np.full((3, 3), np.nan)])
    aim(plotter, holes, (1.0, 0.2, 0.4), (0.0, 0.0, 1.0), "text")
    assert np.isfinite(seen(plotter, POINTS)).all()


def test_the_scale_bar_is_as_long_as_it_says(plotter):
    aim(plotter, POINTS, (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), "text")
    flat = [prop for prop in plotter.renderer.GetViewProps() if prop.GetClassName() == "vtkActor2D"]
    low, high = flat[0].GetMapper().GetInput().GetBounds()[:2]
    texts = [p.GetInput() for p in plotter.renderer.GetViewProps() if hasattr(p, "GetInput") and p.GetInput()]
    told = next(float(text.split()[0]) for text in texts if text.endswith(" mm"))
    (left, _), (right, _) = seen(plotter, np.array([[0.0, 0.0, 0.0], [told, 0.0, 0.0]]))
    assert high - low == pytest.approx(0.5 * (right - left), abs=0.004)  # its ends are strokes


def test_a_long_legend_asks_for_room(plotter):
    short, long = add_legend(plotter, {"a": "red"}), add_legend(plotter, dict.fromkeys("abcdefgh", "black"))
    assert long > 8 * 0.03 > short
