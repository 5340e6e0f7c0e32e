"""The measured patches of a slot as one surface: in their order from tip to tip, with what lies between them."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.meshes import quads


def machined(data: dict[str, NDArray], name: str) -> NDArray:
    """A patch's intended points moved by their deviation, (rows, columns, 3)."""
    um = np.nan_to_num(data[f"patch:{name}:deviation_um"])
    return np.asarray(data[f"patch:{name}:point"] + 1e-3 * um[..., None] * data[f"patch:{name}:normal"])


def from_tip_to_tip(patches: list[NDArray]) -> list[NDArray]:
    """Neighbouring patches, (rows, columns, 3) each, their rows turned about so that they follow one another."""

    def apart(a: NDArray, b: NDArray) -> float:
        return float(np.nansum((a - b) ** 2))

    first, second = patches[0], patches[1]
    to_first_row, to_last_row = (min(apart(first[k], second[j]) for j in (0, -1)) for k in (0, -1))
    out = [first[::-1] if to_first_row < to_last_row else first]
    for patch in patches[1:]:
        out.append(patch[::-1] if apart(out[-1][-1], patch[-1]) < apart(out[-1][-1], patch[0]) else patch)
    return out


def seams(patches: list[NDArray]) -> list[Any]:
    """Meshes of the strips between patches that follow one another: what lies within the margins of both."""
    return [quads(np.stack([a[-1], b[0]])) for a, b in pairwise(patches)]


def place(data: dict[str, NDArray], name: str, along: float = 0.5) -> NDArray:
    """The point half way up a patch, at a share of its way from toe to heel."""
    points = data[f"patch:{name}:point"]
    return np.asarray(points[points.shape[0] // 2, round(along * (points.shape[1] - 1))])
