"""Short motions of every kind, near the origin: a few rows of the table that the removal road is given."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry import series
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.series import Series
from gearsim.machines.catalogue import head_b_table_c, head_head_cb, table_table_ac, table_table_bc
from gearsim.motion.axes import AxisMotion, tip_control
from gearsim.motion.segments import SegmentTable, compile_motion
from gearsim.motion.sources import CLMotion, CurveMotion, MotionSource

_ROWS = 3
_DIGITS = 2.0**36


def _direction(rng: np.random.Generator) -> NDArray:
    v = rng.normal(size=3)
    return v / np.linalg.norm(v)


def _grid_axis(rng: np.random.Generator) -> NDArray:
    return np.eye(3)[rng.integers(3)] * rng.choice([-1.0, 1.0])


def _grid_point(rng: np.random.Generator, size: float) -> NDArray:
    return 0.5 * size * rng.integers(-12, 13, 3)


def _travel(rng: np.random.Generator, size: float) -> float:
    return float(size * 10.0 ** rng.uniform(-3.0, 1.0))


def _tilted(rng: np.random.Generator, axis: NDArray, most_deg: float) -> NDArray:
    turn = np.radians(most_deg * 10.0 ** rng.uniform(-3.0, 0.0))
    across = np.cross(axis, _direction(rng))
    return np.cos(turn) * axis + np.sin(turn) * across / np.linalg.norm(across)


def grid(rng: np.random.Generator, size: float) -> MotionSource:
    """Between two points of the half-size grid, along an axis or across, the tool upright on it."""
    start = _grid_point(rng, size)
    step = 0.5 * size * rng.integers(-10, 11, 3) * (_grid_axis(rng) != 0 if rng.random() < 0.7 else 1)
    axis = np.array([0.0, 0.0, 1.0]) if rng.random() < 0.6 else _grid_axis(rng)
    return CLMotion(np.array([start, start + step]), np.array([axis, axis]))


def straight(rng: np.random.Generator, size: float) -> MotionSource:
    """A straight line with a slanted axis, which stands still or turns."""
    start, axis = size * rng.uniform(-5.0, 5.0, 3), _direction(rng)
    end = start + _travel(rng, size) * _direction(rng)
    return CLMotion(np.array([start, end]), np.array([axis, _tilted(rng, axis, 3.0) if rng.random() < 0.7 else axis]))


def about_tip(rng: np.random.Generator, size: float) -> MotionSource:
    """The tip stands, at a round place or not, while the axis turns by up to half a degree."""
    upright = rng.random() < 0.5
    tip, axis = (_grid_point(rng, size), _grid_axis(rng)) if upright else (size * _direction(rng), _direction(rng))
    return CLMotion(np.array([tip, tip]), np.array([axis, _tilted(rng, axis, 0.5)]))


def standing(rng: np.random.Generator, size: float) -> MotionSource:
    """A tool that does not move at all."""
    tip, axis = _grid_point(rng, size), _grid_axis(rng) if rng.random() < 0.5 else _direction(rng)
    return CLMotion(np.array([tip, tip]), np.array([axis, axis]))


def arc(rng: np.random.Generator, size: float) -> MotionSource:
    """A tip on a circle about an upright axis, or a screw; the axis goes round with it, or stands."""
    radius, sweep = _travel(rng, size) + 0.01 * size, np.radians(10.0 ** rng.uniform(-1.0, 0.7))
    rise = rng.choice([0.0, 1.0]) * _travel(rng, size)
    axis = np.array([0.0, 0.0, 1.0]) if rng.random() < 0.4 else _direction(rng)
    first, round_with = rng.choice([0.0, 0.5, 1.0]) * np.pi, rng.random() < 0.5
    if not round_with:
        sweep *= 10.0

    def curve(values: NDArray, order: int) -> PoseSeries:
        t = Series.variable(values, order)
        turn = series.exp((t * sweep + first) * 1j)
        tip = series.stack([turn.real * radius, turn.imag * radius, t * rise])
        if not round_with:
            return PoseSeries(tip, Series(np.zeros_like(tip.c)) + axis)
        about = series.stack(
            [turn.real * axis[0] - turn.imag * axis[1], turn.imag * axis[0] + turn.real * axis[1], t * 0.0 + axis[2]]
        )
        return PoseSeries(tip, about)

    return CurveMotion(curve, 0.0, 1.0)


def nc(rng: np.random.Generator, size: float) -> MotionSource:
    """One block of a five-axis machine, all axes linear or with tip control."""
    table, head = (0.0, 0.0, -20.0 * size), 30.0 * size
    machine = [table_table_bc(table), table_table_ac(table), head_head_cb(head), head_b_table_c(head)][rng.integers(4)]
    rotary = np.radians(rng.uniform(-60.0, 60.0, 2))
    turned = np.radians(10.0 ** rng.uniform(-3.0, 0.0)) * rng.uniform(-1.0, 1.0, 2)
    values = np.zeros((2, 5))
    values[0] = [*(size * rng.uniform(-5.0, 5.0, 3)), *rotary]
    values[1] = values[0] + [*(_travel(rng, size) * _direction(rng)), *turned]
    motion = AxisMotion(machine, values)
    return motion if rng.random() < 0.5 else tip_control(machine, values)


def quintic(rng: np.random.Generator, size: float) -> MotionSource:
    """A tip on a polynomial of the fifth degree, which may turn round several times, under a slowly turning axis."""
    c = _travel(rng, size) * rng.normal(size=(6, 3)) * rng.choice([1.0, 0.1, 4.0], size=(6, 1))
    axis = np.array([0.0, 0.0, 1.0]) if rng.random() < 0.5 else _direction(rng)
    drift = 0.01 * 10.0 ** rng.uniform(-4.0, 0.0) * rng.normal(size=(2, 3)) * (rng.random() < 0.6)

    def curve(values: NDArray, order: int) -> PoseSeries:
        t = Series.variable(values, order).column
        tip = Series(np.zeros((order + 1, len(values), 3)))
        for k in range(5, -1, -1):
            tip = tip * t + c[k]
        return PoseSeries(tip, series.unit(t * drift[0] + t * t * drift[1] + axis))

    return CurveMotion(curve, -1.0, 1.0)


KINDS: dict[str, Callable[[np.random.Generator, float], MotionSource]] = {
    "grid": grid, "straight": straight, "about_tip": about_tip, "standing": standing, "arc": arc, "nc": nc,
    "quintic": quintic,
}  # fmt: skip


def rows(kind: str, rng: np.random.Generator, size: float, reach: float) -> SegmentTable:
    """A few consecutive rows of a motion of a kind, as they are compiled for a tool of that reach [mm].

    Of motions on the grid half are cleared of what rounding left in the polynomials: then touches are exact.
    """
    table = compile_motion(KINDS[kind](rng, size), reach)
    first = int(rng.integers(max(len(table) - _ROWS, 0) + 1))
    table = table.part(slice(first, first + int(rng.integers(1, _ROWS + 1))))
    if kind not in ("grid", "standing") or rng.random() < 0.5:
        return table
    whole = np.round(table.axis)
    axis = np.where(np.abs(table.axis - whole) < 1e-12, whole, table.axis)
    return replace(table, tip=size * np.round(table.tip / size * _DIGITS) / _DIGITS, axis=axis)
