"""Flat pictures: what a presenter offers to draw, and where it is saved, as PNG and in other formats."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from gearsim.output.wanted import EVERYTHING, Wanted

_PNG_LEVEL = 4  # of zlib's 9: half the time of its usual 6, files a twentieth larger


@dataclass(frozen=True)
class Save:
    """Saves figures into a folder under the name of a PNG file and in more formats, as wanted; then closes them."""

    folder: Path
    wanted: Wanted = EVERYTHING

    def __call__(self, figure: Any, name: str, dpi: float = 100.0) -> None:
        from matplotlib import pyplot

        for file in filter(self.wanted.file, self.wanted.chart_files(name)):
            options = {"pil_kwargs": {"compress_level": _PNG_LEVEL}} if file == name else {}
            figure.savefig(self.folder / file, dpi=dpi, **options)
        pyplot.close(figure)


class Chart(NamedTuple):
    """A picture that can be drawn: the PNG file's name, its caption, and what draws it and hands it to a Save."""

    file: str
    caption: str
    draw: Callable[[Save], None]
