"""Colours that mean one thing in every picture: material left, overcut, the intended surface, the steel around it."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

EXCESS = "#b2182b"
OVERCUT = "#2166ac"
DIVERGING = "RdBu_r"  # overcut in the one colour, excess in the other
BAND = "#dfe8d8"  # within tolerance
LINE = "0.35"
OUT = "#b5179e"  # a number beyond its tolerance
GOUGE = "#7b3fa0"  # where, and in which directions, a tool gouges; overcut has its own colour
FIRST, SECOND = "#b5752a", "#3f7f6b"  # of two flanks
DARK = "#000000"  # where there is no value
STEEL = "#b8bec6"
BLANK = "blank"  # the name of what nothing has cut

_ANCHORS = (
    "#053061", "#2166ac", "#4393c3", "#92c5de", "#d1e5f0", "#f7f7f7", "#fddbc7", "#f4a582", "#d6604d", "#b2182b",
    "#67001f",
)  # fmt: skip

_VIRIDIS = ("#440154", "#3b528b", "#21918c", "#5ec962", "#fde725")
_OF_CLASSES = (
    "#4e79a7", "#f28e2b", "#59a14f", "#b07aa1", "#edc948", "#76b7b2", "#9c755f", "#ff9da7", "#e15759", "#8cb369",
)  # fmt: skip


def rgb(colour: str) -> tuple[float, float, float]:
    """Red, green, blue from 0 to 1 of a colour written as #rrggbb."""
    return int(colour[1:3], 16) / 255.0, int(colour[3:5], 16) / 255.0, int(colour[5:7], 16) / 255.0


def diverging(shares: NDArray) -> NDArray:
    """The colours of ``DIVERGING`` at shares of the limit from -1 to 1, shape (n, 3), without a drawing library."""
    return _between(_ANCHORS, shares)


def shades(name: str, steps: int = 33) -> list[str]:
    """So many colours of a palette, ``diverging`` or ``sequential``, from its low end to its high one, as #rrggbb."""
    colours = _between(_ANCHORS if name == "diverging" else _VIRIDIS, np.linspace(-1.0, 1.0, steps))
    return ["#" + "".join(f"{round(255.0 * float(c)):02x}" for c in shade) for shade in colours]


def class_colours(names: Sequence[str]) -> list[str]:
    """A colour for each class, as #rrggbb, what nothing has cut being steel; they begin anew after ten.

    So an operation has one colour in every picture, whether or not the blank is named before it.
    """
    of_classes = itertools.cycle(_OF_CLASSES)
    return [STEEL if name == BLANK else next(of_classes) for name in names]


def _between(colours: tuple[str, ...], shares: NDArray) -> NDArray:
    """Colours (n, 3) at shares from -1 to 1 of the way along some at equal distances."""
    anchors = np.array([rgb(colour) for colour in colours])
    at = np.linspace(-1.0, 1.0, len(anchors))
    return np.column_stack([np.interp(shares, at, anchors[:, k]) for k in range(3)])
