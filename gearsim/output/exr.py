"""deviation.exr: one part per flank, float32 channels, rows root to tip, columns toe to heel."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.deviation import Deviation
from gearsim.metrology.samples import SampleGrid
from gearsim.result import Result

UNITS = "mm; channels named .um in micrometres"
SIGN = "deviation along the outward surface normal; positive = material left, negative = overcut"


def write_exr(parts: dict[str, dict[str, NDArray]], result: Result, file: Path) -> None:
    """Write channels, shape (rows, columns), as a multi-part OpenEXR file, one part a surface."""
    import OpenEXR

    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "gearsim.scene": result.name,
        "gearsim.units": UNITS,
        "gearsim.sign": SIGN,
        "gearsim.version": result.versions["gearsim"],
    }

    def part(name: str, channels: dict[str, NDArray]) -> OpenEXR.Part:
        single = {k: np.ascontiguousarray(v, dtype=np.float32) for k, v in channels.items()}
        return OpenEXR.Part(dict(header), {k: OpenEXR.Channel(v) for k, v in single.items()}, name)

    with OpenEXR.File([part(name, channels) for name, channels in parts.items()]) as out:
        out.write(str(file))


def grid_channels(grid: SampleGrid, measured: Deviation, gap_um: NDArray) -> dict[str, NDArray]:
    """The channels of one surface under one motion; not-measured samples are nan with ``valid`` 0."""
    channels = {
        "deviation.um": 1e3 * measured.value,
        "segment.id": measured.segment,
        "envelope_gap.um": gap_um,
        "valid": measured.measured,
    }
    for name, vectors in (("P", grid.point), ("N", grid.normal)):
        channels |= {f"{name}.{axis}": vectors[..., k] for k, axis in enumerate("XYZ")}
    return channels
