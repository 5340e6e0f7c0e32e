"""The drawing process: 3D pictures and tooth.vtp, ``python -m gearsim.output.drawer FOLDER``.

A machine without OpenGL ends that process, not the run; tooth.vtp, which needs none, is written first.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from gearsim.output.cylindrical.draw import draw_gear
from gearsim.output.draw import draw_flank_milling, patch_meshes
from gearsim.output.generating.draw import draw_generating
from gearsim.output.gouging.draw import draw_surfaces

DATA = "drawing.npz"


def start_drawing(folder: Path) -> subprocess.Popen[str]:
    """Start drawing what drawing.npz in a folder holds."""
    command = [sys.executable, "-P", "-m", "gearsim.output.drawer", str(folder)]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)


def finish_drawing(process: subprocess.Popen[str], folder: Path, pictures: Sequence[str]) -> list[str]:
    """Wait for the drawing process; says which of the pictures are missing and why, one line each."""
    errors = process.communicate()[1]
    missing = [name for name in pictures if not (folder / name).exists()]
    if not missing:
        return []
    reason = (errors.strip().splitlines() or [f"the drawing process ended with code {process.returncode}"])[-1]
    return [
        f"3D pictures ({', '.join(missing)}): {reason}. They need OpenGL without a screen; on Debian or Ubuntu: "
        "apt-get install libegl1 libgl1-mesa-dri"
    ]


def main(folder: Path) -> None:
    """Draw everything."""
    import pyvista as pv

    pv.OFF_SCREEN = True
    data = dict(np.load(folder / DATA))
    surfaces = patch_meshes(data)
    pv.merge(list(surfaces.values()), merge_points=False).extract_surface(algorithm=None).save(folder / "tooth.vtp")
    if "section:y" in data:
        draw_gear(data, surfaces, folder / "gear.png")
    elif any(key.startswith("gouge:") for key in data):
        draw_surfaces(data, surfaces, folder / "surface.png")
    elif "tool:profile" in data:
        draw_generating(data, surfaces, folder)
    else:
        draw_flank_milling(data, surfaces, folder)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
