"""Which of a run's files are wanted."""

from __future__ import annotations

from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import PurePath

_OPEN_ENDS = ("*", "?", "]")  # a pattern that ends so may be a picture's name


@dataclass(frozen=True)
class Wanted:
    """What to write: pictures or none, charts in which ``formats`` beside PNG (svg, pdf), and which files.

    ``only``: names or patterns (``*``, ``?``, ``[...]``) of the files to write, all where it is empty.
    """

    pictures: bool = True
    formats: tuple[str, ...] = ()
    only: tuple[str, ...] = ()

    def file(self, name: str) -> bool:
        """Whether the file of this name is wanted."""
        return not self.only or any(fnmatchcase(name, pattern) for pattern in self.only)

    def chart_files(self, chart: str) -> list[str]:
        """All names a chart has, by the name of its PNG file: one a format."""
        return [chart, *(str(PurePath(chart).with_suffix(f".{ending}")) for ending in self.formats)]

    def chart(self, chart: str) -> bool:
        """Whether a chart is wanted in any format, by the name of its PNG file."""
        return any(map(self.file, self.chart_files(chart)))

    def may_want_charts(self, others: tuple[str, ...]) -> bool:
        """Whether a chart could be among the wanted files; ``others`` are names that are no chart's."""
        endings = (".png", *(f".{ending}" for ending in self.formats), *_OPEN_ENDS)
        return not self.only or any(p.endswith(endings) and p not in others for p in self.only)


EVERYTHING = Wanted()
