"""deviation.exr: one part per flank, float32 channels, rows root to tip, columns toe to heel."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.bevel import FlankResult
from gearsim.result import Result

UNITS = "mm; channels named .um in micrometres"
SIGN = "deviation along the outward surface normal; positive = material left, negative = overcut"


def write_exr(result: Result, file: Path) -> None:
    """Write the dense grids of all passes as a multi-part OpenEXR file."""
    import OpenEXR

    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "gearsim.scene": str(result.scene["scene"]["name"]),
        "gearsim.units": UNITS,
        "gearsim.sign": SIGN,
        "gearsim.version": result.versions["gearsim"],
    }
    parts = [
        OpenEXR.Part(dict(header), {k: OpenEXR.Channel(v) for k, v in exr_channels(flank).items()}, side)
        for side, flank in result.flanks.items()
    ]
    with OpenEXR.File(parts) as out:
        out.write(str(file))


def exr_channels(flank: FlankResult) -> dict[str, NDArray[np.float32]]:
    """The channels of one flank, shape (rows, columns); not-measured samples are nan with ``valid`` 0."""
    measured = flank.all_passes
    channels = {
        "deviation.um": 1e3 * measured.value,
        "segment.id": measured.segment,
        "envelope_gap.um": flank.gap_cl.gap_um,
        "valid": measured.measured,
    }
    for name, vectors in (("P", flank.grid.point), ("N", flank.grid.normal)):
        channels |= {f"{name}.{axis}": vectors[..., k] for k, axis in enumerate("XYZ")}
    return {k: np.ascontiguousarray(v, dtype=np.float32) for k, v in channels.items()}
