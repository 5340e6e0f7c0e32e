"""Cutters of every kind of the catalogue, of any size: with round dimensions, or with random ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import radians, tan

import numpy as np

from gearsim.cutters.catalogue import CUTTERS
from gearsim.cutters.profile import Profile
from gearsim.errors import InputError

_TRIES = 200
_ANGLES = (5.0, 10.0, 15.0, 20.0, 30.0, 45.0)


@dataclass(frozen=True)
class Draw:
    """Random dimensions times ``size`` [mm]; ``round_numbers``: quarters of it, and angles in whole degrees."""

    rng: np.random.Generator
    size: float
    round_numbers: bool

    def length(self, low: float, high: float) -> float:
        """A length [mm] between two multiples of the size."""
        value = self.rng.uniform(low, high)
        return self.size * (max(round(4.0 * value), 1) / 4.0 if self.round_numbers else value)

    def angle(self, low: float = 1.0, high: float = 50.0) -> float:
        """An angle [rad] between two in degrees."""
        if self.round_numbers:
            return radians(self.rng.choice([a for a in _ANGLES if low <= a <= high]))
        return radians(self.rng.uniform(low, high))

    def chance(self, share: float) -> bool:
        """True for a share of the draws."""
        return bool(self.rng.random() < share)


def _apt(d: Draw) -> dict[str, float]:
    alpha, beta, e = d.angle(5.0, 30.0), d.angle(5.0, 30.0), d.length(0.0, 2.0)
    if d.chance(0.3):
        return {
            "d": d.length(1.0, 4.0),
            "r": 0.0,
            "e": 0.0,
            "f": 0.0,
            "alpha": alpha,
            "beta": beta,
            "h": d.length(4, 9),
        }
    r = d.length(0.2, 1.0)
    f = e * tan(alpha) + r / np.cos(alpha)
    side = e * np.cos(beta) - f * np.sin(beta) + r
    cut = 1.0 if d.chance(0.5) else d.rng.uniform(0.9, 1.0)
    diameter = cut * 2.0 * side / (np.cos(beta) - tan(alpha) * np.sin(beta))
    return {"d": diameter, "r": r, "e": e, "f": f, "alpha": alpha, "beta": beta, "h": d.length(4.0, 9.0)}


def _edge(d: Draw, high: float) -> float:
    return 0.0 if d.chance(0.5) else d.length(0.05, high)


_DRAWS: dict[str, Callable[[Draw], dict[str, float]]] = {
    "flat": lambda d: {"diameter": d.length(0.5, 4.0), "height": d.length(1.0, 12.0)},
    "ball": lambda d: {"diameter": d.length(0.5, 4.0), "height": d.length(2.0, 12.0)},
    "bull": lambda d: {
        "diameter": d.length(1.0, 4.0), "corner_radius": d.length(0.1, 0.5), "height": d.length(1.0, 12.0)
    },
    "tapered": lambda d: {
        "tip_diameter": d.length(0.3, 3.0), "taper": d.angle() * d.rng.choice([1.0, 1.0, -0.1]),
        "height": d.length(1.0, 12.0),
    },
    "tapered_ball": lambda d: {
        "ball_diameter": d.length(0.3, 3.0), "taper": d.angle(1.0, 40.0), "height": d.length(2.0, 12.0)
    },
    "conical": lambda d: {
        "bottom_radius": d.length(0.1, 2.0), "fillet_radius": d.length(0.1, 1.0), "taper": d.angle(1.0, 40.0),
        "height": d.length(2.0, 12.0),
    },
    "apt": _apt,
    "zhou_apt": lambda d: {
        "height": d.length(4.0, 9.0), "corner_distance": d.length(0.5, 2.0), "corner_radius": d.length(0.2, 1.0),
        "psi_u": d.angle(5.0, 30.0), "psi_l": d.angle(5.0, 30.0),
    },
    "barrel": lambda d: {
        "diameter": d.length(1.0, 4.0), "barrel_radius": d.length(2.0, 20.0), "middle": d.length(0.5, 6.0),
        "height": d.length(1.0, 8.0), "corner_radius": _edge(d, 0.4),
    },
    "oval": lambda d: {
        "diameter": d.length(1.0, 4.0), "barrel_radius": d.length(2.0, 20.0), "ball_radius": d.length(0.1, 1.0),
        "height": d.length(2.0, 8.0),
    },
    "lollipop": lambda d: {
        "ball_diameter": d.length(1.0, 4.0), "neck_diameter": d.length(0.25, 2.0), "height": d.length(4.0, 9.0)
    },
    "t_slot": lambda d: {
        "diameter": d.length(1.0, 6.0), "thickness": d.length(0.25, 2.0), "neck_diameter": d.length(0.25, 2.0),
        "height": d.length(2.0, 9.0), "edge_radius": _edge(d, 0.3),
    },
    "dovetail": lambda d: {
        "diameter": d.length(2.0, 6.0), "flank_angle": d.angle(5.0, 45.0), "thickness": d.length(0.25, 2.0),
        "neck_diameter": d.length(0.25, 2.0), "height": d.length(2.0, 9.0), "edge_radius": _edge(d, 0.1),
    },
    "grinding_cone": lambda d: {
        "diameter": d.length(1.0, 6.0), "half_angle": d.angle(5.0, 50.0), "height": d.length(0.5, 6.0),
        "edge_radius": _edge(d, 0.2),
    },
    "grinding_wheel": lambda d: {
        "diameter": d.length(4.0, 10.0), "rim_width": 0.0 if d.chance(0.2) else d.length(0.25, 2.0),
        "flank_angle": d.angle(5.0, 45.0), "depth": d.length(0.25, 2.0), "edge_radius": _edge(d, 0.2),
    },
    "face_mill_head": lambda d: {
        "radius": d.length(3.0, 12.0), "point_width": d.length(0.5, 2.0), "inner_angle": d.angle(5.0, 30.0),
        "outer_angle": d.angle(5.0, 30.0), "edge_radius": _edge(d, 0.4), "height": d.length(1.0, 3.0),
    },
}  # fmt: skip
KINDS = (*_DRAWS, "whole_cone", "needle")
ALIKE = {"drill": "apt"}  # by another name: APT cutters without a corner are a cone under a cone, too
RINGS = ("face_mill_head",)


def draw(kind: str, rng: np.random.Generator, size: float, round_numbers: bool) -> Profile:
    """A cutter of a kind; dimensions no cutter can have are drawn anew."""
    d = Draw(rng, size, round_numbers)
    for _ in range(_TRIES):
        try:
            return _cutter(kind, d)
        except InputError:
            continue
    raise InputError(f"no {kind} of size {size:g} mm in {_TRIES} draws")


def _cutter(kind: str, d: Draw) -> Profile:
    if kind == "whole_cone":  # from the apex on
        diameter, half = d.length(1.0, 6.0), d.angle(5.0, 45.0)
        return CUTTERS["grinding_cone"](diameter, half, 0.5 * diameter / tan(half))
    if kind == "needle":
        return CUTTERS[d.rng.choice(["flat", "ball"])](d.size * d.rng.choice([0.01, 0.05, 0.25]), d.length(5.0, 20.0))
    return CUTTERS[kind](**_DRAWS[kind](d))
