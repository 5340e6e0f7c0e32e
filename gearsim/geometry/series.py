"""Truncated Taylor series in one variable: a value and its derivatives, computed together."""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial

import numpy as np
from numpy.typing import ArrayLike, NDArray

_YZX, _ZXY = [1, 2, 0], [2, 0, 1]


@dataclass(frozen=True)
class Series:
    """Taylor coefficients c[k] = f⁽ᵏ⁾/k!, shape (order + 1, ...); vectors keep xyz on the last axis.

    Products of a scalar with a vector need ``scalar.column`` so that shapes broadcast.
    Every operation is exact up to rounding for the order kept; binary ones keep the smaller order.
    """

    c: NDArray[np.floating] | NDArray[np.complexfloating]

    @staticmethod
    def variable(value: ArrayLike, order: int) -> Series:
        """The independent variable itself at ``value``, with derivatives 1, 0, 0, ..."""
        value = np.asarray(value, dtype=float)
        c = np.zeros((order + 1, *value.shape))
        c[0] = value
        if order:
            c[1] = 1.0
        return Series(c)

    @property
    def order(self) -> int:
        return len(self.c) - 1

    @property
    def value(self) -> NDArray:
        return self.c[0]

    @property
    def column(self) -> Series:
        """The same scalar series with a trailing axis of one, ready to multiply a vector series."""
        return Series(self.c[..., None])

    @property
    def real(self) -> Series:
        return Series(self.c.real)

    @property
    def imag(self) -> Series:
        return Series(self.c.imag)

    def derivatives(self) -> tuple[NDArray, ...]:
        """Value, first derivative, second derivative, ... up to the order."""
        return tuple(factorial(k) * self.c[k] for k in range(self.order + 1))

    def derivative(self) -> Series:
        """d/dt of the series, one order shorter."""
        k = np.arange(1, self.order + 1).reshape(-1, *([1] * (self.c.ndim - 1)))
        return Series(k * self.c[1:])

    def __neg__(self) -> Series:
        return Series(-self.c)

    def __add__(self, other: Series | ArrayLike) -> Series:
        if isinstance(other, Series):
            n = min(self.order, other.order) + 1
            return Series(self.c[:n] + other.c[:n])
        value = self.c[0] + np.asarray(other)
        c = np.empty((self.order + 1, *value.shape), dtype=value.dtype)
        c[0], c[1:] = value, self.c[1:]
        return Series(c)

    __radd__ = __add__

    def __sub__(self, other: Series | ArrayLike) -> Series:
        return self + (-other if isinstance(other, Series) else -np.asarray(other))

    def __rsub__(self, other: ArrayLike) -> Series:
        return -self + other

    def __mul__(self, other: Series | ArrayLike) -> Series:
        if not isinstance(other, Series):
            return Series(self.c * np.asarray(other))
        n = min(self.order, other.order) + 1
        a, b = _aligned(self.c[:n], other.c[:n])
        c = a[0] * b
        for i in range(1, n):
            c[i:] += a[i] * b[: n - i]
        return Series(c)

    __rmul__ = __mul__

    def __truediv__(self, other: Series | ArrayLike) -> Series:
        if not isinstance(other, Series):
            return Series(self.c / np.asarray(other))
        q: list[NDArray] = []
        for k in range(min(self.order, other.order) + 1):
            q.append((self.c[k] - sum(q[i] * other.c[k - i] for i in range(k))) / other.c[0])
        return Series(np.stack(q))


def sqrt(x: Series) -> Series:
    """Square root of a positive series."""
    r = [np.sqrt(x.c[0])]
    for k in range(1, x.order + 1):
        r.append((x.c[k] - sum(r[i] * r[k - i] for i in range(1, k))) / (2.0 * r[0]))
    return Series(np.stack(r))


def exp(x: Series) -> Series:
    """Exponential, real or complex; exp(i x) gives cosine and sine together."""
    e = [np.exp(x.c[0])]
    for k in range(1, x.order + 1):
        e.append(sum(i * x.c[i] * e[k - i] for i in range(1, k + 1)) / k)
    return Series(np.stack(e))


def log(x: Series) -> Series:
    """Logarithm, real or complex (principal branch at the value)."""
    v = [np.log(x.c[0])]
    for k in range(1, x.order + 1):
        v.append((x.c[k] - sum(i * v[i] * x.c[k - i] for i in range(1, k)) / k) / x.c[0])
    return Series(np.stack(v))


def compose(outer: Series, step: Series) -> Series:
    """A series about x(0), scalar or vector, at x(t): ``step`` is the scalar series x(t) - x(0)."""
    inner = step.column if outer.c.ndim > step.c.ndim else step
    value = Series(np.zeros((step.order + 1, *outer.c.shape[1:]))) + outer.c[-1]
    for c in outer.c[-2::-1]:
        value = value * inner + c
    return value


def stack(components: list[Series]) -> Series:
    """A vector series from scalar ones of equal order, on a new last axis."""
    return Series(np.stack([s.c for s in components], axis=-1))


def dot(a: Series, b: Series) -> Series:
    """Scalar product of two vector series."""
    return Series((a * b).c.sum(axis=-1))


def cross(a: Series, b: Series) -> Series:
    """Vector product of two vector series."""
    n = min(a.order, b.order) + 1
    left, right = _aligned(a.c[:n], b.c[:n])
    left1, left2, right1, right2 = left[..., _YZX], left[..., _ZXY], right[..., _YZX], right[..., _ZXY]
    c = left1[0] * right2 - left2[0] * right1
    for i in range(1, n):
        c[i:] += left1[i] * right2[: n - i] - left2[i] * right1[: n - i]
    return Series(c)


def unit(a: Series) -> Series:
    """A vector series divided by its length."""
    return a / sqrt(dot(a, a)).column


def _aligned(a: NDArray, b: NDArray) -> tuple[NDArray, NDArray]:
    """Coefficients of two series with axes of one behind the first, so that each term of one meets all of the other."""
    dims = max(a.ndim, b.ndim)
    a, b = (c.reshape(len(c), *(1,) * (dims - c.ndim), *c.shape[1:]) for c in (a, b))
    return a, b
