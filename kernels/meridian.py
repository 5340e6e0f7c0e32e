"""A cutter's meridian in the (r, z) half plane: points, normals and signed distance, as cutters/profile.py has them."""

import warp as wp

f64 = wp.float64

SAME = wp.constant(f64(1.0e-12))  # distances this close to each other, in shares of 1 mm more than they are, are one
ON = wp.constant(f64(1.0e-9))
NO_SIZE = wp.constant(f64(1.0e-300))
GREAT = wp.constant(f64(1.0e4))  # an arc's radius [mm] whose rounding is seen beside what is asked of its points

# Columns of Meridian.elements.
START_R = wp.constant(0)
START_Z = wp.constant(1)
TANGENT_R = wp.constant(2)
TANGENT_Z = wp.constant(3)
LENGTH = wp.constant(4)
CENTRE_R = wp.constant(5)
CENTRE_Z = wp.constant(6)
RADIUS = wp.constant(7)
FIRST = wp.constant(8)
MIDDLE_COS = wp.constant(9)
MIDDLE_SIN = wp.constant(10)
HALF_COS = wp.constant(11)
END_R = wp.constant(12)
END_Z = wp.constant(13)


@wp.struct
class Meridian:
    """Lines (RADIUS 0) and arcs, one a row: start, unit tangent, length; an arc's centre, radius, first normal's
    angle, cosine and sine of its middle's, cosine of half its sweep; the end. Lengths in mm.
    """

    elements: wp.array2d(dtype=f64)


@wp.struct
class MeridianPoint:
    """A point with its outward normal and the meridian's curvature [1/mm] there."""

    r: f64
    z: f64
    nr: f64
    nz: f64
    bend: f64


@wp.func
def meridian_at(meridian: Meridian, i: int, s: f64) -> MeridianPoint:
    """The point at arc length s of an element, extended smoothly beyond its ends."""
    e = meridian.elements
    at = MeridianPoint()
    rho = e[i, RADIUS]
    if rho > f64(0.0):
        angle = e[i, FIRST] + s / rho
        at.nr = wp.cos(angle)
        at.nz = wp.sin(angle)
        at.r = e[i, CENTRE_R] + rho * at.nr
        at.z = e[i, CENTRE_Z] + rho * at.nz
        if rho > GREAT:
            half = f64(0.5) * s / rho
            chord = f64(2.0) * rho * wp.sin(half)
            at.r = e[i, START_R] - chord * wp.sin(e[i, FIRST] + half)
            at.z = e[i, START_Z] + chord * wp.cos(e[i, FIRST] + half)
        at.bend = f64(1.0) / rho
        return at
    at.nr = e[i, TANGENT_Z]
    at.nz = -e[i, TANGENT_R]
    at.r = e[i, START_R] + e[i, TANGENT_R] * s
    at.z = e[i, START_Z] + e[i, TANGENT_Z] * s
    at.bend = f64(0.0)
    return at


@wp.func
def nearest_on(meridian: Meridian, i: int, r: f64, z: f64) -> wp.vec4d:
    """An element's point nearest to (r, z) and its normal: (pr, pz, nr, nz)."""
    e = meridian.elements
    rho = e[i, RADIUS]
    if rho == f64(0.0):
        tr = e[i, TANGENT_R]
        tz = e[i, TANGENT_Z]
        s = wp.clamp((r - e[i, START_R]) * tr + (z - e[i, START_Z]) * tz, f64(0.0), e[i, LENGTH])
        return wp.vec4d(e[i, START_R] + s * tr, e[i, START_Z] + s * tz, tz, -tr)
    dr = r - e[i, CENTRE_R]
    dz = z - e[i, CENTRE_Z]
    size = wp.sqrt(dr * dr + dz * dz)
    c = e[i, MIDDLE_COS]
    d = e[i, MIDDLE_SIN]
    nr = c
    nz = d
    if size >= NO_SIZE:
        nr = dr / size
        nz = dz / size
    if nr * c + nz * d < e[i, HALF_COS]:
        at = wp.vec2d(e[i, END_R], e[i, END_Z])
        if nz * c - nr * d < f64(0.0):
            at = wp.vec2d(e[i, START_R], e[i, START_Z])
        nr = (at[0] - e[i, CENTRE_R]) / rho
        nz = (at[1] - e[i, CENTRE_Z]) / rho
    return wp.vec4d(e[i, CENTRE_R] + rho * nr, e[i, CENTRE_Z] + rho * nz, nr, nz)


@wp.func
def meridian_distance(meridian: Meridian, r: f64, z: f64) -> wp.vec3d:
    """Signed distance of (r, z) to the tool, negative inside, and its gradient (nr, nz).

    The nearest element rules; of two that meet in the nearest corner, the one seen more squarely.
    """
    best = f64(1.0e300)
    square = f64(0.0)
    out = wp.vec3d()
    for i in range(meridian.elements.shape[0]):
        p = nearest_on(meridian, i, r, z)
        dr = r - p[0]
        dz = z - p[1]
        gap = wp.sqrt(dr * dr + dz * dz)
        along = dr * p[2] + dz * p[3]
        tie = SAME * (f64(1.0) + gap)
        if gap < best - tie or (gap <= best + tie and wp.abs(along) > square):
            best = gap
            square = wp.abs(along)
            side = f64(-1.0)
            if along > f64(0.0):
                side = f64(1.0)
            nr = p[2]
            nz = p[3]
            if gap > ON:
                nr = dr * side / gap
                nz = dz * side / gap
            out = wp.vec3d(side * gap, nr, nz)
    return out
