"""B-spline bases and rational tensor-product surfaces with their derivatives.

Cox and de Boor's recursion and its derivative, raised degree by degree from the span's constant (Piegl and Tiller, The
NURBS Book, A2.2 and A2.3); all quotients are of positive numbers. Knot vectors are full: count + degree + 1 numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.errors import InputError

_BLOCK = 4096
"""Points evaluated at a time, so that what is summed stays in the processor's cache."""


class SurfaceDerivatives(NamedTuple):
    """Points r [mm] and their first and second derivatives, each of shape (n, 3)."""

    r: NDArray
    ru: NDArray
    rv: NDArray
    ruu: NDArray
    ruv: NDArray
    rvv: NDArray


@dataclass(frozen=True, eq=False)
class BSplineBasis:
    """The functions N_i of one direction: degree (order less one) and full knot vector.

    Raises InputError, naming ``direction``, for knots that fall or repeat too often, and for impossible degrees.
    """

    degree: int
    knots: NDArray[np.floating]
    direction: str = "u"

    def __post_init__(self) -> None:
        what, degree = f"in {self.direction}", self.degree
        if degree < 1:
            raise InputError(f"degree {what} must be at least 1 (straight lines), got {degree}")
        knots = finite_numbers(self.knots, f"knots {what}", 1)
        object.__setattr__(self, "knots", knots)
        if len(knots) < 2 * degree + 2:
            raise InputError(
                f"{len(knots)} knots {what} are too few for degree {degree}: at least {2 * degree + 2} are needed"
            )
        if np.any(np.diff(knots) < 0.0):
            fall = int(np.argmax(np.diff(knots) < 0.0))
            raise InputError(
                f"knots {what} must not fall: knot {fall + 2} is {knots[fall + 1]:g} after {knots[fall]:g}"
            )
        low, high = self.domain
        values, repeats = np.unique(knots, return_counts=True)
        limit = np.where((values > low) & (values < high), degree, degree + 1)
        if np.any(repeats > limit):
            bad = int(np.argmax(repeats > limit))
            raise InputError(
                f"knot {values[bad]:g} {what} stands {repeats[bad]} times; at most {limit[bad]} keep a surface of "
                f"degree {degree} in one piece"
            )

    @property
    def count(self) -> int:
        """Number of functions, hence of control points."""
        return len(self.knots) - self.degree - 1

    @property
    def domain(self) -> tuple[float, float]:
        """Where the functions sum to one."""
        return float(self.knots[self.degree]), float(self.knots[self.count])

    @cached_property
    def last_span(self) -> int:
        """The last knot interval of the domain that is not empty: the one closed at its end (as 2.9 is not)."""
        return int(np.searchsorted(self.knots, self.domain[1], side="left")) - 1

    def span(self, u: NDArray) -> NDArray[np.intp]:
        """Index of the knot interval of each u; on an interior knot the interval right of it."""
        found = np.searchsorted(self.knots, u, side="right") - 1
        return np.clip(found, self.degree, self.last_span)

    def functions(self, u: NDArray, derivatives: int = 0) -> tuple[NDArray, NDArray]:
        """Spans s, shape (n,), and the functions N_{s-degree}, ..., N_s with their derivatives by u.

        The latter have shape (derivatives + 1, degree + 1, n); all other functions vanish. Complex u, for derivatives
        by complex steps, are placed by their real part.
        """
        u = np.asarray(u)
        span = self.span(u.real)
        # rows: the d-th derivative of the functions of degree q, of which q + 1 do not vanish
        table = np.zeros((derivatives + 1, self.degree + 1, len(u)), dtype=np.result_type(u, float))
        table[0, 0] = 1.0
        for q in range(1, self.degree + 1):
            lower, carry = table[:, :q].copy(), np.zeros_like(table[:, 0])
            for r in range(q):
                left, right = self.knots[span + r + 1 - q], self.knots[span + r + 1]
                share = lower[:, r] / (right - left)
                slope = q * share[:-1]
                table[0, r], carry[0] = carry[0] + (right - u) * share[0], (u - left) * share[0]
                table[1:, r], carry[1:] = carry[1:] - slope, slope
            table[:, q] = carry
        return span, table


def clamped_knots(count: int, degree: int, low: float = 0.0, high: float = 1.0) -> NDArray:
    """Full knot vector of equal intervals from low to high that begins and ends on control points."""
    if count <= degree:
        raise InputError(f"degree {degree} needs at least {degree + 1} control points, got {count}")
    inner = np.linspace(low, high, count - degree + 1)
    return np.concatenate([np.full(degree, low), inner, np.full(degree, high)])


