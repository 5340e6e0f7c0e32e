"""Inverse distribution functions by additions, products, quotients and roots alone.

IEEE 754 fixes these to the last bit; logarithms and exponentials of libraries differ there from processor to
processor, and a study's values must be the same on every machine.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_LN2 = (6.93147180369123816490e-01, 1.90821492927058770002e-10)  # its first 33 bits, and the rest
_LEAST = 2.0**-53  # a share below it counts as this one, so above 1 minus it: 0 and 1 have no quantile
_SMALLEST = 2.0**-1021


def logarithm(x: Floats | np.float64) -> Floats:
    """Natural logarithm of positive numbers, to 2 units in the last place."""
    part, exponent = np.frexp(np.asarray(x, dtype=float))
    low = part < 0.7071067811865476
    part, exponent = np.where(low, 2.0 * part, part), exponent - low
    f = (part - 1.0) / (part + 1.0)
    square, sum_ = f * f, np.zeros_like(f)
    for k in range(23, 0, -2):
        sum_ = sum_ * square + 1.0 / k
    out: Floats = exponent * _LN2[0] + (exponent * _LN2[1] + 2.0 * f * sum_)
    return out


def exponential(x: Floats) -> Floats:
    """e to the power of x, to 2 units in the last place."""
    x = np.asarray(x, dtype=float)
    whole = np.rint(x / (_LN2[0] + _LN2[1]))
    rest = (x - whole * _LN2[0]) - whole * _LN2[1]
    sum_ = np.ones_like(rest)
    for k in range(16, 0, -1):
        sum_ = 1.0 + sum_ * rest / k
    out: Floats = np.ldexp(sum_, whole.astype(np.int64))
    return out


# Coefficients of M. J. Wichura, Algorithm AS 241 (PPND16), Applied Statistics 37 (1988) 477-484: numerator and
# denominator, highest power first, near the middle, in the tails, and far out.
_MIDDLE = (
    (2.5090809287301226727e3, 3.3430575583588128105e4, 6.7265770927008700853e4, 4.5921953931549871457e4,
     1.3731693765509461125e4, 1.9715909503065514427e3, 1.3314166789178437745e2, 3.3871328727963666080e0),
    (5.2264952788528545610e3, 2.8729085735721942674e4, 3.9307895800092710610e4, 2.1213794301586595867e4,
     5.3941960214247511077e3, 6.8718700749205790830e2, 4.2313330701600911252e1, 1.0),
)  # fmt: skip
_TAIL = (
    (7.74545014278341407640e-4, 2.27238449892691845833e-2, 2.41780725177450611770e-1, 1.27045825245236838258e0,
     3.64784832476320460504e0, 5.76949722146069140550e0, 4.63033784615654529590e0, 1.42343711074968357734e0),
    (1.05075007164441684324e-9, 5.47593808499534494600e-4, 1.51986665636164571966e-2, 1.48103976427480074590e-1,
     6.89767334985100004550e-1, 1.67638483018380384940e0, 2.05319162663775882187e0, 1.0),
)  # fmt: skip
_FAR = (
    (2.01033439929228813265e-7, 2.71155556874348757815e-5, 1.24266094738807843860e-3, 2.65321895265761230930e-2,
     2.96560571828504891230e-1, 1.78482653991729133580e0, 5.46378491116411436990e0, 6.65790464350110377720e0),
    (2.04426310338993978564e-15, 1.42151175831644588870e-7, 1.84631831751005468180e-5, 7.86869131145613259100e-4,
     1.48753612908506148525e-2, 1.36929880922735805310e-1, 5.99832206555887937690e-1, 1.0),
)  # fmt: skip


def _ratio(x: Floats, coefficients: tuple[tuple[float, ...], tuple[float, ...]]) -> Floats:
    above, below = np.zeros_like(x), np.zeros_like(x)
    for a, b in zip(*coefficients, strict=True):
        above, below = above * x + a, below * x + b
    return above / below


def standard_normal(share: Floats | np.float64) -> Floats:
    """The standard normal distribution's quantiles of shares in (0, 1), to 1e-15 of themselves (AS 241)."""
    share = np.asarray(share, dtype=float)
    q = share - 0.5
    r = np.sqrt(-logarithm(np.minimum(share, 1.0 - share)))
    tails = np.where(r <= 5.0, _ratio(r - 1.6, _TAIL), _ratio(r - 5.0, _FAR))
    middle = q * _ratio(0.180625 - q * q, _MIDDLE)
    return np.where(np.abs(q) <= 0.425, middle, np.where(q < 0.0, -tails, tails))


def share_below(x: float) -> float:
    """The share of the standard normal distribution below x <= 0: the number whose quantile is x, by bisection."""
    low, high = _SMALLEST, 0.5
    if x >= 0.0:
        return 0.5
    if standard_normal(np.float64(low)) >= x:
        return 0.0
    while True:  # halves exponents first, then the digits
        middle = low * np.sqrt(high / low) if high > 4.0 * low else 0.5 * (low + high)
        if not low < middle < high:
            return float(high)
        if standard_normal(np.float64(middle)) < x:
            low = middle
        else:
            high = middle


def uniform(share: Floats, low: float, high: float) -> Floats:
    """Evenly from low to high."""
    return np.clip(low + share * (high - low), low, high)


def log_uniform(share: Floats, low: float, high: float) -> Floats:
    """Its logarithm evenly from low's to high's, both above 0."""
    inside = low * exponential(share * logarithm(np.float64(high / low)))
    return np.where(share == 1.0, high, np.clip(inside, low, high))


def triangular(share: Floats, low: float, mode: float, high: float) -> Floats:
    """Density rising straight from low to mode, falling straight to high."""
    width, rise = high - low, mode - low
    up = low + np.sqrt(share * width * rise)
    down = high - np.sqrt((1.0 - share) * width * (high - mode))
    return np.clip(np.where(share * width < rise, up, down), low, high)


def normal(share: Floats, mean: float, deviation: float, lower: float = -np.inf, upper: float = np.inf) -> Floats:
    """Normally about the mean, cut off below ``lower`` and above ``upper``; nan where nothing is left between."""
    a, b = (lower - mean) / deviation, (upper - mean) / deviation
    if a > 0.0:  # mirrored: shares near 1 have fewer digits
        return mean - normal(1.0 - share, 0.0, deviation, mean - upper, mean - lower)
    below = 0.0 if a == -np.inf else share_below(a)
    above = 0.0 if b == np.inf else share_below(-b) if b > 0.0 else 1.0 - share_below(b)
    kept = 1.0 - below - above if b > 0.0 else share_below(b) - below
    if not kept > 0.0:
        return np.full_like(share, np.nan)
    within = np.clip(below + np.clip(share, _LEAST, 1.0) * kept, _SMALLEST, 1.0 - _LEAST)
    return np.clip(mean + deviation * standard_normal(within), lower, upper)
