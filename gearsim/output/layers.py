"""Arrays for the 3D pictures and tooth.vtp, made without any drawing library."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.envelope import envelope_grid
from gearsim.metrology.deviation import Deviation
from gearsim.metrology.samples import SampleGrid
from gearsim.simulation.operation import Variant
from gearsim.surfaces.blank import BevelBlank

_POSES = 25
_ENVELOPE_POSES = 160
_CURVES = 15
_POINTS = 61
_LIFT = 0.04  # mm out of the surface, so that curves are not drawn inside it


def patch_arrays(grid: SampleGrid, deviation: Deviation, name: str = "") -> dict[str, NDArray]:
    """One measured surface, by the patch's name or another."""
    name = name or grid.patch.name
    return {
        f"patch:{name}:point": grid.point,
        f"patch:{name}:normal": grid.normal,
        f"patch:{name}:deviation_um": 1e3 * deviation.value,
        f"patch:{name}:crossing": deviation.crossing,
        f"patch:{name}:segment": deviation.segment,
    }


def view_arrays(blank: BevelBlank, grid: SampleGrid) -> dict[str, NDArray]:
    """Where to look: a point in the slot's middle, the way along the slot to the heel, and up out of it."""
    centre = grid.point[grid.shape[0] // 2, grid.shape[1] // 2]
    return {
        "view:centre": centre,
        "view:along": grid.point[0, -1] - grid.point[0, 0],
        "view:up": blank.cone_directions(centre)[1],
    }


def path_arrays(variant: Variant, surface: str) -> dict[str, NDArray]:
    """Tool axes along a variant's first motion, and its untrimmed envelope (nan where there is none)."""
    source, cutter = variant.motions()[0], variant.cutter
    t = np.linspace(0.0, source.pieces, _POSES)
    piece = np.minimum(t.astype(int), source.pieces - 1)
    pose = source.pose(piece, t - piece, 0)
    arrays = {f"path:{surface}:tip": pose.tip.value, f"path:{surface}:axis": pose.axis.value}
    grid = envelope_grid(source, cutter, _ENVELOPE_POSES, 24)
    flank = grid.element == cutter.flank
    points = np.where(grid.exists[..., None], grid.point, np.nan)[:, flank]
    for k, branch in enumerate(("plus", "minus")):
        arrays[f"envelope:{surface}:{branch}"] = points[:, :, k]
    arrays["cutter:height"] = np.array(cutter.height)
    return arrays


def outline(cutter: Profile) -> NDArray:
    """The tool's meridian (r, z) [mm] as one line, shape (n, 2)."""
    points = []
    for element in cutter.elements:
        at = element.at(np.linspace(0.0, element.length, 25 if element.is_arc else 2))
        points.append(np.column_stack([at.r, at.z]))
    return np.concatenate(points)


def grazing_curves(grid: SampleGrid) -> NDArray:
    """Curves of constant time on a surface and its blank, shape (curves, points, 3), nan beyond them."""
    columns = np.unique(np.linspace(0, grid.shape[1] - 1, _CURVES).astype(int))
    rows = np.linspace(0.0, 1.0, _POINTS)
    u = np.repeat(np.nanmedian(grid.u[:, columns], axis=0), _POINTS)
    low, high = np.nanmin(grid.v[:, columns], axis=0), np.nanmax(grid.v[:, columns], axis=0)
    v = (low[:, None] + (high - low)[:, None] * rows).ravel()
    jet = grid.patch.jet(u, v)
    points = jet.r + _LIFT * jet.normal
    blank = grid.patch.blank
    if blank is not None:
        cone, height = blank.cone_height(points)
        with np.errstate(invalid="ignore"):
            outside = (cone < blank.toe) | (cone > blank.cone_distance) | (height > blank.addendum_at(cone))
        points[outside] = np.nan
    return points.reshape(len(columns), _POINTS, 3)
