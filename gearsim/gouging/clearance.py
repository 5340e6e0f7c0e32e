"""Clearance about a contact by brute force: points of the part against the tool's signed distance, no curvature.

The part is given as a height over its tangent plane, h(x, y) [mm] along n, x along uphill. A point of it inside the
tool is gouging. The contact's curvatures are used nowhere; only its place on the tool is.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.contact import contact_at
from gearsim.cutters.profile import Profile
from gearsim.gouging.tensors import Tensor

Height = Callable[[NDArray, NDArray], NDArray]


def quadric(part: Tensor, tilt: NDArray | None = None, bend: NDArray | None = None) -> Height:
    """Heights of quadrics that touch the tangent plane at the origin and have the tensor ``part``, of shape (n, 1).

    They solve h = q/2 + h (tilt . (x, y)) + bend h²/2, with q the second form, ``tilt`` (n, 1, 2) and ``bend`` (n, 1)
    [1/mm]: every quadric through the contact. Left out, the osculating paraboloid.
    """

    def height(x: NDArray, y: NDArray) -> NDArray:
        q = part.a * x * x + 2.0 * part.b * x * y + part.c * y * y
        if tilt is None or bend is None:
            return 0.5 * q
        rest = 1.0 - tilt[..., 0] * x - tilt[..., 1] * y
        return q / (rest + np.sqrt(rest * rest - bend * q))

    return height


def least_clearance(cutter: Profile, theta: NDArray, height: Height, radius: float, directions: int = 256) -> NDArray:
    """Least 2 d / radius² [1/mm] at points of the part about each contact, theta [rad] of shape (n,); < 0 gouges.

    d is the tool's signed distance; the points lie on a circle of ``radius`` [mm] about the contact and, for a sharp
    rim, under the rim.
    """
    angle = theta[:, None]
    contact = contact_at(cutter, angle)
    turn = 2.0 * np.pi * np.arange(directions) / directions
    x, y = np.broadcast_arrays(radius * np.cos(turn), np.zeros_like(angle))[0], radius * np.sin(turn) + 0.0 * angle
    along = np.linspace(-radius, radius, 9)
    sagitta = along**2 / (contact.r + np.sqrt(np.maximum(contact.r**2 - along**2, 0.0)))  # the rim's own bend inward
    x = np.concatenate([x, -np.cos(angle) * sagitta], axis=1)
    y = np.concatenate([y, along + 0.0 * angle], axis=1)
    h = height(x, y)
    out = contact.r + x * np.cos(angle) - h * np.sin(angle)
    z = contact.z + x * np.sin(angle) + h * np.cos(angle)
    distance = cutter.signed_distance(np.hypot(out, y), z)
    return 2.0 * np.min(distance, axis=1) / radius**2
