"""The cutter catalogue: parameters in, Profile out. Impossible parameters name the relation that fails."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, degrees, pi, sin, tan

from gearsim.cutters.profile import Element, Profile
from gearsim.errors import InputError

_SMALL = 1e-9


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

    Zhou 2015, section 4.1.1, has the tangent case (4.1-4.3; 4.2 printed wrong, see docs/methods.md), which
    is the one built here: the corner must be tangent to both lines. Raises InputError otherwise.
    """
    if r == 0.0:
        e, f = 0.5 * d, 0.5 * d * tan(alpha)
    lower = (e + r * sin(alpha), f - r * cos(alpha))
    upper = (e + r * cos(beta), f - r * sin(beta))
    problems = _size_problems(d, r, e, alpha, beta, h)
    if not problems:
        problems = _tangency_problems(d, r, e, f, alpha, beta, h, lower, upper)
    if problems:
        raise InputError(f"impossible {name}: " + "; ".join(problems))
    top = (upper[0] + (h - upper[1]) * tan(beta), h)
    chain = [Element((0.0, 0.0), lower)] if lower[0] > _SMALL else []
    if r > 0.0:
        chain.append(Element(lower, upper, (e, f), r))
    chain += [Element(upper, top), Element(top, (0.0, h))]
    return Profile(name, tuple(chain))


def _size_problems(d: float, r: float, e: float, alpha: float, beta: float, h: float) -> list[str]:
    rules = [
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
    return [text for good, text in rules if not good]


def _tangency_problems(
    d: float, r: float, e: float, f: float, alpha: float, beta: float, h: float,
    lower: tuple[float, float], upper: tuple[float, float],
) -> list[str]:  # fmt: skip
    problems = []
    f_right = lower[0] * tan(alpha) + r * cos(alpha)
    if abs(f - f_right) > 1e-6:
        problems.append(f"the corner is not tangent to the lower line: f = {f:g} mm, {f_right:.6g} mm would be")
    meet = (upper[0] - upper[1] * tan(beta)) / (1.0 - tan(alpha) * tan(beta))
    if abs(0.5 * d - meet) > 1e-6:
        problems.append(f"the corner is not tangent to the upper line: d = {d:g} mm, {2.0 * meet:.6g} mm would be")
    if h <= upper[1]:
        problems.append(f"height h = {h:g} mm must exceed the corner's end at {upper[1]:.6g} mm")
    elif upper[0] + (h - upper[1]) * tan(beta) <= 0.0:
        problems.append(f"the upper line meets the axis below the top: beta = {degrees(beta):g} deg is too steep")
    return problems


def conical(bottom_radius: float, fillet_radius: float, taper: float, height: float) -> Profile:
    """Conical end mill with corner fillet and flat bottom (Zhou 2015, figure 4.7, table 4.1).

    | parameter | meaning |
    | --- | --- |
    | bottom_radius | radius of the flat bottom disc [mm], Zhou's R1 |
    | fillet_radius | corner radius [mm], his R2 |
    | taper | angle between flank and axis [rad], his alpha_c |
    | height | height of the tool [mm], his H_c |
    """
    d = 2.0 * (bottom_radius + fillet_radius * (1.0 - sin(taper)) / cos(taper))
    return apt(d, fillet_radius, bottom_radius, fillet_radius, 0.0, taper, height, name="conical cutter")


CUTTERS: dict[str, Callable[..., Profile]] = {"apt": apt, "conical": conical}
