"""Axis values of a machine for a wanted pose: closed form, both branches, any directions of the rotary axes.

The two rotary axes nearest the workpiece, w1 and w2 (w1 nearer), turn a direction z0 fixed to the tool into the
wanted one, a. Seen on the unit sphere, w1, w2 and the turned direction are the corners of a triangle whose
sides are known: s1 = (w1, a), s2 = (w2, z0) and (w1, w2). The angle at w2 follows from the half-angle
formula, which stays accurate where the two branches meet; w1 then turns the result onto a (the
Paden-Kahan subproblem 2 of Murray, Li and Sastry 1994, section 3.3). The slides follow from three linear
equations. On the Phoenix this is Litvin and Chen (16) to (19).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.errors import InputError
from gearsim.geometry import series
from gearsim.geometry.series import Series
from gearsim.machines.chain import Joint, Machine

PARALLEL_RAD = 1e-12
_REACH_RAD = 1e-10
FLAT = 1e-9
_UNIT = 1e-6


@dataclass(frozen=True)
class Branches:
    """Axis values (2, n, k) [mm, rad] of both branches, rotary ones in -pi to pi; they merge where they meet.

    ``free`` (n,): the turned direction is parallel to the rotary axis nearest the workpiece, which may then
    stand anywhere (here: at zero).
    """

    values: NDArray[np.floating]
    free: NDArray[np.bool_]


def inverse_pose(machine: Machine, tip: NDArray, axis: NDArray, spin: ArrayLike = 0.0) -> Branches:
    """All axis values that bring the tool to tips [mm] and unit axes, both (n, 3), workpiece frame.

    ``spin`` [rad] is the value of the tool's own rotary axis, where the machine has one. Raises InputError
    where the machine cannot: wrong joints, an axis out of reach, or parallel slides.
    """
    solver = Solver(machine, frame=False)
    first, second, free = solver.turn(axis)
    both = [solver.complete_pose(tip, v1, v2, spin) for v1, v2 in zip(first, second, strict=True)]
    return Branches(np.stack(both), free)


def inverse_frame(machine: Machine, rotation: NDArray, origin: NDArray) -> Branches:
    """All axis values for full tool frames: rotations (n, 3, 3), tool to workpiece, and origins (n, 3) [mm].

    Needs three slides and three rotary axes. Raises InputError as ``inverse_pose`` does.
    """
    solver = Solver(machine, frame=True)
    first, second, free = solver.turn(rotation @ solver.aim)
    both = [solver.complete_frame(rotation, origin, v1, v2) for v1, v2 in zip(first, second, strict=True)]
    return Branches(np.stack(both), free)


def reach_tip(machine: Machine, values: NDArray, tip: NDArray) -> NDArray:
    """Axis values (n, k) with the rotary ones kept and the slides set so that the tips (n, 3) [mm] are reached.

    Raises InputError where the rotary axes turn the three slides into one plane.
    """
    values = np.where([joint.is_rotary for joint in machine.joints], values, 0.0)
    directions = machine.slide_directions(values)
    volume = np.abs(np.linalg.det(directions))
    if len(volume) and volume.min() < FLAT:
        i = int(volume.argmin())
        raise InputError(
            f"machine {machine.name}, point {i + 1}: its rotary axes turn the slides into one plane, so that "
            "they cannot reach the tip; choose other rotary positions"
        )
    rest = np.asarray(tip, dtype=float) - machine.forward(values)[0]
    values[:, : directions.shape[-1]] = np.linalg.solve(directions, rest[..., None])[..., 0]
    return values


def reach_tip_series(machine: Machine, values: list[Series], tip: Series) -> list[Series]:
    """Axis values as series, the rotary ones kept and the three slides set so that the tip (n, 3) [mm] is followed."""
    still, slides = Series(np.zeros_like(values[0].c)), sum(not joint.is_rotary for joint in machine.joints)
    turned = [still if i < slides else value for i, value in enumerate(values)]
    rest = tip - machine.forward_series(turned).tip
    directions = machine.slide_direction_series(turned).c
    a, b, c = (Series(directions[..., i]) for i in range(3))
    across = [series.cross(b, c), series.cross(c, a), series.cross(a, b)]
    volume = series.dot(a, across[0])
    return [*(series.dot(normal, rest) / volume for normal in across), *values[slides:]]


def wrap(angle: NDArray) -> NDArray:
    """Angles [rad] brought into -pi to pi."""
    return (angle + np.pi) % (2.0 * np.pi) - np.pi


@dataclass(frozen=True)
class Solver:
    """The inverse of one machine, in two steps: the two rotary axes, then everything else.

    ``frame``: for full tool frames; otherwise for tip and axis. Raises InputError for unsuited machines.
    """

    machine: Machine
    frame: bool

    def __post_init__(self) -> None:
        slides = len(self.machine.joints) - len(self.rotaries)
        wanted = (
            "3 slides and 3 rotary axes" if self.frame else "3 slides and 2 rotary axes (or 3, the last the tool's)"
        )
        what = "a full tool frame" if self.frame else "a tip and a tool axis"
        count = len(self.rotaries)
        if slides != 3 or (count != 3 if self.frame else count not in (2, 3)):
            raise InputError(
                f"machine {self.machine.name} has {slides} slides and {count} rotary axes; to set {what} "
                f"it needs {wanted}"
            )
        if not self.frame and count == 3 and not self._spins:
            raise InputError(
                f"machine {self.machine.name}: rotary axis {self.rotaries[2].name} is not the tool's own axis; "
                "a tip and a tool axis do not settle three rotary axes"
            )
        for a, b in ((self._w1, self._w2), (self._w2, self.z0)):
            if np.linalg.norm(np.cross(a, b)) < FLAT:
                first, second = (j.name for j in self.rotaries[:2])
                raise InputError(
                    f"machine {self.machine.name}: rotary axes {first} and {second} cannot tilt the tool any "
                    "way: two neighbours among them and the tool axis are parallel"
                )

    @cached_property
    def rotaries(self) -> tuple[Joint, ...]:
        """The rotary joints from the workpiece to the tool."""
        return tuple(joint for joint in self.machine.chain if joint.is_rotary)

    @cached_property
    def z0(self) -> NDArray:
        """The direction that the two rotary axes turn, machine frame at zero: third rotary or tool axis."""
        return np.asarray(self.rotaries[2].direction) if self.frame else self.machine.tool_mount.rotation[:, 2]

    @cached_property
    def aim(self) -> NDArray:
        """The same direction in the tool frame."""
        return self.machine.tool_mount.rotation.T @ self.z0

    @property
    def _w1(self) -> NDArray:
        return np.asarray(self.rotaries[0].direction)

    @property
    def _w2(self) -> NDArray:
        return np.asarray(self.rotaries[1].direction)

    @property
    def _spins(self) -> bool:
        """Whether the third rotary axis is the tool's own: at its end, along its axis, through its tip."""
        joint, mount = self.rotaries[2], self.machine.tool_mount
        off = np.cross(joint.direction, mount.translation - np.asarray(joint.point))
        aligned = np.linalg.norm(np.cross(joint.direction, mount.rotation[:, 2])) < FLAT
        return bool(aligned and np.linalg.norm(off) < FLAT and self.machine.chain[-1] is joint)

    def turn(self, wanted: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """Both branches of the two rotary axes, (2, n) each, and where the first is free, (n,).

        ``wanted`` (n, 3): unit directions in the workpiece frame that z0 is to take.
        """
        a = self.machine.work_mount.direction(np.asarray(wanted, dtype=float))
        length = np.linalg.norm(a, axis=-1)
        if not np.all(np.abs(length - 1.0) < _UNIT):
            i = int(np.argmin(np.abs(length - 1.0) < _UNIT))
            raise InputError(f"point {i + 1}: the tool axis must have length 1, not {length[i]:.6g}")
        s1, s2, s12 = _angle(self._w1, a), _angle(self._w2, self.z0), _angle(self._w1, self._w2)
        self._check_reach(s1, abs(s12 - s2), min(s12 + s2, 2.0 * np.pi - s12 - s2))
        half = 0.5 * (s1 + s2 + s12)
        over = np.sin(half - s12) * np.sin(half - s2)
        under = np.sin(half) * np.sin(half - s1)
        corner = 2.0 * np.arctan2(np.sqrt(np.maximum(over, 0.0)), np.sqrt(np.maximum(under, 0.0)))
        start = _turn_between(self._w2, self.z0, self._w1)
        second = wrap(np.stack([corner, -corner]) + start)
        free = np.sin(s1) < PARALLEL_RAD
        turned = _rotate(self._w2, second, self.z0)
        first = np.where(free, 0.0, _turn_between(self._w1, turned, a))
        return first, second, free

    def complete_pose(self, tip: NDArray, first: NDArray, second: NDArray, spin: ArrayLike) -> NDArray:
        """Axis values (n, k) for tips, once the two rotary axes are known."""
        values = np.zeros((len(first), len(self.machine.axes)))
        for joint, angle in zip(self.rotaries, (first, second, spin), strict=False):
            values[:, self.machine.column(joint)] = angle
        return reach_tip(self.machine, values, tip)

    def complete_frame(self, rotation: NDArray, origin: NDArray, first: NDArray, second: NDArray) -> NDArray:
        """Axis values (n, k) for full frames, once the two rotary axes nearest the workpiece are known."""
        mount, work = self.machine.tool_mount.rotation, self.machine.work_mount.rotation
        side = np.eye(3)[int(np.argmin(np.abs(self.z0)))]
        turned = work @ rotation @ (mount.T @ side)
        back = _rotate(self._w2, -second, _rotate(self._w1, -first, turned))
        return self.complete_pose(origin, first, second, _turn_between(self.z0, side, back))

    def _check_reach(self, s1: NDArray, low: float, high: float) -> None:
        off = np.maximum(low - s1, s1 - high)
        if len(off) and off.max() > _REACH_RAD:
            i = int(off.argmax())
            first, second = (j.name for j in self.rotaries[:2])
            raise InputError(
                f"machine {self.machine.name}, point {i + 1}: {np.degrees(s1[i]):.6g} deg between the wanted "
                f"direction and axis {first} is out of reach; {first} and {second} reach "
                f"{np.degrees(low):.6g} to {np.degrees(high):.6g} deg"
            )


def _angle(a: NDArray, b: NDArray) -> NDArray:
    """Angle between directions, accurate near 0 and pi too."""
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), b @ a)


def _rotate(w: NDArray, angle: NDArray, v: NDArray) -> NDArray:
    """Turn v, (3,) or (n, 3), about w by angles of shape (..., n)."""
    along = (v @ w)[..., None] * w
    c, s = np.cos(angle)[..., None], np.sin(angle)[..., None]
    return along + c * (v - along) + s * np.cross(w, v)


def _turn_between(w: NDArray, a: NDArray, b: NDArray) -> NDArray:
    """Angle by which a is to be turned about w so that it lies in b's half plane."""
    across = a - (a @ w)[..., None] * w
    other = b - (b @ w)[..., None] * w
    return np.arctan2(np.cross(across, other) @ w, (across * other).sum(axis=-1))
