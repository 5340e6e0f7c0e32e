"""Flat pictures: what a presenter offers to draw, and where it is saved, as PNG and in other formats."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from gearsim.output.png import write_png
from gearsim.output.wanted import EVERYTHING, Wanted


@dataclass(frozen=True)
class Save:
    """Saves figures into a folder under the name of a PNG file and in more formats, as wanted; then closes them."""

    folder: Path
    wanted: Wanted = EVERYTHING

    def __call__(self, figure: Any, name: str, dpi: float = 100.0) -> None:
        from matplotlib import pyplot

        for file in filter(self.wanted.file, self.wanted.chart_files(name)):
            if file == name:
                draw_png(figure, self.folder / file, dpi)
            else:
                figure.savefig(self.folder / file, dpi=dpi)
        pyplot.close(figure)


def draw_png(figure: Any, file: Path, dpi: float) -> None:
    """Draw a figure on an opaque page."""
    figure.set_dpi(dpi)
    figure.canvas.draw()
    write_png(np.asarray(figure.canvas.buffer_rgba())[..., :3], file)


class Chart(NamedTuple):
    """A picture that can be drawn: the PNG file's name, its caption, and what draws it and hands it to a Save."""

    file: str
    caption: str
    draw: Callable[[Save], None]
