"""Flank topography as an inspection machine reports it: as cut, mid-point zeroed, best rotated."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.samples import SampleGrid


@dataclass(frozen=True)
class Topography:
    """Deviations [um] on the inspector's grid, shape (rows, columns), nan where not measured.

    ``mid_rotation_um`` and ``best_rotation_um`` are the rotations about the gear axis that were taken out,
    as arc lengths at the mid point's radius; positive where the flank stood proud.
    """

    as_cut_um: NDArray[np.floating]
    mid_zeroed_um: NDArray[np.floating]
    best_rotated_um: NDArray[np.floating]
    mid_rotation_um: float
    best_rotation_um: float
    mid_radius_mm: float

    def rotation_deg(self, arc_um: float) -> float:
        """The angle of a rotation given as an arc at the mid point's radius."""
        return degrees(1e-3 * arc_um / self.mid_radius_mm)


def topography(grid: SampleGrid, deviation_um: NDArray) -> Topography:
    """Split deviations on a grid into a rotation of the flank about the gear axis and the rest.

    Turning the machined tooth by an arc at the mid point's radius moves the surface along its normal in
    proportion to the normal's moment about the axis.
    """
    lever = np.cross(grid.point, grid.normal)[..., 2]
    middle = (grid.shape[0] // 2, grid.shape[1] // 2)
    radius = float(np.hypot(*grid.point[middle][:2]))
    per_arc = np.abs(lever) / radius
    good = np.isfinite(deviation_um)
    mid_arc = float(deviation_um[middle] / per_arc[middle])
    best_arc = float((per_arc[good] @ deviation_um[good]) / (per_arc[good] @ per_arc[good])) if good.any() else 0.0
    return Topography(
        deviation_um,
        deviation_um - mid_arc * per_arc,
        deviation_um - best_arc * per_arc,
        mid_arc,
        best_arc,
        radius,
    )
