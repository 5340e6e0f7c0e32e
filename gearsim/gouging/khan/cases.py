"""How the principal curvatures of tool and part interleave: Khan's six cases (6.1.1-6.1.6) and the seventh.

Four numbers in two ordered pairs interleave in six ways; Khan splits one by the sign (cases 1 and 2) and misses
ks1 > kt1 >= ks2 > kt2, which always gouges. At equality his conditions overlap: here each belongs to the case that
needs no look at directions. By Weyl's inequality the tool is free only if kt1 >= ks1 and kt2 >= ks2, so that
cases 3, 4, 5 and 7 gouge whatever the angle between the principal directions (after (6.23) he says so of 6 too).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray


class Case(NamedTuple):
    number: int
    condition: str
    outcome: str
    source: str


CASES: dict[int, Case] = {
    c.number: c
    for c in (
        Case(1, "kt1 >= kt2 >= 0 >= ks1 >= ks2", "never gouges: the part is convex", "Khan (6.18)"),
        Case(2, "kt1 >= kt2 >= ks1 >= ks2", "never gouges", "Khan (6.19)"),
        Case(3, "ks1 >= ks2 > kt1 >= kt2", "gouges in all directions", "Khan (6.20)"),
        Case(4, "ks1 > kt1 >= kt2 >= ks2", "gouges in some directions", "Khan (6.21), 6.1.4"),
        Case(5, "kt1 >= ks1 >= ks2 > kt2", "gouges in some directions", "Khan (6.21), 6.1.5"),
        Case(6, "kt1 >= ks1 > kt2 >= ks2", "may gouge: the directions decide", "Khan (6.22)"),
        Case(7, "ks1 > kt1 >= ks2 > kt2", "gouges in some directions", "missing in Khan"),
    )
}


def case_numbers(kt1: ArrayLike, kt2: ArrayLike, ks1: ArrayLike, ks2: ArrayLike) -> NDArray:
    """Numbers of the cases, shape (...), for principal curvatures [1/mm] of tool (kt1 >= kt2) and part (ks1 >= ks2)."""
    t1, t2, s1, s2 = (np.asarray(k, dtype=float) for k in (kt1, kt2, ks1, ks2))
    above = t2 >= s1
    first, second = t1 >= s1, t2 >= s2
    return np.select(
        [above & (s1 <= 0.0) & (t2 >= 0.0), above, first & second, first, second, t1 >= s2],
        [1, 2, 6, 5, 4, 7],
        default=3,
    )
