"""4 x 4 matrices written out, for tests that must not use the chain of joints."""

import numpy as np


def shift(x, y, z):
    m = np.eye(4)
    m[:3, 3] = x, y, z
    return m


def turn(axis, angle):
    c, s = np.cos(angle), np.sin(angle)
    m = np.eye(4)
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    m[i, i], m[i, j], m[j, i], m[j, j] = c, -s, s, c
    return m


def about(axis, angle, point):
    """Rotation about a coordinate direction through a point."""
    return shift(*point) @ turn(axis, angle) @ shift(*(-np.asarray(point, dtype=float)))


def litvin_settings(i, j, q, phi_p, gamma, s_r, offset, base, back):
    """Litvin and Chen's M_pt (14) and (15), typed out: rotation a_kl and position of O_t."""
    ci, si, cg, sg = np.cos(i), np.sin(i), np.cos(gamma), np.sin(gamma)
    c, s, cp, sp = np.cos(q - j), np.sin(q - j), np.cos(phi_p), np.sin(phi_p)
    rotation = [
        [ci * cg * s - si * sg, -c * cg, si * cg * s + ci * sg],
        [
            ci * sg * sp * s + ci * c * cp + si * cg * sp,
            -c * sg * sp + s * cp,
            si * sg * sp * s + si * c * cp - ci * cg * sp,
        ],
        [
            -ci * sg * cp * s + ci * c * sp - si * cg * cp,
            sg * cp * c + s * sp,
            -si * sg * s * cp + si * c * sp + ci * cg * cp,
        ],
    ]
    origin = [
        s_r * np.cos(q) * cg - base * sg - back,
        -s_r * (np.sin(q) * cp - np.cos(q) * sg * sp) + offset * cp + base * cg * sp,
        -s_r * (np.sin(q) * sp + np.cos(q) * sg * cp) + offset * sp - base * cg * cp,
    ]
    return np.array(rotation), np.array(origin)
