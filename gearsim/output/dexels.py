"""The tri-dexel: figures, and what it says as a witness."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich.console import Console

from gearsim.metrology.dexel_check import DexelMeasurement
from gearsim.output.markdown import third_witness
from gearsim.output.summary import number
from gearsim.result import Result


def figures(m: DexelMeasurement) -> dict[str, Any]:
    """Its size, what was removed, how its ends agree with the rays."""
    return {
        "pitch_mm": m.box.pitch,
        "rays": [len(b.rays) for b in m.bundles],
        "removed_volume_mm3": m.removed_volumes,
        "check_um": {"max": number(m.check_um), "points": m.checked},
    }


def sections(_: Result, found: Sequence[DexelMeasurement]) -> dict[str, str]:
    return {"trust": "".join(third_witness(figures(m)) for m in found)}


def screen(_: Result, found: Sequence[DexelMeasurement], console: Console) -> None:
    for m in found:
        console.print(f"{m.checked:,} tri-dexel ends agree with the rays to {1e3 * m.check_um:.2g} nm.")
