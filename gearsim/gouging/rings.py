"""Every contact cut on its own: rings of rays beside it, through which the tool that stands there has been swept.

Contacts are moved apart, each with its tool and its rays, so that one cut of all gives the clearance made by each
alone. Half the sum of the clearances on opposite sides is f(alpha) step²/2 up to the fourth order: the difference of
the curvatures as the removal road sees it, which knows none.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.contact import approach
from gearsim.cutters.profile import Profile
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.rays import RayBundle
from gearsim.geometry.series import Series
from gearsim.gouging.compare import Decision
from gearsim.gouging.prediction import Prediction
from gearsim.metrology.deviation import Crossing, Deviation
from gearsim.surfaces.nurbs import NurbsSurface
from gearsim.toolpaths.sculptured import AXIS, SculpturedPath

DIRECTIONS = 16
MOST = 1500
_NOISE = 1e-8  # mm: what the removal road may be off, with room


@dataclass(frozen=True)
class Standing:
    """A tool that stands at one tip after the other, its axis +z: a motion source of pieces that do not move."""

    tips: NDArray

    @property
    def pieces(self) -> int:
        return len(self.tips)

    def pose(self, piece: NDArray, t: NDArray, order: int) -> PoseSeries:
        still = 0.0 * Series.variable(np.asarray(t, dtype=float), order)
        return PoseSeries(still.column * AXIS + self.tips[piece], still.column * AXIS + AXIS)


@dataclass(frozen=True)
class Rings:
    """Rays about contacts (indices into a path, (m,)), in ``directions`` each, and the standing tools (m, 3)."""

    contact: NDArray[np.integer]
    rays: RayBundle
    standing: Standing


@dataclass(frozen=True)
class RingResult:
    """Contacts (m,) with the least f [1/mm] predicted and found, and the least half width of the band between."""

    contact: NDArray[np.integer]
    predicted: NDArray
    found: NDArray
    band: NDArray

    @property
    def gouging(self) -> NDArray:
        return self.predicted < -self.band

    @property
    def near(self) -> NDArray:
        """Too close to a tie for a ring of this size to tell."""
        return np.abs(self.predicted) <= self.band

    @property
    def disagree(self) -> NDArray:
        """Outside the band, with the other sign."""
        return ~self.near & ((self.found < 0.0) != (self.predicted < 0.0))


def rings(surface: NurbsSurface, cutter: Profile, path: SculpturedPath, found: Prediction, step: float) -> Rings:
    """Rings ``step`` [mm] about contacts of a path at which something is predicted, evenly chosen of all.

    The first direction is the worst; contacts whose ring leaves the surface are left out.
    """
    possible = np.flatnonzero(found.touches)
    chosen = possible[:: max(1, -(-len(possible) // MOST))]
    u, v = path.touches.u[chosen], path.touches.v[chosen]
    jet = surface.jet(u, v)
    uphill = approach(jet.normal, AXIS).uphill
    alpha = found.comparison.worst[chosen, None] + 2.0 * np.pi / DIRECTIONS * np.arange(DIRECTIONS)
    du, dv = _tangent_steps(jet.ru, jet.rv, uphill, np.cross(jet.normal, uphill), alpha)
    around = surface.inside((u[:, None] + step * du).ravel(), (v[:, None] + step * dv).ravel())
    u, v = (x.reshape(alpha.shape) for x in around)
    whole = np.isfinite(u).all(axis=1)
    chosen, u, v = chosen[whole], u[whole], v[whole]
    beside = surface.jet(u.ravel(), v.ravel())
    away = _lattice(len(chosen), 4.0 * cutter.reach + surface.size)
    origin = beside.r + np.repeat(away, DIRECTIONS, axis=0)
    reach = np.full(len(origin), step)
    return Rings(chosen, RayBundle(origin, beside.normal, -reach, reach), Standing(path.touches.tip[chosen] + away))


def read_rings(asked: Rings, found: Prediction, measured: Deviation, step: float) -> RingResult:
    """The least difference of curvatures found on each ring.

    A ray that the tool leaves alone within the window is clear by at least as much, one cut through is overcut by it.
    The band covers noise and the fourth order, 2 k³ step² with the largest curvature k.
    """
    clear = np.where(measured.crossing == Crossing.UNCUT, step, measured.value)
    clear = np.where(measured.crossing == Crossing.THROUGH, -step, clear).reshape(-1, DIRECTIONS)
    half = DIRECTIONS // 2
    least = np.min(clear[:, :half] + clear[:, half:], axis=1) / step**2
    part = found.contacts.part
    size = np.abs(part.a) + 2.0 * np.abs(part.b) + np.abs(part.c)
    predicted = found.comparison.least[asked.contact]
    largest = size[asked.contact] + np.abs(predicted)
    return RingResult(asked.contact, predicted, least, 2.0 * _NOISE / step**2 + 2.0 * largest**3 * step**2)


def ties_apart(result: RingResult, found: Prediction) -> int:
    """How many of the contacts are exact ties by prediction."""
    return int(np.count_nonzero(found.decision[result.contact] == Decision.TIE))


def _tangent_steps(ru: NDArray, rv: NDArray, e1: NDArray, e2: NDArray, alpha: NDArray) -> tuple[NDArray, NDArray]:
    """Changes of u and v, shape (m, k), that move by a unit tangent in directions alpha (m, k)."""
    way = np.cos(alpha)[..., None] * e1[:, None] + np.sin(alpha)[..., None] * e2[:, None]
    e, f, g = (np.einsum("ni,ni->n", a, b)[:, None] for a, b in ((ru, ru), (ru, rv), (rv, rv)))
    p, q = (np.einsum("nki,ni->nk", way, d) for d in (ru, rv))
    return (g * p - f * q) / (e * g - f * f), (e * q - f * p) / (e * g - f * f)


def _lattice(count: int, pitch: float) -> NDArray:
    """Places (count, 3) [mm] of a cubic lattice."""
    side = max(1, int(np.ceil(count ** (1.0 / 3.0))))
    index = np.arange(count)
    return pitch * np.column_stack([index % side, index // side % side, index // side**2]).astype(float)