def order_knots(count: int, order: int) -> NDArray:
    """Khan's non-periodic knots (2.11) for ``count`` points (his n + 1) and an order k: 0 to n - k + 2 by ones.

    The order is the degree plus one (after 2.13 print calls it the degree). (2.12) is not needed: of n < k only
    n = k - 1 exists, and (2.11) gives it.
    """
    if not 2 <= order <= count:
        raise InputError(f"the order must lie between 2 and the number of control points, {count}; got {order}")
    return clamped_knots(count, order - 1, 0.0, float(count - order + 1))


def surface_derivatives(
    along_u: BSplineBasis, along_v: BSplineBasis, net: NDArray, u: NDArray, v: NDArray
) -> SurfaceDerivatives:
    """Points and derivatives of a rational surface at u, v of shape (n,).

    ``net``: homogeneous control points (w x, w y, w z, w), shape (m, n, 4). The quotient rule is applied after the sum.
    """
    columns = np.ascontiguousarray(np.moveaxis(net, -1, 0)).reshape(4, -1)
    out = np.empty((6, 3, len(u)), dtype=np.result_type(u, v, net))
    for begin in range(0, len(u), _BLOCK):
        part = slice(begin, begin + _BLOCK)
        out[:, :, part] = _quotients(_sums(along_u, along_v, columns, u[part], v[part]))
    return SurfaceDerivatives(*(x.T for x in out))


def surface_points(
    along_u: BSplineBasis, along_v: BSplineBasis, net: NDArray, u: NDArray, v: NDArray
) -> NDArray:  # fmt: skip
    """The points of ``surface_derivatives`` alone, to the bit, shape (n, 3)."""
    columns = np.ascontiguousarray(np.moveaxis(net, -1, 0)).reshape(4, -1)
    out = np.empty((len(u), 3), dtype=np.result_type(u, v, net))
    for begin in range(0, len(u), _BLOCK):
        part = slice(begin, begin + _BLOCK)
        row, by_u = along_u.functions(u[part])
        column, by_v = along_v.functions(v[part])
        first = (row - along_u.degree) * along_v.count + column - along_v.degree
        total = np.zeros((4, len(row)), dtype=out.dtype)
        for i in range(along_u.degree + 1):
            line = np.zeros_like(total)
            for j in range(along_v.degree + 1):
                line += by_v[0, j] * columns.take(first + i * along_v.count + j, axis=1)
            total += by_u[0, i] * line
        out[part] = (total[:3] / total[3]).T
    return out


def _sums(along_u: BSplineBasis, along_v: BSplineBasis, columns: NDArray, u: NDArray, v: NDArray) -> NDArray:
    """Homogeneous point and its derivatives by u, v, uu, uv, vv: shape (6, 4, n)."""
    row, by_u = along_u.functions(u, 2)
    column, by_v = along_v.functions(v, 2)
    first = (row - along_u.degree) * along_v.count + column - along_v.degree
    total = np.zeros((6, 4, len(u)), dtype=np.result_type(u, v, columns))
    for i in range(along_u.degree + 1):
        line = np.zeros((3, 4, len(u)), dtype=total.dtype)
        for j in range(along_v.degree + 1):
            point = columns.take(first + i * along_v.count + j, axis=1)
            for k in range(3):
                line[k] += by_v[k, j] * point
        for k, (a, b) in enumerate(_ORDERS):
            total[k] += by_u[a, i] * line[b]
    return total


_ORDERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))


def _quotients(total: NDArray) -> NDArray:
    """Derivatives of A/w from those of A and w: shape (6, 3, n)."""
    a, w = total[:, :3], total[:, 3:]
    out = np.empty_like(a)
    out[0] = a[0] / w[0]
    out[1] = (a[1] - w[1] * out[0]) / w[0]
    out[2] = (a[2] - w[2] * out[0]) / w[0]
    out[3] = (a[3] - 2.0 * w[1] * out[1] - w[3] * out[0]) / w[0]
    out[4] = (a[4] - w[1] * out[2] - w[2] * out[1] - w[4] * out[0]) / w[0]
    out[5] = (a[5] - 2.0 * w[2] * out[2] - w[5] * out[0]) / w[0]
    return out


def finite_numbers(values: ArrayLike, what: str, axes: int) -> NDArray:
    """Finite float64 numbers with so many axes, or InputError."""
    try:
        found = np.array(values, dtype=float)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{what} must be numbers in rows of equal length") from error
    if found.ndim != axes or not np.isfinite(found).all():
        raise InputError(f"{what} must be finite numbers with {axes} axes, got shape {found.shape}")
    return found
