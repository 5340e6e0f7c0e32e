"""The last few things that were made, for whoever needs one of them again."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from threading import Lock
from typing import Generic, TypeVar

V = TypeVar("V")


class Kept(Generic[V]):
    """So many things by their keys, the oldest dropped first. Threads may share it: a worker plans in several."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._made: dict[Hashable, V] = {}
        self._lock = Lock()

    def get(self, key: Hashable, make: Callable[[], V]) -> V:
        """The thing of a key, made if it is not kept. Threads that want it at once may each make it; one is kept."""
        with self._lock:
            if key in self._made:
                return self._made[key]
        made = make()
        with self._lock:
            found = self._made.setdefault(key, made)
            if len(self._made) > self._most:
                del self._made[next(iter(self._made))]
        return found
