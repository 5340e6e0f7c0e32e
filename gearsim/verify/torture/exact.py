"""The tool's distance in 40 digits, for what lies near the noise of float64: from the profile's and table's numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.element import Element
from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.motion.segments import SegmentTable

DIGITS = 40
_GRID = 2000
_LOWS = 2
_STEPS = 40

Point = Sequence[Any]


def _mp() -> Any:
    try:
        from mpmath import mp
    except ImportError:
        raise InputError("40 digits need mpmath: pip install gearsim[dev]") from None
    mp.dps = DIGITS
    return mp


def section_distance(cutter: Profile, r: Any, z: Any) -> Any:
    """Signed distance [mm] of (r, z) to the nearest element, negative inside the tool."""
    mp = _mp()
    found = [_to_element(mp, e, r, z) for e in cutter.elements]
    least = min(gap for gap, _ in found)
    _, side = max((f for f in found if f[0] <= least + mp.mpf(10) ** -30), key=lambda f: abs(f[1]))
    return least if side > 0 else -least


def _to_element(mp: Any, e: Element, r: Any, z: Any) -> tuple[Any, Any]:
    """Distance to an element, and how far the point lies on its outer side."""
    (r0, z0), (r1, z1) = ([mp.mpf(float(c)) for c in p] for p in (e.start, e.end))
    if not e.is_arc:
        length = mp.hypot(r1 - r0, z1 - z0)
        tr, tz = (r1 - r0) / length, (z1 - z0) / length
        s = min(max((r - r0) * tr + (z - z0) * tz, mp.mpf(0)), length)
        dr, dz = r - r0 - s * tr, z - z0 - s * tz
        return mp.hypot(dr, dz), dr * tz - dz * tr
    rc, zc, radius = (mp.mpf(float(c)) for c in (*e.centre, e.radius))
    dr, dz = r - rc, z - zc
    size = mp.hypot(dr, dz)
    if size > 0 and (r0 - rc) * dz - (z0 - zc) * dr >= 0 and dr * (z1 - zc) - dz * (r1 - rc) >= 0:
        return abs(size - radius), size - radius
    ends = [(mp.hypot(r - a, z - b), (r - a) * (a - rc) + (z - b) * (b - zc)) for a, b in ((r0, z0), (r1, z1))]
    gap, along = min(ends, key=lambda end: end[0])
    return gap, along / radius


def distance(cutter: Profile, table: SegmentTable, row: int, origin: Point, direction: Point, x: Any, tau: Any) -> Any:
    """Signed distance [mm] of a ray's point to the tool at x of a row of the table."""
    mp = _mp()
    x, tau = mp.mpf(x), mp.mpf(tau)
    tip, axis = ([_horner(mp, c[row, :, i], x) for i in range(3)] for c in (table.tip, table.axis))
    size = mp.sqrt(sum(a * a for a in axis))
    q = [mp.mpf(float(o)) + tau * mp.mpf(float(d)) - t for o, d, t in zip(origin, direction, tip, strict=True)]
    z = sum(a * b for a, b in zip(q, axis, strict=True)) / size
    r = mp.sqrt(sum((a - z * b / size) ** 2 for a, b in zip(q, axis, strict=True)))
    return section_distance(cutter, r, z)


def least_distance(cutter: Profile, table: SegmentTable, origin: Point, direction: Point, tau: float) -> Any:
    """Least distance [mm] of a ray's point over all rows: a grid of poses, then golden sections around its lowest."""
    x = np.linspace(-1.0, 1.0, _GRID + 1)
    powers = np.vander(x, 6, increasing=True)
    point = np.asarray(origin) + tau * np.asarray(direction)
    found = []
    for row in range(len(table)):
        q, axis = point - powers @ table.tip[row], powers @ table.axis[row]
        z = (q * axis).sum(axis=1)
        f = cutter.signed_distance(np.linalg.norm(q - z[:, None] * axis, axis=1), z)
        around = np.concatenate([[np.inf], f, [np.inf]])
        lows = np.flatnonzero((f <= around[:-2]) & (f <= around[2:]))
        for k in lows[np.argsort(f[lows])[:_LOWS]]:
            ends = x[max(k - 1, 0)], x[min(k + 1, _GRID)]
            found.append(_golden(partial(distance, cutter, table, row, origin, direction, tau=tau), *ends))
    return min(found)


def _golden(f: Callable[[Any], Any], start: float, end: float) -> Any:
    mp = _mp()
    a, b, g = mp.mpf(start), mp.mpf(end), (mp.sqrt(5) - 1) / 2
    c, d = b - g * (b - a), a + g * (b - a)
    fc, fd, ends = f(c), f(d), min(f(a), f(b))
    for _ in range(_STEPS):
        if fc < fd:
            b, d, fd = d, c, fc
            c = b - g * (b - a)
            fc = f(c)
        else:
            a, c, fc = c, d, fd
            d = a + g * (b - a)
            fd = f(d)
    return min(fc, fd, ends)


def _horner(mp: Any, coefficients: NDArray, x: Any) -> Any:
    value = mp.mpf(0)
    for c in reversed(coefficients):
        value = value * x + mp.mpf(float(c))
    return value
