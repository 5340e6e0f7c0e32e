"""LinuxCNC's parameters: numbered and named ones, local to a subroutine or global."""

from __future__ import annotations

from dataclasses import dataclass, field

LOCAL_NUMBERS = 30
LAST_NUMBER = 5000

Key = int | str


@dataclass
class Parameters:
    """Values by number or name. #1 to #30 and names without a leading underscore are local to a subroutine."""

    shared: dict[Key, float] = field(default_factory=dict)
    local: list[dict[Key, float]] = field(default_factory=lambda: [{}])
    _pending: list[tuple[Key, float]] = field(default_factory=list)

    def get(self, key: Key) -> float | None:
        """The value of a parameter; None for a name without one (numbers start at 0)."""
        return self._scope(key).get(key, 0.0 if isinstance(key, int) else None)

    def set_later(self, key: Key, value: float) -> None:
        """Set a parameter once the whole line is read."""
        self._pending.append((key, value))

    def commit(self) -> None:
        """Make the pending settings."""
        for key, value in self._pending:
            self._scope(key)[key] = value
        self._pending.clear()

    def enter(self, arguments: list[float]) -> None:
        """Begin a subroutine: its arguments are #1, #2, ..."""
        self.local.append(dict(enumerate(arguments, 1)))

    def leave(self) -> None:
        """End a subroutine."""
        self.local.pop()

    def _scope(self, key: Key) -> dict[Key, float]:
        local = key <= LOCAL_NUMBERS if isinstance(key, int) else not key.startswith("_")
        return self.local[-1] if local else self.shared
