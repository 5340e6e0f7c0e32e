"""The seven-parameter APT cutter: lower cone, corner torus, upper cone; and the forms of it the sources use."""

from __future__ import annotations

from math import cos, degrees, hypot, pi, sin, sqrt, tan

from gearsim.cutters.outline import not_negative, require, slanted
from gearsim.cutters.profile import Element, Profile

_SMALL = 1e-9
_TANGENT = 1e-6

_Point = tuple[float, float]


def apt(
    d: float, r: float, e: float, f: float, alpha: float, beta: float, h: float, name: str = "APT cutter"
) -> Profile:
    """The seven-parameter APT cutter; lengths in mm, angles in rad.

    | parameter | meaning |
    | --- | --- |
    | d | diameter where the lower and the upper line, prolonged, meet |
    | r | corner radius |
    | e | corner centre's distance from the axis |
    | f | corner centre's height over the tip |
    | alpha | angle of the lower line from the plane normal to the axis, upward |
    | beta | angle of the upper line from the axis; positive widens upward |
    | h | height of the tool |

    The lower line starts at the tip. The corner may be tangent to a line (within 1e-6 mm, as rounded CL data
    is) or cut it: then the line ends in a sharp edge where it enters the corner's circle for good, and the arc
    takes away the tool's corner. A corner that does not reach a line is refused with InputError, as is any
    other impossible size. e and f do not matter for r = 0. The tangent case is Zhou 2015, 4.1-4.3 (``zhou_apt``).
    """
    if r == 0.0:
        e, f = 0.5 * d, 0.5 * d * tan(alpha)
    require(name, _size_rules(d, r, e, alpha, beta, h))
    require(name, _reach_rules(d, r, e, f, alpha, beta))
    lower = _crossing((0.0, 0.0), (cos(alpha), sin(alpha)), (e, f), r, far=True)
    upper = _crossing((0.5 * d, 0.5 * d * tan(alpha)), (sin(beta), cos(beta)), (e, f), r, far=False)
    top = (upper[0] + (h - upper[1]) * tan(beta), h)
    require(name, _order_rules(lower, upper, top, f, beta))
    chain = [Element((0.0, 0.0), lower)] if lower[0] > _SMALL else []
    if r > 0.0:
        start = lower if lower[0] > _SMALL else (0.0, 0.0)
        chain.append(Element(start, upper, (e, f), r))
    chain += [Element(upper, top), Element(top, (0.0, h))]
    return Profile(name, tuple(chain))


def _crossing(point: _Point, way: _Point, centre: _Point, radius: float, far: bool) -> _Point:
    """Where a line meets the corner's circle: its foot if they are tangent, else its far or its near crossing."""
    along = (centre[0] - point[0]) * way[0] + (centre[1] - point[1]) * way[1]
    foot = point[0] + along * way[0], point[1] + along * way[1]
    apart = hypot(foot[0] - centre[0], foot[1] - centre[1])
    if radius == 0.0 or abs(apart - radius) <= _TANGENT:
        scale = radius / apart if apart > 0.0 else 0.0
        return centre[0] + scale * (foot[0] - centre[0]), centre[1] + scale * (foot[1] - centre[1])
    half = sqrt(radius**2 - apart**2) * (1.0 if far else -1.0)
    return foot[0] + half * way[0], foot[1] + half * way[1]


def _size_rules(d: float, r: float, e: float, alpha: float, beta: float, h: float) -> list[tuple[bool, str]]:
    return [
        (d > 0.0, f"diameter d = {d:g} mm must be positive"),
        (r >= 0.0, f"corner radius r = {r:g} mm must not be negative"),
        (e >= 0.0, f"corner centre distance e = {e:g} mm must not be negative"),
        (h > 0.0, f"height h = {h:g} mm must be positive"),
        (0.0 <= alpha < 0.5 * pi, f"lower angle alpha = {degrees(alpha):g} deg must lie in 0 to 90 deg"),
        (abs(beta) < 0.5 * pi, f"upper angle beta = {degrees(beta):g} deg must lie in -90 to 90 deg"),
        (
            alpha + beta < 0.5 * pi,
            "alpha + beta must be below 90 deg: the corner turns from one line to the other",
        ),
    ]


