"""Flat pictures: what a presenter offers to draw, and where it is saved, as PNG and in other formats."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from gearsim.output.wanted import EVERYTHING, Wanted

_PNG_LEVEL = 3  # of zlib's 9: half the time of its usual 6, files a tenth larger


@dataclass(frozen=True)
class Save:
    """Saves figures into a folder under the name of a PNG file and in more formats, as wanted; then closes them."""

    folder: Path
    wanted: Wanted = EVERYTHING

    def __call__(self, figure: Any, name: str, dpi: float = 100.0) -> None:
        from matplotlib import pyplot

        for file in filter(self.wanted.file, self.wanted.chart_files(name)):
            if file == name:
                write_png(figure, self.folder / file, dpi)
            else:
                figure.savefig(self.folder / file, dpi=dpi)
        pyplot.close(figure)


def write_png(figure: Any, file: Path, dpi: float) -> None:
    """Draw a figure on an opaque page: three channels are written faster than four."""
    from PIL import Image

    figure.set_dpi(dpi)
    figure.canvas.draw()
    pixels = np.asarray(figure.canvas.buffer_rgba())[..., :3]
    Image.fromarray(np.ascontiguousarray(pixels)).save(file, compress_level=_PNG_LEVEL)


class Chart(NamedTuple):
    """A picture that can be drawn: the PNG file's name, its caption, and what draws it and hands it to a Save."""

    file: str
    caption: str
    draw: Callable[[Save], None]
