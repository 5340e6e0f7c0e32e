"""Computations for tests that share no code with the product."""

from __future__ import annotations

import numpy as np


def observed_order(errors, steps):
    """Order of convergence from errors at falling step sizes (least squares in logarithms)."""
    return np.polyfit(np.log(steps), np.log(errors), 1)[0]


def conical_distance(r, z, bottom_radius, fillet_radius, taper, height):
    """Signed distance to the conical cutter with corner fillet, written from its construction.

    The tool is the intersection of a slab in z, a cone, and, near the corner, a disc rounded by a ball; the
    nearest face is found by the sector of the corner the point lies in.
    """
    s, c = np.sin(taper), np.cos(taper)
    dr, dz = r - bottom_radius, z - fillet_radius
    to_flank = dr * c - dz * s - fillet_radius
    along_flank = dr * s + dz * c
    to_bottom, to_top = -z, z - height
    top_radius = bottom_radius + fillet_radius * c + (height - fillet_radius * (1.0 - s)) * np.tan(taper)
    corner = np.hypot(dr, dz) - fillet_radius
    lower = np.where(dr <= 0.0, to_bottom, np.where(along_flank >= 0.0, to_flank, corner))
    rim = np.hypot(np.maximum(r - top_radius, 0.0), to_top)
    past_rim = (r - top_radius) * s + (z - height) * c
    above = np.where(r <= top_radius, to_top, np.where(past_rim >= 0.0, np.hypot(r - top_radius, z - height), lower))
    inside = np.maximum(lower, to_top)
    return np.where(z > height, np.where(r <= top_radius, rim, above), inside)


def slerp(a, b, t):
    """Constant-rate turn from unit vector a to b at t, by the rotation's own construction."""
    axis = np.cross(a, b)
    sine = np.linalg.norm(axis)
    if sine < 1e-15:
        return np.broadcast_to(a, (*np.shape(t), 3))
    axis = axis / sine
    angle = np.arctan2(sine, a @ b) * np.asarray(t)[..., None]
    return np.cos(angle) * a + np.sin(angle) * np.cross(axis, a)
