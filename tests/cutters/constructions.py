"""Every cutter of the catalogue by its own construction: a point set (r, z), with parameters to try."""

from math import cos, pi, sin, sqrt, tan

import numpy as np


def below(z, height):
    return (z >= 0.0) & (z <= height)


def rounded(r, z, centre, radius, first, last):
    """Whether points are not in a corner beyond its arc; normals from ``first`` to ``last`` [rad], rising."""
    dr, dz = r - centre[0], z - centre[1]
    middle, half = 0.5 * (first + last), 0.5 * (last - first)
    in_corner = dr * cos(middle) + dz * sin(middle) > np.hypot(dr, dz) * cos(half)
    return ~in_corner | (np.hypot(dr, dz) <= radius)


def cylinder(r, z, diameter, height, c=0.0):
    return (r <= diameter / 2) & below(z, height) & rounded(r, z, (diameter / 2 - c, c), c, -pi / 2, 0.0)


def cone(r, z, tip, taper, height):
    return (r <= tip + z * tan(taper)) & below(z, height)


def in_apt(r, z, d, c, e, f, a, b, h):
    """Tangent corner."""
    lines = (z >= r * tan(a)) & (r <= d / 2 + (z - d / 2 * tan(a)) * tan(b)) & (z <= h)
    return lines & rounded(r, z, (e, f), c, a - pi / 2, -b)


def in_zhou(r, z, h, e, c, b, a):
    f = e * tan(a) + c / cos(a)
    lines = (z >= r * tan(a)) & ((r - e) * cos(b) - (z - f) * sin(b) <= c) & (z <= h)
    return lines & rounded(r, z, (e, f), c, a - pi / 2, -b)


def in_cut_apt(r, z):
    """d 10, r 3, e = f = 2.3: the circle cuts bottom and side, and takes the corner beyond the chord between."""
    floor, wall = 2.3 + sqrt(9.0 - 2.3**2), 2.3 - sqrt(9.0 - 2.7**2)
    beyond = (r - floor) * wall - z * (5.0 - floor) > 0.0
    return (r <= 5.0) & below(z, 20.0) & (~beyond | (np.hypot(r - 2.3, z - 2.3) <= 3.0))


def in_barrel(r, z, d, big, m, h, c):
    axis = d / 2 - big
    x = axis + sqrt((big - c) ** 2 - (m - c) ** 2)
    side = r <= axis + np.sqrt(np.maximum(big**2 - (z - m) ** 2, 0.0))
    return side & below(z, h) & rounded(r, z, (x, c), c, -pi / 2, np.arctan2(c - m, x - axis))


def in_oval(r, z, d, big, b, h):
    return in_barrel(r, z, d, big, b + sqrt((big - b) ** 2 - (big - d / 2) ** 2), h, b)


def in_lollipop(r, z, d, neck, h):
    return (np.hypot(r, z - d / 2) <= d / 2) | ((r <= neck / 2) & (z >= d / 2) & (z <= h))


def in_t_slot(r, z, d, t, neck, h, c):
    disc = cylinder(r, z, d, t, c) & rounded(r, z, (d / 2 - c, t - c), c, 0.0, pi / 2)
    return disc | ((r <= neck / 2) & below(z, h))


def in_dovetail(r, z, d, a, t, neck, h, c):
    e = d / 2 - c * tan(pi / 4 + a / 2)
    head = cone(r, z, d / 2, -a, t) & rounded(r, z, (e, c), c, -pi / 2, a)
    return head | ((r <= neck / 2) & below(z, h))


def in_grinding_cone(r, z, d, a, h, c):
    x = d / 2 - c * tan(pi / 4 + a / 2)
    return (r <= d / 2 - (h - z) * tan(a)) & below(z, h) & rounded(r, z, (x, h - c), c, -a, pi / 2)


def in_wheel(r, z, d, rim, a, depth, c):
    width, x = rim + 2 * depth * tan(a), d / 2 - c
    edge = depth * tan(a) + c * tan(pi / 4 - a / 2)
    flank = (d / 2 - r) * tan(a)
    inside = (r <= d / 2) & (z >= np.maximum(depth * tan(a) - flank, 0.0)) & below(z, width)
    inside &= width - z >= np.maximum(depth * tan(a) - flank, 0.0)
    if rim == 0.0:
        return inside & rounded(r, z, (d / 2 - c / cos(pi / 2 - a), width / 2), c, a - pi / 2, pi / 2 - a)
    return inside & rounded(r, z, (x, edge), c, a - pi / 2, 0.0) & rounded(r, z, (x, width - edge), c, 0.0, pi / 2 - a)


