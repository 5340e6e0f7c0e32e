"""Profile and helix (lead) traces of a cylindrical gear evaluated as ISO 1328-1:2013 does.

Deviations are transverse (along the tangent to the base circle), positive for extra material. A trace runs from the
start of the active flank to its end: from the root to the tip, from the datum face (z = 0) to the other face. Slopes
are positive where material grows on that way. Form and total are over the evaluated part; the slope deviation is
taken between the ends of the whole active flank, to which the mean line is extended.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.errors import InputError
from gearsim.surfaces.cylindrical_gear import CylindricalGear, Side, flank_sign

_SAME = 1e-9


@dataclass(frozen=True)
class EvaluationRange:
    """Positions [mm] along a trace: the active flank from ``start`` to ``end``, evaluated from ``first`` to ``last``.

    Positions may fall from start to end (internal profiles, z of a helix). Raises InputError where the evaluated part
    does not lie in the active flank, in its direction.
    """

    start: float
    end: float
    first: float
    last: float

    def __post_init__(self) -> None:
        a, b = self.share([self.first, self.last]) if self.start != self.end else (np.nan, np.nan)
        if not -_SAME <= a < b <= 1.0 + _SAME:
            raise InputError(
                f"the evaluated part {self.first:g} to {self.last:g} mm must lie within the active flank, "
                f"{self.start:g} to {self.end:g} mm, and run the same way"
            )

    def share(self, position: ArrayLike) -> NDArray[np.floating]:
        """Positions [mm] as a share of the active flank: 0 at its start, 1 at its end."""
        return (np.asarray(position, dtype=float) - self.start) / (self.end - self.start)


def profile_range(root: float, tip: float, share: float = 0.95) -> EvaluationRange:
    """A profile over roll lengths R_b xi [mm]: ``share`` of the active length, from its root end on."""
    return EvaluationRange(root, tip, root, root + share * (tip - root))


def helix_range(face_width: float, module: float, window: float | None = None) -> EvaluationRange:
    """A helix over z [mm], from the datum face z = 0 to z = -b, less min(5 % of b, one module) at each end.

    ``window`` evaluates instead the middle ``window`` b (the thesis's inspection: about 0.8).
    """
    margin = min(0.05 * face_width, module) if window is None else 0.5 * (1.0 - window) * face_width
    return EvaluationRange(0.0, -face_width, -margin, margin - face_width)


@dataclass(frozen=True)
class TraceDeviations:
    """f_H, f_f and F [um, transverse] of traces, each of shape (...), nan where a trace is not ``complete``.

    ``line_um`` (..., 2): the mean line at the active flank's start and end. A trace is complete where every sample
    that its evaluation needs exists.
    """

    slope_um: NDArray[np.floating]
    form_um: NDArray[np.floating]
    total_um: NDArray[np.floating]
    line_um: NDArray[np.floating]
    complete: NDArray[np.bool_]


@dataclass(frozen=True)
class GearTraces:
    """Traces of one kind on the flanks of one side of a gear.

    ``teeth`` (t,): numbers of the spaces, from 0; ``stations`` (k,) [mm]: z of profile traces, diameters of helix
    traces; ``position`` (n,) [mm]: roll lengths R_b xi, or z; ``deviation_um`` (t, k, n): transverse, nan where not
    measured; ``design_um``, (k, n) or less: the designed modification. Raises InputError for shapes that do not fit.
    """

    kind: Literal["profile", "helix"]
    side: Side
    teeth: tuple[int, ...]
    stations: tuple[float, ...]
    position: NDArray[np.floating]
    deviation_um: NDArray[np.floating]
    span: EvaluationRange
    design_um: NDArray[np.floating] | float = 0.0

    def __post_init__(self) -> None:
        expected = (len(self.teeth), len(self.stations), len(self.position))
        if self.deviation_um.shape != expected:
            raise InputError(
                f"{self.kind} traces, {self.side} flanks: deviation_um has shape {self.deviation_um.shape}, expected "
                f"{expected} (teeth, stations, positions)"
            )

    @property
    def from_design_um(self) -> NDArray[np.floating]:
        """Deviations from the designed flank, which are what is evaluated."""
        return self.deviation_um - self.design_um

    def evaluated(self) -> TraceDeviations:
        """f_H, f_f, F of every trace, shape (teeth, stations)."""
        return evaluate(self.position, self.from_design_um, self.span)


def transverse_um(normal_mm: ArrayLike, base_helix_angle: float) -> NDArray[np.floating]:
    """Deviations along the normal [mm] as transverse deviations [um]: over cos beta_b."""
    return 1e3 * np.asarray(normal_mm, dtype=float) / cos(base_helix_angle)


def helix_slope_iso_um(slope_um: ArrayLike, gear: CylindricalGear, side: Side) -> NDArray[np.floating]:
    """Helix slopes with the standard's sign: positive where |helix angle| is too large; of spur gears: right hand.

    Material that grows away from the datum face leans a flank to the right hand where f s > 0.
    """
    hand = 1.0 if gear.helix_angle >= 0.0 else -1.0
    return flank_sign(side) * gear.sign * hand * np.asarray(slope_um, dtype=float)


def evaluate(position: NDArray, deviation_um: NDArray, span: EvaluationRange) -> TraceDeviations:
    """Evaluate traces at positions (n,) [mm] with deviations (..., n) [um] from their design.

    The mean line is the least-squares line, samples weighted by their spacing; values at the limits of the evaluated
    part are interpolated. Raises InputError for positions that do not run one way or fewer than 3 in that part.
    """
    x, y = span.share(position), np.asarray(deviation_um, dtype=float)
    if len(x) > 1 and x[0] > x[-1]:
        x, y = x[::-1], y[..., ::-1]
    if np.any(np.diff(x) <= 0.0):
        raise InputError("positions along a trace must run one way, without repeating")
    limits = span.share([span.first, span.last])
    x, y = _cut_out(x, y, *limits)
    weight = 0.5 * (np.diff(x, prepend=x[0]) + np.diff(x, append=x[-1]))
    complete = np.isfinite(y).all(axis=-1)
    y = np.where(complete[..., None], y, np.nan)
    centre = (weight @ x) / weight.sum()
    mean = y @ weight / weight.sum()
    slope = y @ (weight * (x - centre)) / (weight @ (x - centre) ** 2)
    line = mean[..., None] + slope[..., None] * (np.array([0.0, 1.0]) - centre)
    rest = y - slope[..., None] * x
    return TraceDeviations(slope, np.ptp(rest, axis=-1), np.ptp(y, axis=-1), line, complete)


def _cut_out(x: NDArray, y: NDArray, first: float, last: float) -> tuple[NDArray, NDArray]:
    """Samples from ``first`` to ``last``, with values interpolated at both (nan where a neighbour is missing)."""
    inside = (x >= first - _SAME) & (x <= last + _SAME)
    if np.count_nonzero(inside) < 3:
        raise InputError(f"a trace needs at least 3 samples in its evaluated part, not {np.count_nonzero(inside)}")
    part, values = x[inside], y[..., inside]
    if part[0] > first + _SAME:
        part, values = np.append(first, part), np.concatenate([_at(x, y, first), values], axis=-1)
    if part[-1] < last - _SAME:
        part, values = np.append(part, last), np.concatenate([values, _at(x, y, last)], axis=-1)
    return part, values


def _at(x: NDArray, y: NDArray, where: float) -> NDArray:
    """Values (..., 1) interpolated at a place; nan beyond the samples."""
    i = int(np.searchsorted(x, where))
    if i in (0, len(x)):
        return np.full((*y.shape[:-1], 1), np.nan)
    share = (where - x[i - 1]) / (x[i] - x[i - 1])
    return ((1.0 - share) * y[..., i - 1] + share * y[..., i])[..., None]
