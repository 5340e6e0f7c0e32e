"""Where a distance along rays changes its sign: brackets that miss no chord, and the roots in them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

_HALVINGS = 14
_ZERO = 1e-11


def sign_changes(
    distance: Callable[[NDArray, NDArray], NDArray], row: NDArray, a: NDArray, b: NDArray, fa: NDArray, fb: NDArray
) -> tuple[NDArray, ...]:
    """Stretches of the rays in which the distance changes its sign: (row, a, b, f(a), f(b)).

    The distance changes by no more than the way along the ray: between ends of one sign a short chord can
    hide only where both distances together are below the stretch's length; such stretches are halved.
    """
    live: tuple[NDArray, ...] = (row, a, b, fa, fb)
    found: list[tuple[NDArray, ...]] = []
    for _ in range(_HALVINGS):
        row, a, b, fa, fb = live
        crosses = (fa > 0.0) != (fb > 0.0)
        found.append(tuple(c[crosses] for c in live))
        apart = np.abs(fa) + np.abs(fb)
        hides = ~crosses & (apart < b - a) & (apart > _ZERO)
        row, a, b, fa, fb = (c[hides] for c in live)
        middle = 0.5 * (a + b)
        f = distance(row, middle)
        halves = zip((row, a, middle, fa, f), (row, middle, b, f, fb), strict=True)
        live = tuple(np.concatenate(pair) for pair in halves)
    return tuple(np.concatenate(column) for column in zip(*found, strict=True))


def roots(f: Callable[[NDArray], NDArray], a: NDArray, b: NDArray, fa: NDArray, fb: NDArray) -> NDArray:
    """Roots in brackets [a, b] by secant steps with bisection."""
    for i in range(80):
        x = 0.5 * (a + b) if i % 3 == 2 else (a * fb - b * fa) / (fb - fa)
        x = np.clip(np.where(np.isfinite(x), x, 0.5 * (a + b)), np.minimum(a, b), np.maximum(a, b))
        fx = f(x)
        left = (fx > 0.0) == (fa > 0.0)
        a, fa = np.where(left, x, a), np.where(left, fx, fa)
        b, fb = np.where(left, b, x), np.where(left, fb, fx)
        if np.max(np.minimum(np.abs(b - a), np.minimum(np.abs(fa), np.abs(fb))), initial=0.0) < 1e-14:
            break
    return np.where(np.abs(fa) < np.abs(fb), a, b)
