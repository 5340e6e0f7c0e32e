"""Errors of a machine's axes: the real machine as a chain of more joints, exact rigid motions all.

Names are those of ISO 230-1:2012 (component errors E_XX, E_YX, ... of linear axes, squareness errors E_C0Y, E_A0Z,
E_B0Z) and ISO 230-7:2015 (location errors of rotary axes). One sign rule holds as for axes (`gearsim.machines.chain`):
positive moves the TOOL relative to the WORKPIECE, along the machine's X, Y, Z or right-handed about them. Errors count
from the axes' zeros: with all axes at zero the set-up is right, and only drift and errors of position there move it.

A slide's carriage carries its errors: behind its own motion, seen from the bed, it is shifted and turned about a
``reference`` point that it carries along. What grows linearly with the axis is a joint of its own there, so that turns
are proper at any size and errors compose as the bodies do.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry import series
from gearsim.geometry.pose import FrameSeries
from gearsim.geometry.series import Series
from gearsim.machines.chain import Joint, Machine, Vector, rotary, slide

_NONE: Vector = (0.0, 0.0, 0.0)
_GROWTH = "spindle growth"


@dataclass(frozen=True)
class SlideErrors:
    """Six component errors of a linear axis at q from its zero, and its backlash.

    It goes (1 + ``scale``) q. ``bow`` [mm] shifts it by -4 (q / bow_length)² bow, along itself (position) or across
    (straightness): a parabola whose middle stands off the chord of any stretch of ``bow_length`` [mm] by the bow.
    ``turn`` [rad/mm] are roll, pitch and yaw: the carriage is turned by the vector turn q about ``reference`` [mm], a
    point of it given in the machine frame with all axes at zero. ``backlash`` [mm]: so much farther on than commanded
    does it stand after a way in its negative direction.
    """

    scale: float = 0.0
    bow: Vector = _NONE
    bow_length: float = 500.0
    turn: Vector = _NONE
    reference: Vector = _NONE
    backlash: float = 0.0

    @property
    def acts(self) -> bool:
        return any((self.scale, *self.bow, *self.turn, self.backlash))


@dataclass(frozen=True)
class RotaryErrors:
    """Where a rotary axis lies, and how far it turns: at the value q it turns by q + zero + scale q + swing
    sin(q + swing_phase).

    ``offset`` [mm] shifts the axis, ``tilt`` [rad] turns it about its point: the workpiece (or tool) set up with it
    at zero stays where it is. ``backlash`` [rad] as of slides.
    """

    offset: Vector = _NONE
    tilt: Vector = _NONE
    zero: float = 0.0
    scale: float = 0.0
    swing: float = 0.0
    swing_phase: float = 0.0
    backlash: float = 0.0

    @property
    def acts(self) -> bool:
        return any((*self.offset, *self.tilt, self.zero, self.scale, self.swing, self.backlash))


@dataclass(frozen=True)
class Squareness:
    """How slides named X, Y, Z lie to each other, X being straight [rad]: Y is turned by ``c0y`` about the machine's Z,
    Z by ``a0z`` about X and ``b0z`` about Y (as one vector)."""

    c0y: float = 0.0
    a0z: float = 0.0
    b0z: float = 0.0

    def turn(self, name: str) -> Vector:
        """What the axis of a name is turned by [rad]."""
        return {"Y": (0.0, 0.0, self.c0y), "Z": (self.a0z, self.b0z, 0.0)}.get(name, _NONE)


@dataclass(frozen=True)
class Growth:
    """The spindle's growth with time: the tool moves out of it, against its axis (tip to shank), by
    amount (1 - exp(-t / minutes)) + rate t; ``amount`` [mm], ``rate`` [mm/min], t in minutes."""

    amount: float = 0.0
    minutes: float = 30.0
    rate: float = 0.0

    def after(self, time: Series) -> Series:
        """The growth [mm] at times [min]."""
        grown = time * self.rate
        return grown - (series.exp(time * (-1.0 / self.minutes)) - 1.0) * self.amount if self.amount else grown


@dataclass(frozen=True)
class MachineErrors:
    """All errors of a machine: by the names of its axes, of their squareness, and the spindle's growth."""

    slides: Mapping[str, SlideErrors] = field(default_factory=dict)
    rotaries: Mapping[str, RotaryErrors] = field(default_factory=dict)
    squareness: Squareness = field(default=Squareness())
    growth: Growth = field(default=Growth())

    @property
    def act(self) -> bool:
        """Whether any error is not zero."""
        axes = [e.acts for e in self.slides.values()] + [e.acts for e in self.rotaries.values()]
        return any(axes) or self.squareness != Squareness() or self.grows

    @property
    def grows(self) -> bool:
        return bool(self.growth.amount or self.growth.rate)

    def real(self, nominal: Machine) -> RealMachine | None:
        """The machine with these errors; None where all are zero. Raises InputError for axes that it has not."""
        for kind, given in (("linear", self.slides), ("rotary", self.rotaries)):
            there = [joint.name for joint in nominal.joints if joint.is_rotary == (kind == "rotary")]
            for name, errors in given.items():
                if errors.acts and name not in there:
                    raise InputError(f"no {kind} axis {name}; {nominal.name} has {', '.join(there)}")
        for name in ("Y", "Z"):
            if any(self.squareness.turn(name)) and name not in nominal.axes:
                raise InputError(f"squareness: no axis {name}; {nominal.name} has {', '.join(nominal.axes)}")
        return RealMachine(nominal, self) if self.act else None


