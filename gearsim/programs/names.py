"""Names of a program's operations: each one its own."""

from __future__ import annotations

from collections.abc import Sequence


def distinct(names: Sequence[str]) -> tuple[str, ...]:
    """The names in their order, one that was given before with its number behind it: ``SLOTS``, ``SLOTS (2)``."""
    taken, times, found = set(names), dict.fromkeys(names, 0), []
    for name in names:
        times[name] += 1
        own = name
        while times[name] > 1 and own in taken:
            own = f"{name} ({times[name]})"
            times[name] += own in taken
        taken.add(own)
        found.append(own)
    return tuple(found)
