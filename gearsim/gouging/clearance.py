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


def least_clearance(cutter: Profile, theta: NDArray, height: Height, radius: float, directions: int = 128) -> NDArray:
    """Least 2 d / radius² [1/mm] at points of the part about each contact, theta [rad] of shape (n,); < 0 gouges.

    d is the tool's signed distance; the points lie on a circle of ``radius`` [mm] about the contact, once more and
    closer about the worst of them, and under the tool's own circle through the contact: a sharp rim gouges nowhere
    else.
    """
    step = 2.0 * np.pi / directions
    turn = step * np.arange(directions) + np.zeros((len(theta), 1))
    coarse = _distances(cutter, theta, height, radius * np.cos(turn), radius * np.sin(turn))
    worst = np.take_along_axis(turn, np.argmin(coarse, axis=1)[:, None], axis=1)
    turn = worst + step * np.linspace(-1.0, 1.0, directions // 2)
    fine = _distances(cutter, theta, height, radius * np.cos(turn), radius * np.sin(turn))
    under = _distances(cutter, theta, height, *_under_circle(contact_at(cutter, theta).r, theta, radius))
    return 2.0 * np.min(np.concatenate([coarse, fine, under], axis=1), axis=1) / radius**2


def _under_circle(r: NDArray, theta: NDArray, radius: float) -> tuple[NDArray, NDArray]:
    """Tangent coordinates (n, 2) of two points of the tool's circle of radius r, ``radius`` beside the contact."""
    side = radius * np.array([-1.0, 1.0]) + np.zeros((len(r), 1))
    reaches = r[:, None] > radius
    inward = r[:, None] - np.sqrt(np.where(reaches, r[:, None] ** 2 - side**2, r[:, None] ** 2))
    return -np.cos(theta)[:, None] * inward, side


def _distances(cutter: Profile, theta: NDArray, height: Height, x: NDArray, y: NDArray) -> NDArray:
    """The tool's signed distance [mm] from points of the part over the tangent coordinates x, y, shape (n, m)."""
    angle, h = theta[:, None], height(x, y)
    contact = contact_at(cutter, angle)
    out = contact.r + x * np.cos(angle) - h * np.sin(angle)
    z = contact.z + x * np.sin(angle) + h * np.cos(angle)
    return cutter.signed_distance(np.hypot(out, y), z)
