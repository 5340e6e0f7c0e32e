"""How many passes or points a step makes: a step that would make too many is refused, not tried."""

from __future__ import annotations

from gearsim.errors import InputError

MOST = 100_000


def check_count(length: float, step: float, unit: str = "mm") -> None:
    """Raise InputError where a length is more than 100,000 steps long; both in ``unit``."""
    if not length <= MOST * step:
        raise InputError(
            f"a step of {step:g} {unit} over {length:.4g} {unit} makes more than {MOST} passes or points; wanted is a "
            f"step of at least {length / MOST:.2g} {unit}"
        )
