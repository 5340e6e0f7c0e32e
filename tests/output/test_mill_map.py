from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib import pyplot

from gearsim.gouging.choice import SizeChoice
from gearsim.output.gouging.mill_map import draw_sizes, label_places, regions

NAN = np.nan


def choice(shank, corner):
    shank, corner = (np.asarray(x, dtype=float) for x in (shank, corner))
    rows, columns = shank.shape
    grid = SimpleNamespace(length=np.linspace(0.0, 1.0, columns), height=np.linspace(0.0, 1.0, rows))
    return SizeChoice(grid, shank, corner, np.empty((0, 2)), None, ())


def drawn(sizes):
    """The texts on the map."""
    kept = []
    draw_sizes(sizes, "title", ["a note"], "a.png", lambda figure, name: kept.append(figure))
    texts = [t.get_text() for t in kept[0].axes[0].texts]
    title = kept[0].axes[0].get_title(loc="left")
    pyplot.close(kept[0])
    return title, sorted(texts)


def test_a_number_and_its_box_lie_within_its_region():
    index = np.zeros((60, 80), dtype=int)
    index[20:41] = 1
    index[:20, 60:] = 2
    index[50:, 10:14] = 3  # too narrow for its number
    index[45:, 70:] = -1  # no mill fits
    places = label_places(index, (9, 15))
    assert sorted(index[i, j] for i, j in places) == [0, 0, 1, 2]
    for i, j in places:
        assert np.all(index[i - 4 : i + 5, j - 7 : j + 8] == index[i, j])


def test_a_region_without_room_has_no_number():
    assert label_places(np.arange(400).reshape(20, 20), (3, 3)) == []
    assert label_places(np.full((20, 20), -1), (3, 3)) == []


def test_regions_are_the_mills_that_are_largest_somewhere():
    mills, index = regions(choice([[12, 12], [20, NAN]], [[2, 6], [2, NAN]]))
    assert mills.tolist() == [[12.0, 2.0], [12.0, 6.0], [20.0, 2.0]]
    assert index.tolist() == [[0, 1], [2, -1]]


@pytest.mark.parametrize(
    ("shank", "corner", "title", "texts"),
    [
        ([[12, 20], [12, 20]], [[12, 20], [12, 20]], "R = r of the ball end mill", ["12", "20"]),
        ([[30, 30], [30, 30]], [[5, 5], [14.1, 14.1]], "R = 30 mm; numbers: corner radius r", ["14.1", "5"]),
        ([[30, 30], [25, 25]], [[5, 5], [5, 2]], "R, r [mm]; colours: R", ["25, 2", "25, 5", "30, 5"]),
        ([[8, NAN], [8, NAN]], [[8, NAN], [8, NAN]], "ball end mill", ["8", "grey: none fits"]),
    ],
)
def test_numbers_tell_the_radii_that_vary(shank, corner, title, texts):
    told, numbers = drawn(choice(shank, corner))
    assert title in told
    assert numbers == texts


@pytest.mark.parametrize(
    ("mill", "sentence"),
    [((30, 5), "at every point of the surface the same is the largest: R = 30 mm, r = 5 mm"),
     ((NAN, NAN), "at no point of the surface a mill of the catalogue fits")],
)  # fmt: skip
def test_an_answer_that_is_everywhere_the_same_is_a_sentence(mill, sentence):
    kept = []
    sizes = choice(*(np.full((2, 2), x) for x in mill))
    draw_sizes(sizes, "title", ["a note"], "a.png", lambda figure, name: kept.append(figure))
    texts = [t.get_text() for t in kept[0].texts]
    pyplot.close(kept[0])
    assert kept[0].axes == []
    assert texts == ["title", f"a note\n{sentence}"]
