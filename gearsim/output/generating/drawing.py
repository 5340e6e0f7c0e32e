"""Arrays for the 3D pictures of a run that generates surfaces, collected without any drawing library."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.metrology.surface import SurfaceResult
from gearsim.output.drawing import patch_arrays, relief_arrays, view_arrays
from gearsim.output.generating.maps import shown_motion
from gearsim.result import GeneratingResult

_CURVES = 15
_POINTS = 61
_LIFT = 0.04  # mm out of the surface, so that curves are not drawn inside it


def write_drawing(result: GeneratingResult, file: Path) -> None:
    """Save what the drawing process needs as one .npz."""
    shown = shown_motion(result)
    arrays: dict[str, NDArray] = {"tolerance_um": np.array(result.scene["metrology"]["tolerance_um"])}
    for name, surface in result.surfaces.items():
        arrays |= patch_arrays(surface.grid, surface.deviations[shown])
        arrays[f"grazing:{name}"] = _grazing_curves(surface)
    if result.dexels is not None:
        arrays |= relief_arrays(result.dexels, [s.grid.patch for s in result.surfaces.values()])
    if result.blank is not None:
        middle = list(result.surfaces.values())[len(result.surfaces) // 2]
        arrays |= view_arrays(result.blank, middle.grid)
    cut = result.cuts[0]
    source = next(iter(cut.sources.values()))
    piece = np.array([0, (source.pieces - 1) // 2, source.pieces - 1])
    t = np.array([0.0, 0.5 if source.pieces % 2 else 1.0, 1.0])
    pose = source.pose(piece, t, 0)
    arrays |= {"tool:profile": outline(cut.cutter), "tool:tip": pose.tip.value, "tool:axis": pose.axis.value}
    np.savez(file, allow_pickle=False, **arrays)


def _grazing_curves(surface: SurfaceResult) -> NDArray:
    """Curves of constant time on a surface and its blank, shape (curves, points, 3), nan beyond them."""
    grid = surface.grid
    columns = np.unique(np.linspace(0, grid.shape[1] - 1, _CURVES).astype(int))
    rows = np.linspace(0.0, 1.0, _POINTS)
    u = np.repeat(np.nanmedian(grid.phi[:, columns], axis=0), _POINTS)
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


def outline(cutter: Profile) -> NDArray:
    """The tool's meridian (r, z) [mm] as one line, shape (n, 2)."""
    points = []
    for element in cutter.elements:
        at = element.at(np.linspace(0.0, element.length, 25 if element.is_arc else 2))
        points.append(np.column_stack([at.r, at.z]))
    return np.concatenate(points)