class Law(NamedTuple):
    """What a joint of the real chain does while the axis in ``column`` (of the nominal machine) stands at q:
    constant + linear q + square q² + swing sin(q + phase), and what the axis has ``lost``."""

    column: int
    constant: float = 0.0
    linear: float = 0.0
    square: float = 0.0
    swing: float = 0.0
    phase: float = 0.0
    lost: bool = False

    def value(self, q: Series, lost: Series | None) -> Series:
        moved = q if self.linear == 1.0 else q * self.linear
        if self.square:
            moved = moved + q * q * self.square
        if self.swing:
            moved = moved + series.exp((q + self.phase) * 1j).imag * self.swing
        if self.constant:
            moved = moved + self.constant
        return moved + lost if self.lost and lost is not None else moved


@dataclass(frozen=True)
class RealMachine:
    """A machine with errors: what it does where a control that knows the ``nominal`` one sends its axes.

    ``errors`` that are zero add nothing to the chain.
    """

    nominal: Machine
    errors: MachineErrors

    @property
    def backlash(self) -> NDArray[np.floating]:
        """Of every axis [mm, rad], (k,), in the nominal machine's order."""
        given = {name: e.backlash for name, e in self.errors.slides.items()}
        given |= {name: e.backlash for name, e in self.errors.rotaries.items()}
        return np.array([given.get(name, 0.0) for name in self.nominal.axes])

    def forward(self, values: NDArray, lost: NDArray | None = None, minutes: float = 0.0) -> tuple[NDArray, NDArray]:
        """Tips [mm] and unit axes, both (n, 3), workpiece frame, of commanded axis values (n, k), ``minutes`` after
        the start; ``lost`` (n, k) is what backlash adds to them [mm, rad]."""
        behind = None if lost is None else self.nominal.constant(lost)
        commanded = self.nominal.constant(values)
        tip, axis, _ = self.frame_series(commanded, behind, Series(np.full((1, len(values)), minutes)))
        return tip.value, axis.value

    def frame_series(
        self, values: list[Series], lost: Sequence[Series] | None = None, time: Series | None = None
    ) -> FrameSeries:
        """Full tool frames as exact series: ``values`` are commanded, one series (n,) an axis; ``lost`` is what
        backlash adds to each of them, ``time`` [min] counts from the start (default: there is neither)."""
        chain, laws = self._chain
        still, moved = Series(np.zeros_like(values[0].c)), []
        for joint in chain.joints:
            if joint.name == _GROWTH:
                moved.append(self.errors.growth.after(still if time is None else time))
            else:
                law = laws[joint.name]
                moved.append(law.value(values[law.column], None if lost is None else lost[law.column]))
        return chain.frame_series(moved)

    @cached_property
    def _chain(self) -> tuple[Machine, dict[str, Law]]:
        """The real chain as a machine of more joints, and what each of them does."""
        links = {joint.name: self._links(joint) for joint in self.nominal.chain}
        laws = {joint.name: law for found in links.values() for joint, law in found}
        tool, work = (
            tuple(joint for own in joints for joint, _ in links[own.name])
            for joints in (self.nominal.tool, self.nominal.work)
        )
        if self.errors.grows:
            x, y, z = (-self.nominal.tool_mount.rotation[:, 2]).tolist()
            tool = (*tool, slide(_GROWTH, (x, y, z)))
        return replace(self.nominal, tool=tool, work=work), laws

    def _links(self, joint: Joint) -> list[tuple[Joint, Law]]:
        """A joint as it really lies, and the errors that its carriage carries, from the bed outward."""
        column = self.nominal.column(joint)
        if joint.is_rotary:
            e = self.errors.rotaries.get(joint.name, RotaryErrors())
            x, y, z = np.add(joint.point, e.offset).tolist()
            real = replace(joint, point=(x, y, z), direction=_turned(joint.direction, e.tilt))
            return [(real, Law(column, e.zero, 1.0 + e.scale, 0.0, e.swing, e.swing_phase, e.backlash != 0.0))]
        s = self.errors.slides.get(joint.name, SlideErrors())
        real = replace(joint, direction=_turned(joint.direction, self.errors.squareness.turn(joint.name)))
        links = [(real, Law(column, linear=1.0 + s.scale, lost=s.backlash != 0.0))]
        if any(s.bow):
            most, way = _split(s.bow)
            links.append((slide(f"{joint.name} bow", way), Law(column, square=-4.0 * most / s.bow_length**2)))
        if any(s.turn):
            most, about = _split(s.turn)
            links.append((rotary(f"{joint.name} turn", about, s.reference), Law(column, linear=most)))
        return links


def _split(vector: Vector) -> tuple[float, Vector]:
    """A vector's length and direction."""
    length = float(np.linalg.norm(vector))
    x, y, z = (np.array(vector) / length).tolist()
    return length, (x, y, z)


def _turned(direction: Vector, turn: Vector) -> Vector:
    """A unit direction turned by a vector [rad]."""
    if not any(turn):
        return direction
    angle, about = _split(turn)
    d, k = np.array(direction), np.array(about)
    new = d * np.cos(angle) + np.cross(k, d) * np.sin(angle) + k * (k @ d) * (1.0 - np.cos(angle))
    x, y, z = (new / np.linalg.norm(new)).tolist()
    return x, y, z