def _reach_rules(d: float, r: float, e: float, f: float, alpha: float, beta: float) -> list[tuple[bool, str]]:
    """The corner's circle must touch or cut both lines, from within the wedge between them."""
    lower = f * cos(alpha) - e * sin(alpha)
    f_right = e * tan(alpha) + r / cos(alpha)
    upper = (0.5 * d - e) * cos(beta) + (f - 0.5 * d * tan(alpha)) * sin(beta)
    d_right = 2.0 * (e * cos(beta) - f * sin(beta) + r) / (cos(beta) - tan(alpha) * sin(beta))
    text = "the corner does not reach the {} line: {} = {:g} mm, {:.6g} mm would be tangent"
    inside = "the corner's centre lies {:g} mm outside the {} line; the corner must be cut from within the tool"
    return [
        (lower <= r + _TANGENT, text.format("lower", "f", f, f_right)),
        (upper <= r + _TANGENT, text.format("upper", "d", d, d_right)),
        (lower >= -_TANGENT, inside.format(-lower, "lower")),
        (upper >= -_TANGENT, inside.format(-upper, "upper")),
    ]


def _order_rules(lower: _Point, upper: _Point, top: _Point, f: float, beta: float) -> list[tuple[bool, str]]:
    return [
        (lower[0] >= -_SMALL, f"the corner meets the lower line beyond the axis, at r = {lower[0]:g} mm"),
        (upper[0] > _SMALL, f"the corner meets the upper line at r = {upper[0]:g} mm, not outside the axis"),
        (
            upper[1] >= lower[1] - _SMALL,
            f"the corner cuts the upper line at z = {upper[1]:g} mm, below the lower line's end at {lower[1]:g} mm; "
            f"f = {f:g} mm is too low for this radius",
        ),
        (top[1] > upper[1], f"height h = {top[1]:g} mm must exceed the corner's end at {upper[1]:.6g} mm"),
        (top[0] > 0.0, f"the upper line meets the axis below the top: beta = {degrees(beta):g} deg is too steep"),
    ]


def zhou_apt(height: float, corner_distance: float, corner_radius: float, psi_u: float, psi_l: float) -> Profile:
    """The APT cutter of Zhou 2015, section 4.1.1, corner tangent to both cones: {H, R_l, R_t, psi_u, psi_l}.

    | parameter | meaning |
    | --- | --- |
    | height | length of the cutter along its axis [mm], his H |
    | corner_distance | corner centre's distance from the axis [mm], his R_l |
    | corner_radius | radius of the corner torus [mm], his R_t |
    | psi_u | angle between upper cone and axis [rad] |
    | psi_l | angle between lower cone and the plane normal to the axis [rad] |

    His 4.2 as corrected: rho = R_l csc(phi) + R_t for psi_l <= phi <= 90 deg - psi_u. Raises InputError.
    """
    f = corner_distance * tan(psi_l) + corner_radius / cos(psi_l)
    side = corner_distance * cos(psi_u) - f * sin(psi_u) + corner_radius
    d = 2.0 * side / (cos(psi_u) - tan(psi_l) * sin(psi_u))
    return apt(d, corner_radius, corner_distance, f, psi_l, psi_u, height)


def conical(bottom_radius: float, fillet_radius: float, taper: float, height: float) -> Profile:
    """Conical end mill with corner fillet and flat bottom (Zhou 2015, figure 4.7, table 4.1).

    | parameter | meaning |
    | --- | --- |
    | bottom_radius | radius of the flat bottom disc [mm], Zhou's R1 |
    | fillet_radius | corner radius [mm], his R2 |
    | taper | angle between flank and axis [rad], his alpha_c |
    | height | height of the tool [mm], his H_c |

    Raises InputError for impossible sizes.
    """
    require(
        "conical cutter",
        [
            not_negative("bottom_radius", bottom_radius),
            not_negative("fillet_radius", fillet_radius),
            slanted("taper", taper),
        ],
    )
    d = 2.0 * (bottom_radius + fillet_radius * (1.0 - sin(taper)) / cos(taper))
    return apt(d, fillet_radius, bottom_radius, fillet_radius, 0.0, taper, height, name="conical cutter")
