"""Rational B-spline surfaces with first and second derivatives: the device twin of geometry/nurbs.py."""

import warp as wp

from gearsim.kernels.options import OPTIONS

f64 = wp.float64

MAX_DEGREE = 15
Functions = wp.types.matrix(shape=(3, MAX_DEGREE + 1), dtype=f64)

wp.set_module_options(OPTIONS)


@wp.struct
class Nurbs:
    """Degrees, full knot vectors, last spans of the domain, homogeneous control points (w x, w y, w z, w)."""

    degree_u: int
    degree_v: int
    last_u: int
    last_v: int
    knots_u: wp.array(dtype=f64)
    knots_v: wp.array(dtype=f64)
    net: wp.array2d(dtype=wp.vec4d)


@wp.struct
class Derivatives:
    """A point and its derivatives."""

    r: wp.vec3d
    ru: wp.vec3d
    rv: wp.vec3d
    ruu: wp.vec3d
    ruv: wp.vec3d
    rvv: wp.vec3d


@wp.func
def find_span(knots: wp.array(dtype=f64), degree: int, last: int, u: f64) -> int:
    """The knot interval of u: on an interior knot the one right of it, at the domain's end the last."""
    low = degree
    high = last + 1
    while high - low > 1:
        middle = (low + high) // 2
        if u < knots[middle]:
            high = middle
        else:
            low = middle
    return low


@wp.func
def functions(knots: wp.array(dtype=f64), degree: int, span: int, u: f64) -> Functions:
    """The functions that do not vanish at u (row 0) and their first and second derivatives, degree by degree."""
    n = Functions()
    n[0, 0] = f64(1.0)
    for q in range(1, degree + 1):
        value = f64(0.0)
        slope = f64(0.0)
        bend = f64(0.0)
        for r in range(q):
            left = knots[span + r + 1 - q]
            right = knots[span + r + 1]
            share = n[0, r] / (right - left)
            to_slope = f64(q) * share
            to_bend = f64(q) * n[1, r] / (right - left)
            n[0, r] = value + (right - u) * share
            n[1, r] = slope - to_slope
            n[2, r] = bend - to_bend
            value = (u - left) * share
            slope = to_slope
            bend = to_bend
        n[0, q] = value
        n[1, q] = slope
        n[2, q] = bend
    return n


@wp.func
def part(a: wp.vec4d) -> wp.vec3d:
    return wp.vec3d(a[0], a[1], a[2])


@wp.func
def evaluate_nurbs(surface: Nurbs, u: f64, v: f64) -> Derivatives:
    """Point and derivatives by the quotient rule in homogeneous coordinates; u, v within the domain."""
    row = find_span(surface.knots_u, surface.degree_u, surface.last_u, u)
    column = find_span(surface.knots_v, surface.degree_v, surface.last_v, v)
    by_u = functions(surface.knots_u, surface.degree_u, row, u)
    by_v = functions(surface.knots_v, surface.degree_v, column, v)
    a = wp.vec4d()
    au = wp.vec4d()
    av = wp.vec4d()
    auu = wp.vec4d()
    auv = wp.vec4d()
    avv = wp.vec4d()
    for i in range(surface.degree_u + 1):
        line = wp.vec4d()
        slope = wp.vec4d()
        bend = wp.vec4d()
        for j in range(surface.degree_v + 1):
            p = surface.net[row - surface.degree_u + i, column - surface.degree_v + j]
            line += by_v[0, j] * p
            slope += by_v[1, j] * p
            bend += by_v[2, j] * p
        a += by_u[0, i] * line
        au += by_u[1, i] * line
        av += by_u[0, i] * slope
        auu += by_u[2, i] * line
        auv += by_u[1, i] * slope
        avv += by_u[0, i] * bend
    out = Derivatives()
    w = a[3]
    two = f64(2.0)
    out.r = part(a) / w
    out.ru = (part(au) - au[3] * out.r) / w
    out.rv = (part(av) - av[3] * out.r) / w
    out.ruu = (part(auu) - two * au[3] * out.ru - auu[3] * out.r) / w
    out.ruv = (part(auv) - au[3] * out.rv - av[3] * out.ru - auv[3] * out.r) / w
    out.rvv = (part(avv) - two * av[3] * out.rv - avv[3] * out.r) / w
    return out


@wp.kernel
def evaluate_points(
    # surface
    surface: Nurbs,
    # in
    begin: int,
    u: wp.array(dtype=f64),
    v: wp.array(dtype=f64),
    # out
    r_out: wp.array(dtype=wp.vec3d),
    ru_out: wp.array(dtype=wp.vec3d),
    rv_out: wp.array(dtype=wp.vec3d),
    ruu_out: wp.array(dtype=wp.vec3d),
    ruv_out: wp.array(dtype=wp.vec3d),
    rvv_out: wp.array(dtype=wp.vec3d),
):
    """The surface at points from number ``begin`` on."""
    i = begin + wp.tid()
    at = evaluate_nurbs(surface, u[i], v[i])
    r_out[i] = at.r
    ru_out[i] = at.ru
    rv_out[i] = at.rv
    ruu_out[i] = at.ruu
    ruv_out[i] = at.ruv
    rvv_out[i] = at.rvv
