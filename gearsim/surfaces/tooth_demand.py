"""What a part demands of a bevel tooth that a head generates, beside the blank that it is cut into."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class ToothDemand:
    """Demands with their tolerances, either sign; None: nothing is demanded.

    ``depth_um``: of the bottom land off the root cone; ``join_um``: of gaps between neighbouring surfaces. At the mean
    cone distance, on the pitch cone: ``spiral`` angle [deg], its ``hand``, and ``thickness`` [mm] of the tooth around
    the gear axis.
    """

    depth_um: float
    join_um: float
    spiral: float | None
    spiral_tolerance: float
    thickness: float | None
    thickness_um: float
    hand: Literal["left", "right"] | None = None
