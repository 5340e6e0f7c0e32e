"""Crossings of rays with the closed-form classes of a machined surface."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Kind(IntEnum):
    """The closed-form classes of the machined surface."""

    ENVELOPE = 1
    JOINT = 2
    PATH_END = 3
    EDGE = 4


class Crossings(NamedTuple):
    """Candidate crossings, each field of shape (n,): ray index, parameter [mm], class, piece and t.

    ``element``, ``s`` [mm] and ``branch`` locate an ENVELOPE point on the profile; they are -1, nan and 0
    for the other classes.
    """

    ray: NDArray
    tau: NDArray
    kind: NDArray
    piece: NDArray
    t: NDArray
    element: NDArray
    s: NDArray
    branch: NDArray


def together(parts: list[Crossings]) -> Crossings:
    """Crossings one after the other."""
    none = Crossings(*(np.empty(0, dtype=k) for k in (int, float, int, int, float, int, float, float)))
    return Crossings(*(np.concatenate(column) for column in zip(none, *parts, strict=True)))
