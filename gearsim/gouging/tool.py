"""A tool as gouging sees it: its contact at an angle, and its sharp edges, which alone enter concave corners."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.contact import ANGLE, BEYOND, Contact, cutting_contact, end_mill_contact, sharp_edges
from gearsim.cutters.profile import Profile


@dataclass(frozen=True)
class Tool:
    """``contact`` gives contacts at angles theta [rad], nan where there are none.

    ``edges``: first and last angle [rad] and radius [mm] of every sharp edge, 0 at a pointed tip.
    """

    contact: Callable[[NDArray], Contact]
    edges: tuple[tuple[float, float, float], ...]

    def fits_corner(self, theta: NDArray, other: NDArray, apart: NDArray) -> NDArray[np.bool_]:
        """Whether a sharp edge has both walls of a concave corner among its normals, arrays (n,).

        ``theta``, ``other``: the walls' contact angles [rad]; ``apart``: the angle [rad] between their directions
        across the axis, 0 where one of them is level.
        """
        found = np.zeros(len(theta), dtype=bool)
        for first, last, radius in self.edges:
            low, high = first - ANGLE, last + ANGLE
            both = (theta >= low) & (theta <= high) & (other >= low) & (other <= high)
            found |= both & ((apart <= 1e-6) | (radius == 0.0))
        return found


def cutter_tool(cutter: Profile) -> Tool:
    """Any convex cutter. Raises InputError for one that is not."""
    cutting_contact(cutter, np.zeros(1))
    return Tool(lambda theta: cutting_contact(cutter, theta), tuple(sharp_edges(cutter)))


def mill_tool(shank: float, corner: float) -> Tool:
    """An end mill R, r [mm]."""
    edges = ((0.0, 0.5 * np.pi, shank),) if corner == 0.0 else ()

    def contact(theta: NDArray) -> Contact:
        wall = (theta > 0.5 * np.pi) & (theta <= 0.5 * np.pi + BEYOND)
        return end_mill_contact(shank, corner, np.where(wall, 0.5 * np.pi, theta))

    return Tool(contact, edges)
