"""How many passes or points a step makes: a step that would make too many is refused, not tried."""

from __future__ import annotations

from gearsim.errors import InputError

MOST = 100_000
MOST_POINTS = 2_000_000


def check_points(count: float) -> None:
    """Raise InputError where a path has more than two million points."""
    if not count <= MOST_POINTS:
        raise InputError(
            f"the path would have {count:.3g} points, of which {MOST_POINTS:.2g} are handled; make stepover or chord "
            "larger, or begin with fewer points a pass"
        )


def check_count(length: float, step: float, unit: str = "mm", what: str = "a step") -> None:
    """Raise InputError where a length is more than 100,000 steps long; both in ``unit``, ``what`` the step is."""
    if not length <= MOST * step:
        raise InputError(
            f"{what} of {step:g} {unit} over {length:.4g} {unit} makes more than {MOST} passes or points; wanted is a "
            f"step of at least {length / MOST:.2g} {unit}"
        )
