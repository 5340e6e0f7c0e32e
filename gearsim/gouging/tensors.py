"""Curvature tensors of part and tool at a contact, in one tangent basis (e1, e2 = n x e1).

Curvature is positive where the part curves towards the tool and where the tool curves away from the part: n points
out of the material, into the tool, and k = n.r''. This is also the sign of `geometry.jets.Curvature`, whose
normals point out of the material (a ball -1/R, a bowl +1/R), so `curvature_tensor` changes none; a surface whose
jets point the other way is turned there by ``orientation``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.cutters.contact import Contact


@dataclass(frozen=True)
class Tensor:
    """Normal curvature k(alpha) = a cos² + 2 b cos sin + c sin² [1/mm]; a, b, c of shape (...).

    alpha [rad] counts counter-clockwise about n from e1.
    """

    a: NDArray
    b: NDArray
    c: NDArray

    def __getitem__(self, index: Any) -> Tensor:
        return Tensor(self.a[index], self.b[index], self.c[index])

    def at(self, alpha: ArrayLike) -> NDArray:
        """Normal curvature [1/mm] in directions alpha [rad] (Euler; Khan 4.25)."""
        cosine, sine = np.cos(alpha), np.sin(alpha)
        return self.a * cosine**2 + 2.0 * self.b * cosine * sine + self.c * sine**2

    def principal(self) -> tuple[NDArray, NDArray, NDArray]:
        """Largest and least curvature [1/mm], and the largest's direction [rad] in [0, pi); 0 at umbilics."""
        mean, half = 0.5 * (self.a + self.c), 0.5 * (self.a - self.c)
        spread = np.hypot(half, self.b)
        return mean + spread, mean - spread, np.mod(0.5 * np.arctan2(self.b, half), np.pi)


def principal_tensor(k_max: ArrayLike, k_min: ArrayLike, alpha0: ArrayLike = 0.0) -> Tensor:
    """The tensor with the principal curvatures k_max >= k_min [1/mm], the largest at alpha0 [rad]."""
    high, low, angle = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in (k_max, k_min, alpha0)))
    mean, half = 0.5 * (high + low), 0.5 * (high - low)
    along, beside = half * np.cos(2.0 * angle), half * np.sin(2.0 * angle)
    return Tensor(mean + along, beside, mean - along)


def tool_tensor(contact: Contact) -> Tensor:
    """A tool's tensor in the basis (uphill, n x uphill), with the weaker of the meridian's two curvatures."""
    return Tensor(contact.weaker, np.zeros_like(contact.around), contact.around)
