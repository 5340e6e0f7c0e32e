import numpy as np
import pytest
from matplotlib.image import imread

from gearsim.output.png import write_png


@pytest.mark.parametrize("shape", [(1, 1, 3), (7, 5, 3), (300, 401, 3)])
def test_another_reader_sees_the_same_pixels(tmp_path, shape):
    pixels = np.random.default_rng(1).integers(0, 256, shape, dtype=np.uint8)
    write_png(pixels, tmp_path / "a.png")
    write_png(pixels[::-1], tmp_path / "b.png")
    assert np.array_equal(np.round(255.0 * imread(tmp_path / "a.png")), pixels)
    assert np.array_equal(np.round(255.0 * imread(tmp_path / "b.png")), pixels[::-1])


def test_a_folder_that_is_not_there_is_an_error(tmp_path):
    with pytest.raises(OSError, match="missing"):
        write_png(np.zeros((2, 2, 3), dtype=np.uint8), tmp_path / "missing" / "a.png")
