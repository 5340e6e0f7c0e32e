"""Maps as one picture in the colours of all pictures, for viewers that know red, green and blue alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gearsim.output.colours import EXCESS, OVERCUT

SCALE = ("#053061", OVERCUT, "#f7f7f7", EXCESS, "#67001f")  # from -limit over 0 to +limit
NOTHING = "#d9d9d9"
_GAP = 1  # rows between maps


def tops(maps: Sequence[NDArray]) -> list[int]:
    """In which row of the picture each map begins: they lie one below the other, a row apart."""
    return [0, *np.cumsum([len(m) + _GAP for m in maps[:-1]]).tolist()]


def preview(maps: Sequence[NDArray], limit: float) -> NDArray[np.float32]:
    """The maps one below the other, shape (height, width, 3), linear light; a value a pixel, black where there is none.

    Values from ``-limit`` to ``limit`` run through the scale, those beyond have its ends' colours, nan is grey.
    """
    height, width = tops(maps)[-1] + len(maps[-1]), max(m.shape[1] for m in maps)
    picture = np.zeros((height, width, 3), dtype=np.float32)
    for top, values in zip(tops(maps), maps, strict=True):
        picture[top : top + len(values), : values.shape[1]] = _coloured(values, limit)
    return picture


def _coloured(values: NDArray, limit: float) -> NDArray:
    share = np.clip(np.nan_to_num(values / limit, posinf=1.0, neginf=-1.0), -1.0, 1.0)
    scale = np.array([_channels(colour) for colour in SCALE])
    places = np.linspace(-1.0, 1.0, len(SCALE))
    colours = np.stack([np.interp(share, places, channel) for channel in scale.T], axis=-1)
    colours[np.isnan(values)] = _channels(NOTHING)
    return _linear(colours)


def _channels(colour: str) -> tuple[float, float, float]:
    red, green, blue = (int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    return red, green, blue


def _linear(srgb: NDArray) -> NDArray:
    """Light of colours as screens take them (IEC 61966-2-1), for OpenEXR holds light."""
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
