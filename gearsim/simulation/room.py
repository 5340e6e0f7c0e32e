"""How much memory there is, and jobs that would need more: refused with the number before anything is made."""

from __future__ import annotations

import os
from math import inf

from gearsim.errors import InputError

RAY_BYTES = 450  # of a ray asked for, with what is found along it: measured


def memory_bytes() -> float:
    """The machine's memory, or less where this process may not use all of it; infinite where it cannot be asked."""
    if os.name != "posix":
        return inf
    import resource

    machine = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    allowed = resource.getrlimit(resource.RLIMIT_AS)[0]
    return machine if allowed == resource.RLIM_INFINITY else min(machine, allowed)


def require_room(rays: float, what: str, remedy: str) -> None:
    """Raise InputError where ``rays`` rays, made by ``what``, need more memory than there is."""
    require_bytes(RAY_BYTES * rays, f"{what} makes {rays:.3g} rays, which need", remedy)


def require_bytes(needed: float, what_needs: str, remedy: str) -> None:
    """Raise InputError where something needs more memory [bytes] than there is; ``what_needs`` ends in the verb."""
    there = memory_bytes()
    if not needed <= there:
        raise InputError(f"{what_needs} about {1e-9 * needed:.3g} GB; this machine has {1e-9 * there:.3g} GB: {remedy}")
