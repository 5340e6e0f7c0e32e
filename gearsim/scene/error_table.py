"""Tables of errors: numbers that are zero where nothing is wrong."""

from __future__ import annotations

from typing import ClassVar

from gearsim.scene.tables import Table


class ErrorTable(Table):
    """Errors as numbers, by the names of their keys; ``conditions`` are keys that alone are no error."""

    conditions: ClassVar[frozenset[str]] = frozenset()

    def acting(self, above: str = "") -> list[str]:
        """The errors that are not zero, as text: dotted key and value."""
        found: list[str] = []
        for key in type(self).model_fields:
            value = getattr(self, key)
            if isinstance(value, ErrorTable):
                found += value.acting(f"{above}{key}.")
            elif key in self.conditions:
                continue
            elif isinstance(value, tuple) and any(value):
                found.append(f"{above}{key} = [{', '.join(f'{v:g}' for v in value)}]")
            elif value and not isinstance(value, tuple):
                found.append(f"{above}{key} = {value:g}")
        return found
