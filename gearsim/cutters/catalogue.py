"""The catalogue of cutters: parameters in, Profile out. Impossible parameters name the relation that fails."""

from __future__ import annotations

from collections.abc import Callable

from gearsim.cutters.apt import apt, conical, zhou_apt
from gearsim.cutters.end_mills import ball, barrel, bull, drill, flat, oval, tapered, tapered_ball
from gearsim.cutters.grinding import face_mill_head, grinding_cone, grinding_wheel
from gearsim.cutters.profile import Profile
from gearsim.cutters.undercut import dovetail, lollipop, t_slot

__all__ = [
    "CUTTERS",
    "apt",
    "ball",
    "barrel",
    "bull",
    "conical",
    "dovetail",
    "drill",
    "face_mill_head",
    "flat",
    "grinding_cone",
    "grinding_wheel",
    "lollipop",
    "oval",
    "t_slot",
    "tapered",
    "tapered_ball",
    "zhou_apt",
]

_FUNCTIONS: tuple[Callable[..., Profile], ...] = (
    apt, zhou_apt, conical, flat, ball, bull, tapered, tapered_ball, barrel, oval, lollipop, t_slot, dovetail,
    grinding_cone, grinding_wheel, face_mill_head, drill,
)  # fmt: skip

CUTTERS: dict[str, Callable[..., Profile]] = {f.__name__: f for f in _FUNCTIONS}
