"""Machines as data: the chain of joints that leads from the workpiece over the bed to the tool.

Every joint's line is given in the machine frame with all axes at zero (product of exponentials: Murray, Li
and Sastry 1994, section 3.2). One sign rule holds for all: a positive value moves the TOOL relative to the
WORKPIECE along ``direction``, or turns it right-handed about it (ISO 841). A joint that carries the
workpiece therefore itself moves the other way: a table's C+ is clockwise seen from +Z.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import inf
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.errors import InputError
from gearsim.geometry import series
from gearsim.geometry.pose import FrameSeries, PoseSeries
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.series import Series

Vector = tuple[float, float, float]
AT_REST = Rigid(np.eye(3), np.zeros(3))


@dataclass(frozen=True)
class Joint:
    """One axis of a machine: a slide (prismatic, mm) or a rotary axis (revolute, rad).

    ``direction`` is a unit vector and ``point`` [mm] a point of a rotary axis, both in the machine frame
    with all axes at zero; ``lower`` and ``upper`` are the travel limits.
    """

    name: str
    kind: Literal["prismatic", "revolute"]
    direction: Vector
    point: Vector = (0.0, 0.0, 0.0)
    lower: float = -inf
    upper: float = inf

    def __post_init__(self) -> None:
        length = float(np.linalg.norm(self.direction))
        if abs(length - 1.0) > 1e-12:
            raise InputError(f"axis {self.name}: its direction must have length 1, not {length:g}")
        if not self.lower < self.upper:
            raise InputError(f"axis {self.name}: lower limit {self.lower:g} must be below upper limit {self.upper:g}")

    @property
    def is_rotary(self) -> bool:
        return self.kind == "revolute"


def slide(name: str, direction: Vector) -> Joint:
    """A linear axis without travel limits."""
    return Joint(name, "prismatic", direction)


def rotary(name: str, direction: Vector, point: Vector = (0.0, 0.0, 0.0)) -> Joint:
    """A rotary axis without travel limits."""
    return Joint(name, "revolute", direction, point)


@dataclass(frozen=True)
class Machine:
    """Joints that carry the tool and joints that carry the workpiece, each listed from the bed outward.

    ``tool_mount`` and ``work_mount`` place tool and workpiece frame in the machine frame with all axes at
    zero. Axis values are arrays (n, k) [mm, rad] in the order of ``axes``: slides first, then rotary axes,
    each by name. Raises InputError where two axes share a name.
    """

    name: str
    tool: tuple[Joint, ...]
    work: tuple[Joint, ...]
    tool_mount: Rigid = field(default=AT_REST)
    work_mount: Rigid = field(default=AT_REST)

    def __post_init__(self) -> None:
        if len(set(self.axes)) < len(self.axes):
            raise InputError(f"machine {self.name}: axis names must differ, got {', '.join(self.axes)}")

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """The joints in the order of the axis values."""
        return tuple(sorted(self.chain, key=lambda joint: (joint.is_rotary, joint.name)))

    @property
    def axes(self) -> tuple[str, ...]:
        """The names of the axes, in the order of the axis values."""
        return tuple(joint.name for joint in self.joints)

    @property
    def chain(self) -> tuple[Joint, ...]:
        """All joints on the way from the workpiece to the tool."""
        return (*reversed(self.work), *self.tool)

    def column(self, joint: Joint) -> int:
        """Where a joint's values stand among the axis values."""
        return self.joints.index(joint)

    def values(self, **axes: ArrayLike) -> NDArray[np.floating]:
        """Axis values (n, k) from values by name; axes not named are zero. Raises InputError for unknown names."""
        if unknown := sorted(set(axes) - set(self.axes)):
            raise InputError(f"machine {self.name} has no axis {unknown[0]}; it has {', '.join(self.axes)}")
        columns = [np.atleast_1d(np.asarray(axes.get(name, 0.0), dtype=float)) for name in self.axes]
        return np.stack(np.broadcast_arrays(*columns), axis=-1)

    def limited(self, **limits: tuple[float, float]) -> Machine:
        """The same machine with travel limits (lower, upper) [mm or rad] on the named axes."""
        if unknown := sorted(set(limits) - set(self.axes)):
            raise InputError(f"machine {self.name} has no axis {unknown[0]}; it has {', '.join(self.axes)}")

        def bound(joints: Iterable[Joint]) -> tuple[Joint, ...]:
            ends = ((j, limits.get(j.name, (j.lower, j.upper))) for j in joints)
            return tuple(replace(j, lower=lower, upper=upper) for j, (lower, upper) in ends)

        return replace(self, tool=bound(self.tool), work=bound(self.work))

    def forward(self, values: NDArray) -> tuple[NDArray, NDArray]:
        """Tips [mm] and unit axes, both (n, 3), workpiece frame, of axis values (n, k)."""
        tip, axis = self.forward_series(self.constant(values))
        return tip.value, axis.value

    def forward_frame(self, values: NDArray) -> tuple[NDArray, NDArray]:
        """Tool frames in the workpiece frame: rotations (n, 3, 3), tool to workpiece, and origins (n, 3) [mm]."""
        tip, axis, radial = (part.value for part in self.frame_series(self.constant(values)))
        return np.stack([radial, np.cross(axis, radial), axis], axis=-1), tip

    def forward_series(self, values: list[Series]) -> PoseSeries:
        """Poses as exact series; ``values`` holds one series of shape (n,) an axis, of equal order."""
        return self.frame_series(values).pose

    def frame_series(self, values: list[Series]) -> FrameSeries:
        """Full tool frames as exact series; see ``forward_series``."""
        mount = self.tool_mount
        rows = self.walk(values, np.stack([mount.rotation[:, 0], mount.rotation[:, 2], mount.translation]))
        radial, axis, tip = (Series(rows.c[..., i, :]) for i in range(3))
        return FrameSeries(tip, axis, radial)

    def slide_directions(self, values: NDArray) -> NDArray:
        """What a unit of each slide moves the tip by, workpiece frame: (n, 3, slides), columns as in ``axes``."""
        return self.slide_direction_series(self.constant(values)).value

    def slide_direction_series(self, values: list[Series]) -> Series:
        """The same as exact series, (order + 1, n, 3, slides)."""
        together: dict[int, list[Joint]] = {}  # slides with the same rotary axes between them and the workpiece
        for i, joint in enumerate(self.chain):
            if not joint.is_rotary:
                together.setdefault(sum(j.is_rotary for j in self.chain[:i]), []).append(joint)
        columns = {}
        for slides in together.values():
            rows = np.stack([*(np.asarray(joint.direction) for joint in slides), np.zeros(3)])
            moved = self.walk(values, rows, slides[0]).c
            columns.update({joint.name: moved[..., i, :] for i, joint in enumerate(slides)})
        return Series(np.stack([columns[joint.name] for joint in self.joints if not joint.is_rotary], axis=-1))

    def constant(self, values: NDArray) -> list[Series]:
        """Axis values (n, k) as series of order 0."""
        if np.ndim(values) != 2 or np.shape(values)[1] != len(self.axes):
            raise InputError(
                f"machine {self.name}: expected axis values of shape (n, {len(self.axes)}) for "
                f"{', '.join(self.axes)}, got shape {np.shape(values)}"
            )
        return [Series(np.asarray(values, dtype=float)[None, :, i]) for i in range(len(self.axes))]

    def walk(self, values: list[Series], rows: NDArray, start: Joint | None = None) -> Series:
        """Carry vectors from the tool, or from joint ``start``, to the workpiece frame.

        ``rows`` (m, 3) are given in the machine frame at zero: directions, the last one a point [mm].
        Returns (order + 1, n, m, 3).
        """
        chain = self.chain if start is None else self.chain[: self.chain.index(start)]
        moved = Series(np.zeros((*values[0].c.shape, *rows.shape))) + rows
        for joint in reversed(chain):
            moved = _carry(joint, values[self.column(joint)], moved)
        back = self.work_mount.inverse()
        turned = back.direction(moved.c)
        turned[0, :, -1] += back.translation
        return Series(turned)


