"""5-axis passes of a ball-nosed tool to and fro over a face: its ball touches all along, its axis follows a rule."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.motion.sources import CLMotion
from gearsim.surfaces.nurbs import NurbsJet, NurbsSurface
from gearsim.toolpaths.counts import check_points
from gearsim.toolpaths.sculptured import line_count

# Unit axes away from the tip, shape (n, 3), at shares (n,) of a face's u and the surface's jet there.
AxisRule = Callable[[NDArray, NurbsJet], NDArray]
_ROUNDS = 14
_ON_AXIS = 1e-9
_LOOKS_ASIDE = 1e-3


def fixed_axis(direction: NDArray) -> AxisRule:
    """The same axis everywhere."""
    return lambda _, jet: np.broadcast_to(direction, jet.r.shape)


def leaning_axis(direction: NDArray, lean: float, guide: NurbsSurface | None = None) -> AxisRule:
    """A direction leant by an angle [rad] to the side that the face looks at, or a ``guide`` at the same share of u.

    Raises InputError, asked for axes, where that side is not defined: there the normal is along the direction.
    """

    def rule(share: NDArray, jet: NurbsJet) -> NDArray:
        normal = jet.normal
        if guide is not None:
            normal = guide.jet(*guide.locate(share, 0.5)).normal
        aside = normal - (normal @ direction)[:, None] * direction
        length = np.linalg.norm(aside, axis=1, keepdims=True)
        if not (length > _LOOKS_ASIDE).all():
            raise InputError(
                "axis: where a face looks along the axis there is no side to lean to; name another for it in as_over"
            )
        return np.asarray(np.cos(lean) * direction + np.sin(lean) * aside / length)

    return rule


def between_axis(walls: tuple[NurbsSurface, ...], direction: NDArray) -> AxisRule:
    """The mean of the walls' rulings, turned so that they lead rather towards a ``direction`` than away from it.

    A ruling leads along v from border to border of a wall, at the same share of its u as the contact's.
    """

    def rule(share: NDArray, _: NurbsJet) -> NDArray:
        total = np.zeros((len(share), 3))
        for wall in walls:
            ends = [wall.at(*wall.locate(share, x)) for x in (0.0, 1.0)]
            way = ends[1] - ends[0]
            way /= np.linalg.norm(way, axis=1, keepdims=True)
            total += np.where((way @ direction < 0.0)[:, None], -way, way)
        return np.asarray(total / np.linalg.norm(total, axis=1, keepdims=True))

    return rule


def over_face(
    surface: NurbsSurface, cutter: Profile, axis: AxisRule, stepover: float, *, along: Literal["u", "v"] = "u",
    allowance: float = 0.0, tolerance: float = 5e-4, points: int = 17,
) -> list[CLMotion]:  # fmt: skip
    """One way to and fro over the whole face, from border to border, that leaves ``allowance`` [mm] along normals.

    A motion a pass, that with the step over to the next one; each begins in the pose in which the last one ends.
    ``points`` a pass to begin with. Neighbouring passes are nowhere more than ``stepover`` [mm] apart. Steps are so
    short that the ball's centre is nowhere more than ``tolerance`` [mm] off.

    Raises InputError for a tool without a ball at its tip, and where the axis leans so far from the face's normal that
    not the ball touches it.
    """
    radius, end = _ball(cutter)
    count = line_count(surface, stepover, along, 0.0)
    check_points(count * points)

    def at(place: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        way, step = _zigzag(place, count)
        shares = (way, step) if along == "u" else (step, way)
        jet = surface.jet(*surface.locate(*shares))
        axes = axis(shares[0], jet)
        return jet.r + (allowance + radius) * jet.normal, axes, np.einsum("ij,ij->i", axes, jet.normal)

    place = np.concatenate([k + np.linspace(0.0, 1.0, 3 if k % 2 else points)[:-1] for k in range(2 * count - 1)])
    place = np.append(place, 2.0 * count - 1.0)
    for _ in range(_ROUNDS):
        centre, axes, cosine = at(place)
        bad = np.flatnonzero(_off(at, place, centre, axes, radius) > tolerance)
        if not len(bad):
            break
        check_points(len(place) + len(bad))
        place = np.insert(place, bad + 1, 0.5 * (place[bad] + place[bad + 1]))
    else:
        raise InputError(f"{surface.name}: steps never become short enough for {1e3 * tolerance:g} um; it has an edge")
    if cosine.min() < np.cos(end) - 1e-9:
        raise InputError(
            f"{surface.name}: at the worst place the axis stands {np.degrees(np.arccos(cosine.min())):.1f} deg to the "
            f"normal, where the ball of {cutter.name} ends at {np.degrees(end):.1f} deg; lean the axis farther"
        )
    starts = np.searchsorted(place, 2.0 * np.arange(count))
    ends = np.append(starts[1:], len(place) - 1)
    return [
        CLMotion((centre - radius * axes)[a : b + 1], np.array(axes[a : b + 1]))
        for a, b in zip(starts, ends, strict=True)
    ]


def _ball(cutter: Profile) -> tuple[float, float]:
    """Radius [mm] of the ball at the tip, and the largest angle [rad] between axis and normal at which it touches."""
    tip = cutter.elements[0]
    if not tip.is_arc or max(map(abs, (tip.centre[0], *tip.start))) > _ON_AXIS:
        raise InputError(f"cutter {cutter.name!r} has no ball at its tip; passes over faces want one")
    return tip.radius, float(tip.angles[1]) + 0.5 * np.pi


def _zigzag(place: NDArray, count: int) -> tuple[NDArray, NDArray]:
    """Shares along and across of places 0 to 2 count - 1: whole passes and the steps over between them in turn."""
    k = np.minimum(place.astype(int), 2 * count - 2)
    share, line = place - k, k // 2
    on_pass = k % 2 == 0
    way = np.where(on_pass, share, 1.0)
    way = np.where(line % 2 == 0, way, 1.0 - way)
    return way, (line + np.where(on_pass, 0.0, share)) / (count - 1)


def _off(
    at: Callable[[NDArray], tuple[NDArray, NDArray, NDArray]], place: NDArray, centre: NDArray, axes: NDArray,
    radius: float,
) -> NDArray:  # fmt: skip
    """How far [mm] the ball's centre is off in the quarters of every step, its axis turning at a constant rate."""
    worst, motion = np.zeros(len(place) - 1), CLMotion(centre - radius * axes, axes)
    for share in (0.25, 0.5, 0.75):
        there, _, _ = at(place[:-1] + share * np.diff(place))
        tip, axis = (s.value for s in motion.pose(np.arange(len(worst)), np.full(len(worst), share), 0))
        worst = np.maximum(worst, np.linalg.norm(tip + radius * axis - there, axis=1))
    return 1.1 * worst
