"""Roughness of measured or simulated traces: Ra, Rq, Rz with ISO filtering, and the ten-point height.

Form is removed first (a least-squares polynomial), then the Gaussian filter of ISO 16610-21 takes out what is longer
than the cutoff; the short-wave filter lambda_s is not applied. Ra and Rq are over the evaluation length and Rz is the
mean peak-to-valley height of its sections, one cutoff long (ISO 21920-2). The ten-point height is that of Groover's
eq. 5.3: mean of the five highest peaks less mean of the five deepest valleys of the evaluation length.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, floor, log, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError

CUTOFF_MM = 0.8
SECTIONS = 5
_ALPHA = sqrt(log(2.0) / pi)
_PEAKS = 5


@dataclass(frozen=True)
class Roughness:
    """One trace: Ra, Rq, Rz and the ten-point height [um], nan where they cannot be had; ``status`` says why.

    ``position`` (n,) [mm] along the trace; ``primary_um`` (n,): the trace less its form; ``waviness_um`` (n,): what
    the filter takes out; ``roughness_um`` (n,): the rest. Evaluated from ``first`` to ``last`` [mm], ``sections``
    sampling lengths of one cutoff.
    """

    ra_um: float
    rq_um: float
    rz_um: float
    ten_point_um: float
    position: NDArray[np.floating]
    primary_um: NDArray[np.floating]
    waviness_um: NDArray[np.floating]
    roughness_um: NDArray[np.floating]
    first: float
    last: float
    sections: int
    cutoff_mm: float
    status: str


def measure_roughness(
    position: NDArray, height_um: NDArray, degree: int, cutoff_mm: float = CUTOFF_MM, sections: int = SECTIONS
) -> Roughness:
    """Roughness of heights (n,) [um] over the path lengths (n,) [mm] along the surface, in rising order.

    ``degree`` of the form removed: the thesis takes 1 along the helix, 2 along the profile. The evaluation length
    lies in the middle, with half a cutoff before and behind it; where the trace is too short for that, fewer sections
    are taken and ``status`` says so. Uneven samples are brought to their smallest spacing. Raises InputError for
    positions that do not rise.
    """
    if len(position) < degree + 2 or np.any(np.diff(position) <= 0.0):
        raise InputError(f"roughness needs at least {degree + 2} positions along a trace, in rising order")
    length = float(position[-1] - position[0])
    fitting = max(min(sections, floor(length / cutoff_mm - 1.0 + 1e-9)), 0)
    x = _even(np.asarray(position, dtype=float))
    primary = remove_form(x, np.interp(x, position, height_um), degree)
    long_wave = waviness(primary, x[1] - x[0], cutoff_mm)
    rough = primary - long_wave
    middle = 0.5 * (x[0] + x[-1])
    first, last = middle - 0.5 * fitting * cutoff_mm, middle + 0.5 * fitting * cutoff_mm
    inside = rough[(x >= first - 1e-9) & (x <= last + 1e-9)] if fitting else np.array([])
    status = _status(height_um, length, fitting, sections, cutoff_mm)
    ra = rq = rz = ten_point = float("nan")
    if fitting and np.isfinite(height_um).all():
        ra, rq = float(np.mean(np.abs(inside))), float(np.sqrt(np.mean(inside**2)))
        rz, ten_point = _rz(inside, fitting), ten_point_height(inside)
        if np.isnan(ten_point):
            status = "; ".join(s for s in (status, f"fewer than {_PEAKS} peaks and valleys: no ten-point height") if s)
    curves = x, primary, long_wave, rough
    return Roughness(ra, rq, rz, ten_point, *curves, first, last, fitting, cutoff_mm, status)


def remove_form(position: NDArray, height_um: NDArray, degree: int) -> NDArray:
    """Heights less their least-squares polynomial of a degree, shape (n,); all nan where one is missing."""
    if not np.isfinite(height_um).all():
        return np.full(len(position), np.nan)
    x = 2.0 * (position - position[0]) / (position[-1] - position[0]) - 1.0
    return height_um - np.polynomial.Polynomial.fit(x, height_um, degree, domain=[-1.0, 1.0])(x)


def waviness(height_um: NDArray, spacing: float, cutoff_mm: float = CUTOFF_MM) -> NDArray:
    """What the Gaussian filter of ISO 16610-21 lets pass of evenly spaced heights, shape (n,).

    It passes half of a wave as long as the cutoff. The weighting function reaches one cutoff to each side; near the
    ends what lies outside the trace is left out and the rest weighted up.
    """
    from scipy.ndimage import correlate1d  # slow to load, and not every job asks for roughness

    reach = min(ceil(cutoff_mm / spacing), len(height_um) - 1)
    offset = spacing * np.arange(-reach, reach + 1)
    weight = np.exp(-pi * (offset / (_ALPHA * cutoff_mm)) ** 2)
    share = correlate1d(np.ones(len(height_um)), weight, mode="constant")
    return correlate1d(height_um, weight, mode="constant") / share


def ten_point_height(height_um: NDArray) -> float:
    """Mean of the five highest peaks less mean of the five deepest valleys [um]; nan where there are fewer.

    A peak is the highest point between two crossings of the mean line, a valley the lowest.
    """
    if len(height_um) == 0:
        return float("nan")
    starts = np.append(0, np.flatnonzero(np.diff(height_um > 0.0)) + 1)
    top, low = np.maximum.reduceat(height_um, starts), np.minimum.reduceat(height_um, starts)
    peaks, valleys = np.sort(top[top > 0.0])[::-1][:_PEAKS], np.sort(low[top <= 0.0])[:_PEAKS]
    if min(len(peaks), len(valleys)) < _PEAKS:
        return float("nan")
    return float(np.mean(peaks) - np.mean(valleys))


def _rz(height_um: NDArray, sections: int) -> float:
    """Mean over the sections of highest peak less deepest valley."""
    return float(np.mean([np.ptp(part) for part in np.array_split(height_um, sections)]))


def _even(position: NDArray) -> NDArray:
    """Evenly spaced positions over the same length, at the smallest spacing found."""
    step = np.diff(position)
    if np.ptp(step) <= 1e-9 * step.max():
        return position
    return np.linspace(position[0], position[-1], ceil((position[-1] - position[0]) / step.min() - 1e-9) + 1)


def _status(height_um: NDArray, length: float, fitting: int, sections: int, cutoff_mm: float) -> str:
    problems = []
    if not np.isfinite(height_um).all():
        problems.append(f"{np.count_nonzero(~np.isfinite(height_um))} samples missing: nothing evaluated")
    if fitting < sections:
        needed = (sections + 1) * cutoff_mm
        problems.append(
            f"trace of {length:.3g} mm is short: {fitting} of {sections} sections of {cutoff_mm:g} mm evaluated "
            f"({needed:.3g} mm needed)"
        )
    return "; ".join(problems)
