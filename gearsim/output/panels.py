"""Pages of panels at fixed places: to let a library find places takes it longer than to draw the page."""

from __future__ import annotations

from typing import Any, NamedTuple


class Room(NamedTuple):
    """Inches left free: at the page's four sides, between columns and between rows."""

    left: float = 0.75
    right: float = 0.25
    bottom: float = 0.55
    top: float = 0.95
    across: float = 0.9
    up: float = 0.8


_USUAL = Room()


def page(rows: int, columns: int, panel: tuple[float, float], room: Room = _USUAL, title: str = "") -> Any:
    """A figure with panels of a size [inch] and their axes, shape (rows, columns); the title above them."""
    width = room.left + columns * panel[0] + (columns - 1) * room.across + room.right
    height = room.bottom + rows * panel[1] + (rows - 1) * room.up + room.top
    figure, axes = pyplot().subplots(
        rows, columns, figsize=(width, height), squeeze=False, gridspec_kw={
            "left": room.left / width, "right": 1.0 - room.right / width, "bottom": room.bottom / height,
            "top": 1.0 - room.top / height, "wspace": room.across / panel[0], "hspace": room.up / panel[1],
        },
    )  # fmt: skip
    if title:
        figure.suptitle(title, fontsize=13, weight="bold", y=1.0 - 0.15 / height, va="top")
    return figure, axes


def pyplot() -> Any:
    """Matplotlib without a screen; letters are not fitted to pixels, which at these sizes shows in their cost alone."""
    import matplotlib as mpl

    mpl.use("Agg")
    mpl.rcParams["text.hinting"] = "none"
    import matplotlib.pyplot as plt

    return plt