def in_head(r, z, radius, w, inner, outer, c, h):
    i, o = radius - w / 2, radius + w / 2
    body = (r >= i - z * tan(inner)) & (r <= o + z * tan(outer)) & below(z, h)
    x, y = o - c * tan(pi / 4 - outer / 2), i + c * tan(pi / 4 - inner / 2)
    return body & rounded(r, z, (x, c), c, -pi / 2, -outer) & rounded(r, z, (y, c), c, pi + inner, 1.5 * pi)


DEG = pi / 180
HEAD = (63.5, 2.54, 22 * DEG, 22 * DEG, 1.524, 12.0)
SAMPLES = {
    "flat": [((8.0, 20.0), cylinder)],
    "ball": [((6.0, 20.0), lambda r, z, d, h: cylinder(r, z, d, h, d / 2))],
    "bull": [((10.0, 1.0, 15.0), lambda r, z, d, c, h: cylinder(r, z, d, h, c)), ((10.0, 0.0, 15.0), None)],
    "tapered": [
        ((4.0, 8 * DEG, 20.0), lambda r, z, d, a, h: cone(r, z, d / 2, a, h)),
        ((9.0, -8 * DEG, 20.0), lambda r, z, d, a, h: cone(r, z, d / 2, a, h)),
    ],
    "tapered_ball": [
        ((4.0, a * DEG, 20.0), lambda r, z, d, a, h: in_zhou(r, z, h, 0.0, d / 2, a, 0.0)) for a in (10, -4)
    ],
    "conical": [((1.0, 1.5, 15 * DEG, 25.0), lambda r, z, e, c, a, h: in_zhou(r, z, h, e, c, a, 0.0))],
    "apt": [
        ((20.6, 0.0, 0.0, 0.0, 10 * DEG, 5 * DEG, 30.0), in_apt),
        ((10.0, 1.0, 4.0, 1.0, 0.0, 0.0, 15.0), in_apt),
        ((10.0, 3.0, 2.3, 2.3, 0.0, 0.0, 20.0), lambda r, z, *_: in_cut_apt(r, z)),
    ],
    "zhou_apt": [
        ((45.0, 10.0, 3.0, 10 * DEG, 10 * DEG), in_zhou),
        ((35.0, 15.0, 0.0, 0.0, 0.0), in_zhou),
        ((30.0, 5.0, 2.0, -6 * DEG, 20 * DEG), in_zhou),
    ],
    "barrel": [
        ((10.0, 50.0, 12.0, 24.0, 2.0), in_barrel),
        ((10.0, 50.0, 12.0, 24.0), lambda r, z, *p: in_barrel(r, z, *p, 0.0)),
        ((30.0, 80.0, 40.0, 25.0, 1.0), in_barrel),
        ((12.0, 5.5, 3.0, 6.0, 1.0), in_barrel),
    ],
    "drill": [
        ((6.0, 118 * DEG, 30.0), lambda r, z, d, p, h: (r <= d / 2) & (z >= r / tan(p / 2)) & (z <= h)),
        ((5.0, 90 * DEG, 20.0), lambda r, z, d, _, h: (r <= d / 2) & (z >= r) & (z <= h)),
    ],
    "oval": [((12.0, 85.0, 2.0, 30.0), in_oval)],
    "lollipop": [((8.0, 4.0, 20.0), in_lollipop)],
    "t_slot": [((16.0, 4.0, 6.0, 20.0, 0.8), in_t_slot), ((16.0, 4.0, 6.0, 20.0, 0.0), in_t_slot)],
    "dovetail": [
        ((16.0, 30 * DEG, 5.0, 8.0, 20.0, 0.4), in_dovetail),
        ((16.0, 30 * DEG, 5.0, 16.0 - 10.0 * tan(30 * DEG), 20.0, 0.0), in_dovetail),
    ],
    "grinding_cone": [
        ((203.2, 30 * DEG, 30.0, 1.0), in_grinding_cone),
        ((40.0, 30 * DEG, 20.0 / tan(30 * DEG), 0.0), in_grinding_cone),
    ],
    "grinding_wheel": [
        ((100.0, 3.0, 20 * DEG, 8.0, 0.5), in_wheel),
        ((100.0, 0.0, 15 * DEG, 10.0, 0.7), in_wheel),
        ((100.0, 5.0, 0.0, 10.0, 0.5), in_wheel),
    ],
    "face_mill_head": [(HEAD, in_head), ((30.0, 2.0, 10 * DEG, 25 * DEG, 0.0, 8.0), in_head)],
}
