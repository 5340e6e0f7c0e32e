"""The same passes in several spaces of a gear: turned about its axis, z, by whole pitches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import pi

import numpy as np

from gearsim.programs.cldata import CLPath


def indexed(passes: Sequence[CLPath], teeth: int, spaces: int) -> list[CLPath]:
    """The passes in the first ``spaces`` of a gear of ``teeth``, space by space, the way the numbers of spaces rise.

    In the first they keep their names, in space k they are called NAME.k.
    """
    return [*passes, *(_turned(path, k, 2.0 * pi * k / teeth) for k in range(1, spaces) for path in passes)]


def _turned(path: CLPath, space: int, angle: float) -> CLPath:
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    return replace(path, name=f"{path.name}.{space + 1}", tips=path.tips @ turn, axes=path.axes @ turn)
