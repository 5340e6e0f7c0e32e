"""Arrays for the 3D pictures and tooth.vtp, collected from a result without any drawing library."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearsim.envelope import envelope_grid
from gearsim.metrology.closest import signed_distance
from gearsim.metrology.deviation import Deviation
from gearsim.metrology.dexel_check import DexelResult
from gearsim.metrology.samples import SampleGrid, sample_grid
from gearsim.result import FlankMillingResult
from gearsim.surfaces.blank import BevelBlank
from gearsim.surfaces.patch import Patch

_POSES = 25
_ENVELOPE_POSES = 160
_NEAR = 2.0


def write_drawing(result: FlankMillingResult, file: Path) -> None:
    """Save what the drawing process needs as one .npz."""
    arrays: dict[str, NDArray] = {}
    grids = [(f.grid, f.all_passes) for f in result.flanks.values()]
    grids += [(p.grid, p.deviation) for p in result.patches.values()]
    for grid, deviation in grids:
        arrays |= patch_arrays(grid, deviation)
    arrays |= relief_arrays(result.dexels, result.tooth.patches)
    arrays |= view_arrays(result.tooth.blank, result.patches["bottom"].grid)
    arrays["gear:polygon"] = result.tooth.blank.stock.polygon
    arrays["pinion:polygon"] = result.tooth.blank.mate(result.scene["surface"]["mate_teeth"]).stock.polygon
    arrays["tolerance_um"] = np.array(result.scene["metrology"]["tolerance_um"])
    arrays |= _path_arrays(result)
    np.savez(file, allow_pickle=False, **arrays)


def patch_arrays(grid: SampleGrid, deviation: Deviation) -> dict[str, NDArray]:
    """One measured surface."""
    name = grid.patch.name
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


def relief_arrays(dexels: DexelResult, patches: Sequence[Patch]) -> dict[str, NDArray]:
    """Top of the material in the slot's box, from the bundle across the root.

    Points (i, j, 3) in the gear frame, nan where there is no material, and the distance [um] of cut points
    to the intended slot, nan where none of its surfaces is near.
    """
    box, bundle = dexels.box, dexels.bundles[2]
    top, made = np.full(len(bundle.rays), np.nan), np.full(len(bundle.rays), -1)
    top[bundle.left.ray] = bundle.left.hi
    made[bundle.left.ray] = bundle.left.hi_segment
    points = bundle.rays.origin + top[:, None] * bundle.rays.direction
    cut = np.flatnonzero(made >= 0)
    distance = np.full(len(top), np.nan)
    for patch in patches:
        here = signed_distance(sample_grid(patch, 9, 65), points[cut])[0]
        nearer = (np.abs(here) < _NEAR) & ~(np.abs(distance[cut]) <= np.abs(here))
        distance[cut[nearer]] = here[nearer]
    shape = (int(box.counts[0]), int(box.counts[1]))
    return {"relief:point": points.reshape(*shape, 3), "relief:deviation_um": 1e3 * distance.reshape(shape)}


def _path_arrays(result: FlankMillingResult) -> dict[str, NDArray]:
    """Tool axes along each flank's pass, and the flank's untrimmed envelope (nan where there is none)."""
    arrays: dict[str, NDArray] = {}
    for side, sources in result.own_sources.items():
        source = result.theory.get(side) or sources[0]
        t = np.linspace(0.0, source.pieces, _POSES)
        piece = np.minimum(t.astype(int), source.pieces - 1)
        pose = source.pose(piece, t - piece, 0)
        arrays[f"path:{side}:tip"], arrays[f"path:{side}:axis"] = pose.tip.value, pose.axis.value
        grid = envelope_grid(source, result.cutter, _ENVELOPE_POSES, 24)
        flank = grid.element == result.cutter.flank
        points = np.where(grid.exists[..., None], grid.point, np.nan)[:, flank]
        for k, branch in enumerate(("plus", "minus")):
            arrays[f"envelope:{side}:{branch}"] = points[:, :, k]
    arrays["cutter:height"] = np.array(result.cutter.height)
    return arrays
