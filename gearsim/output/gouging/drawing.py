"""Arrays for surface.png and tooth.vtp, collected without any drawing library."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.contact import locate
from gearsim.output.drawing import patch_arrays
from gearsim.output.generating.drawing import outline
from gearsim.result import SculpturedResult


def write_drawing(result: SculpturedResult, labels: dict[str, str], file: Path) -> None:
    """Save what the drawing process needs as one .npz."""
    arrays: dict[str, NDArray] = {}
    u, v = np.array([result.plotted.u]), np.array([result.plotted.v])
    jet = result.surface.jet(u, v)
    for number, (name, cut) in enumerate(result.cuts.items()):
        named = f"{number + 1} {name}"
        patch = patch_arrays(result.grid, cut.deviation)
        arrays |= {key.replace(result.grid.patch.name, named, 1): value for key, value in patch.items()}
        arrays[f"gouge:{named}:profile"] = outline(cut.cutter)
        arrays[f"gouge:{named}:tip"] = locate(cut.cutter, jet.r, jet.normal).tip[0]
        arrays[f"gouge:{named}:label"] = np.array(labels[name])
    np.savez(file, allow_pickle=False, **arrays)
