"""Where flat pictures are saved: as PNG, and in other formats where they are wanted."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Save:
    """Saves figures into a folder under the name of a PNG file, and in more ``formats`` beside it; then closes them."""

    folder: Path
    formats: tuple[str, ...] = ()

    def __call__(self, figure: Any, name: str, dpi: float = 100.0) -> None:
        from matplotlib import pyplot

        figure.savefig(self.folder / name, dpi=dpi)
        for ending in self.formats:
            figure.savefig((self.folder / name).with_suffix(f".{ending}"))
        pyplot.close(figure)
