"""Who is told how far a study is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol


class StudyProgress(Protocol):
    """Told of a study's jobs; the silent default does nothing."""

    def begin(self, jobs: int, kept: int) -> None:
        """A study of so many jobs begins, of which some are kept from before."""

    def advance(self, jobs: int, verdicts: Mapping[str, int]) -> None:
        """More jobs are done and kept, with such verdicts."""

    def tell(self, text: str) -> None:
        """What is waited for; empty: nothing is."""


class Silent:
    """Tells nobody."""

    def begin(self, jobs: int, kept: int) -> None:
        pass

    def advance(self, jobs: int, verdicts: Mapping[str, int]) -> None:
        pass

    def tell(self, text: str) -> None:
        pass
