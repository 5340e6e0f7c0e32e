"""EXR files: one part a surface, float32 channels on the grid its part describes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import gearsim
from gearsim.result import Result

UNITS = "mm; channels named .um in micrometres"
SIGN = "deviation along the outward surface normal; positive = material left, negative = overcut"
GRID = "row 0 (the picture's top) is the root or lowest end, the last row the tip; column 0 is the toe or first end"


def header(name: str, frame: str, **more: str) -> dict[str, str]:
    """What every part says of itself: the scene, units, sign, the frame of its points, how it lies."""
    return {
        "scene": name, "units": UNITS, "sign": SIGN, "frame": frame, "grid": GRID, **more,
        "version": gearsim.__version__,
    }  # fmt: skip


def stated(result: Result) -> dict[str, str]:
    """What every file of a run says of itself: the header, which motion its plain names are under, what rows are."""
    main = result.job.main
    own = f"deviation.um, deviation_um and segment.id are under {main}; NAME.deviation.um and NAME_um under NAME"
    rows = {"rows_and_columns": result.job.conventions["grids"]} if "grids" in result.job.conventions else {}
    return header(result.name, result.frame, motion=own, program=main, **rows)


def write_exr(parts: dict[str, dict[str, NDArray]], header: dict[str, str], file: Path) -> None:
    """Write channels, shape (rows, columns), as a multi-part OpenEXR file, one part a surface."""
    import OpenEXR

    shapes = np.array([np.shape(next(iter(channels.values()))) for channels in parts.values()])
    height, width = (int(n) for n in shapes.max(axis=0))
    shared = {
        "displayWindow": ((0, 0), (width - 1, height - 1)),  # all parts of a file share it
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        **{f"gearsim.{key}": text for key, text in header.items()},
    }

    def part(name: str, channels: dict[str, NDArray]) -> OpenEXR.Part:
        single = {k: np.ascontiguousarray(v, dtype=np.float32) for k, v in channels.items()}
        return OpenEXR.Part(dict(shared), {k: OpenEXR.Channel(v) for k, v in single.items()}, name)

    with OpenEXR.File([part(name, channels) for name, channels in parts.items()]) as out:
        out.write(str(file))
