"""Chance for the programs: built on ``random()`` alone, whose sequence Python keeps from version to version."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import TypeVar

T = TypeVar("T")


class Dice:
    """Draws numbers and choices."""

    def __init__(self, seed: int):
        self._random = random.Random(seed)

    def chance(self, probability: float) -> bool:
        """True with a probability."""
        return self._random.random() < probability

    def between(self, low: float, high: float) -> float:
        """A number between two."""
        return low + (high - low) * self._random.random()

    def whole(self, low: int, high: int) -> int:
        """A whole number from ``low`` to ``high``."""
        return low + int((high - low + 1) * self._random.random())

    def pick(self, choices: Sequence[T]) -> T:
        """One of the choices."""
        return choices[int(len(choices) * self._random.random())]

    def some(self, choices: Sequence[T], at_least: int = 0) -> list[T]:
        """Some of the choices, each once, in any order."""
        left, found = list(choices), []
        for _ in range(self.whole(at_least, len(left))):
            found.append(left.pop(int(len(left) * self._random.random())))
        return found

    def shuffled(self, choices: Sequence[T]) -> list[T]:
        """All choices in any order."""
        return self.some(choices, len(choices))

    def length(self) -> float:
        """A coordinate: round, or with some decimals."""
        return round(self.between(-50.0, 50.0), self.pick((0, 0, 1, 3)))