def _carry(joint: Joint, value: Series, rows: Series) -> Series:
    """Move the rows (directions, last one a point) by one joint."""
    direction, point = np.asarray(joint.direction), np.asarray(joint.point)
    if not joint.is_rotary:
        moved = rows.c.copy()
        moved[..., -1, :] += value.c[..., None] * direction
        return Series(moved)
    origin = np.zeros(rows.c.shape[-2:])
    origin[-1] = point
    rows = rows - origin
    turn = series.exp(value * 1j).column
    aligned = np.flatnonzero(np.abs(direction) == 1.0)
    if len(aligned):
        return _about_axis(int(aligned[0]), turn.real, turn.imag * float(direction[aligned[0]]), rows) + origin
    turn = turn.column
    along = Series((rows.c @ direction)[..., None] * direction)
    across = rows - along
    return along + turn.real * across + turn.imag * Series(np.cross(direction, rows.c)) + origin


def _about_axis(k: int, cosine: Series, sine: Series, rows: Series) -> Series:
    """Rows turned about axis k of the frame: a third of the work where that is the joint's, as it mostly is."""
    i, j = (k + 1) % 3, (k + 2) % 3
    a, b = Series(rows.c[..., i]), Series(rows.c[..., j])
    moved = rows.c.copy()
    moved[..., i], moved[..., j] = (cosine * a - sine * b).c, (cosine * b + sine * a).c
    return Series(moved)
