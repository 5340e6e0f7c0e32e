"""How early a ray can be entered near a pose where its contact is known.

Let F(x, tau) be the signed distance of the ray's point tau to the cutter at pose x. For a convex cutter F
is the largest of linear functions of the point seen from the tool, so it is semi-convex: with K the bound
on that point's second derivative and w the axis rate,
    F(x + s, tau + u) >= F + F_x s + F_tau u - K s²/2 - w |s u|.
This bounds from below how early the ray can be entered near a known pose.
"""

import warp as wp

from gearsim.kernels.contact import Contact
from gearsim.kernels.tool_ray import FAR, TINY, greater, lesser

f64 = wp.float64


@wp.func
def certified_reach(push: f64, steep: f64, room: f64, curvature: f64, spin: f64, slack: f64) -> f64:
    """How far from a contact no entry can come earlier than ``room`` before it.

    ``push`` is F_x in the direction of travel; ``slack`` is the penetration [mm] that is let pass.
    """
    q = push - room * spin
    offer = f64(2.0) * (room * steep + slack)
    root = wp.sqrt(q * q + curvature * offer)
    if q >= f64(0.0):
        reach = (q + root) / greater(curvature, TINY)
    else:
        reach = offer / (root - q)
    return lesser(reach, steep / greater(spin, TINY))


@wp.func
def slope(c: Contact) -> f64:
    """Derivative of the entry by x at a contact."""
    return c.push / greater(c.steep, TINY)


@wp.func
def lower_bound(a: Contact, b: Contact, curvature: f64, spin: f64) -> wp.vec2d:
    """Where the bounds from two contacts that straddle a minimum meet, and the earliest entry they allow.

    From a contact, an entry s onward is earlier by at most (|push| s + K s²/2) / (steep - w s).
    """
    width = b.x - a.x
    steep_a = a.steep - spin * width
    steep_b = b.steep - spin * width
    if steep_a <= TINY or steep_b <= TINY:
        return wp.vec2d(f64(0.5) * (a.x + b.x), -FAR)
    slope_a = a.push / steep_a
    slope_b = b.push / steep_b
    bend_a = curvature / steep_a
    bend_b = curvature / steep_b
    over = a.tau - b.tau + slope_b * width + f64(0.5) * bend_b * width * width
    fall = slope_b - slope_a + bend_b * width
    four_ac = f64(2.0) * (bend_b - bend_a) * over
    s = f64(2.0) * over / (fall + wp.sqrt(greater(fall * fall - four_ac, f64(0.0))))
    s = wp.clamp(s, f64(0.0), width)
    return wp.vec2d(a.x + s, a.tau + slope_a * s - f64(0.5) * bend_a * s * s)


@wp.func
def cubic_minimum(a: Contact, b: Contact) -> f64:
    """Minimiser of the cubic through two contacts with slopes of opposite sign, a to the left."""
    slope_a = slope(a)
    slope_b = slope(b)
    d1 = slope_a + slope_b - f64(3.0) * (a.tau - b.tau) / (a.x - b.x)
    d2 = wp.sqrt(greater(d1 * d1 - slope_a * slope_b, f64(0.0)))
    return b.x - (b.x - a.x) * (slope_b + d2 - d1) / (slope_b - slope_a + f64(2.0) * d2)
