import numpy as np
import pytest
from PIL import Image

from gearsim.output.animation import Frame, write_animation
from gearsim.output.colours import STEEL, class_colours, diverging, rgb
from gearsim.output.shapes import Classes, Shape, Values

PLATE = np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0]])
BOTH = np.array([[0, 1, 2], [0, 2, 3]])


def plate(share, um=9.0):
    colours = {"deviation": Values(np.full(4, um), -5.0, 5.0, "um"),
               "operation": Classes(np.array([0, 1]), ("rough", "finish"))}  # fmt: skip
    return Shape("plate", PLATE * [share, 1.0, 1.0], BOTH, colours)


def shares(file, colour):
    """Of every frame, the share of pixels of a colour in about any light, and how long it stays [ms]."""
    picture = Image.open(file)
    for k in range(picture.n_frames):
        picture.seek(k)
        pixels = np.asarray(picture.convert("RGB"), dtype=float) / 255.0
        length = np.linalg.norm(pixels, axis=-1)
        along = pixels @ np.array(colour) / np.linalg.norm(colour)
        yield float(((along > 0.995 * length) & (length > 0.1) & (length < 1.6)).mean()), picture.info["duration"]


@pytest.mark.parametrize(
    ("colouring", "colour"),
    [
        ("deviation", diverging(np.array([1.0]))[0]),
        ("operation", rgb(class_colours(("rough", "finish"))[1])),
        ("", rgb(STEEL)),
    ],
)
def test_frames_show_what_is_left_under_one_look(tmp_path, colouring, colour):
    file = tmp_path / "cut.webp"
    frames = (Frame([plate(share)], f"{share:.0%} left") for share in (1.0, 0.5, 0.25))
    assert write_animation(frames, file, colouring, way=(0.0, 0.0, 1.0), up=(0.0, 1.0, 0.0)) == 3
    (whole, first), (half, _), (quarter, last) = shares(file, colour)
    assert (first, last) == (100, 2000)
    assert whole > 0.05
    assert [half / whole, quarter / whole] == pytest.approx([0.5, 0.25], abs=0.06)


def test_no_frames_are_no_animation(tmp_path):
    with pytest.raises(ValueError, match="at least one frame"):
        write_animation([], tmp_path / "cut.webp")
