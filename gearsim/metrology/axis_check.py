"""Whether a program keeps to its machine's travel, and to how fast each axis goes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import degrees, isfinite
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rigid import Rigid
from gearsim.machines.chain import Joint
from gearsim.metrology.findings import Finding, axis_beyond
from gearsim.metrology.inspection import Reading, Steps
from gearsim.motion.axis_travel import Travel, axis_travel
from gearsim.programs.blocks import Blocks

if TYPE_CHECKING:
    from gearsim.metrology.job import Job

_ROUNDING = 1e-9


@dataclass(frozen=True)
class AxisFigures:
    """An axis: what it goes through [mm, rad], how fast it goes in feed and may go [per s] (inf: nothing says it)."""

    joint: Joint
    least: float
    largest: float
    fastest: float
    max_feed: float


@dataclass(frozen=True)
class AxisMeasurement:
    """What the axes do; ``rapid_s`` is how long rapids take (nan: the rate of an axis that moves is not named).

    ``axes`` are none where no program for a machine is known.
    """

    variant: str
    axes: tuple[AxisFigures, ...]
    rapid_s: float
    surface: str = ""
    inspection: str = "machine axes"


@dataclass(frozen=True)
class AxisInspection:
    """The ``blocks`` of a program, its operations' ``names``, how fast axes go by name, in feed and by rapid [per s].

    ``frame`` takes the machine's workpiece to the part. Limits of travel are the machine's own, as the program counts:
    from the work offset. ``blocks`` are None where no program for a machine is known. ``homing`` (n,) are those that go
    home, where a program of a control also begins (None: of no control): where that is, nobody states.
    """

    variant: str
    blocks: Blocks | None
    frame: Rigid
    names: tuple[str, ...] = ()
    max_feed: Mapping[str, float] = field(default_factory=dict)
    max_rapid: Mapping[str, float] = field(default_factory=dict)
    homing: NDArray[np.bool_] | None = None
    name: str = "machine axes"

    def steps(self, job: Job) -> Steps[Reading]:
        yield []
        if self.blocks is None:
            return Reading((AxisMeasurement(self.variant, (), float("nan")),))
        travel, joints = self._travel(self.blocks), self.blocks.machine.joints
        speed = self._speeds(travel)
        ends = [np.fmin.reduce(travel.least, axis=0), np.fmax.reduce(travel.largest, axis=0), speed.max(axis=0)]
        axes = tuple(
            AxisFigures(joint, float(least), float(largest), float(fastest), self.max_feed.get(joint.name, np.inf))
            for joint, least, largest, fastest in zip(joints, *ends, strict=True)
        )
        findings = [f for i, joint in enumerate(joints) for f in self._beyond(job, i, joint, travel, speed)]
        return Reading((AxisMeasurement(self.variant, axes, self._rapid_seconds(travel)),), tuple(findings))

    def _travel(self, blocks: Blocks) -> Travel:
        """What the program states: nan where an axis stands where nobody says, until it goes anywhere from there."""
        travel = axis_travel(blocks)
        if self.homing is None:
            return travel
        moves, home = travel.rate > 0.0, self.homing[:, None]
        row = np.arange(len(blocks))[:, None]
        said, sent = (np.maximum.accumulate(np.where(m, row, -1), axis=0) for m in (moves & ~home, moves & home))
        known = said > sent
        began = np.concatenate([np.zeros_like(known[:1]), known[:-1]])
        end, begin = np.where(known, blocks.values, np.nan), np.where(began, blocks.before, np.nan)
        both = known & began
        least, largest = np.fmin(begin, end), np.fmax(begin, end)
        return Travel(np.where(both, travel.least, least), np.where(both, travel.largest, largest), travel.rate)

    def _speeds(self, travel: Travel) -> NDArray[np.floating]:
        """Largest speed [per s] of every axis in every block in feed whose time is known; 0 in the others."""
        assert self.blocks is not None
        fed = ~self.blocks.rapid & (self.blocks.seconds > 0.0)
        seconds = np.where(fed, self.blocks.seconds, 1.0)
        return np.where(fed[:, None], travel.rate / seconds[:, None], 0.0)

    def _rapid_seconds(self, travel: Travel) -> float:
        """The slowest axis of each rapid sets its time; nan where its rate is not named."""
        assert self.blocks is not None
        way, rate = travel.rate[self.blocks.rapid], [self.max_rapid.get(n, np.nan) for n in self.blocks.machine.axes]
        seconds = np.where(way > 0.0, way / np.array(rate), 0.0)
        return float(seconds.max(axis=1, initial=0.0).sum())

    def _beyond(self, job: Job, i: int, joint: Joint, travel: Travel, speed: NDArray) -> Iterator[Finding]:
        unit, one = ("deg", degrees(1.0)) if joint.is_rotary else ("mm", 1.0)
        for value, limit, sign in ((travel.least[:, i], joint.lower, -1.0), (travel.largest[:, i], joint.upper, 1.0)):
            over = np.nan_to_num(sign * (value - limit), nan=-np.inf, posinf=-np.inf, neginf=-np.inf)
            if isfinite(limit) and over.max(initial=0.0) > _ROUNDING:
                worst = int(np.argmax(over))
                text = (
                    f"axis {joint.name} goes to {one * value[worst]:.9g} {unit}, {one * over[worst]:.4g} {unit} beyond "
                    f"its limit of {one * limit:g} {unit}"
                )
                yield self._told(job, "axis_limit", over > _ROUNDING, worst, text)
        fastest, most = speed[:, i], self.max_feed.get(joint.name, np.inf)
        if fastest.max(initial=0.0) > most * (1.0 + _ROUNDING):
            worst = int(np.argmax(fastest))
            told, limit = (60.0 * one * x for x in (float(fastest[worst]), most))
            text = f"axis {joint.name} goes at {told:.6g} {unit}/min in feed, its limit is {limit:g} {unit}/min"
            yield self._told(job, "axis_speed", fastest > most * (1.0 + _ROUNDING), worst, text)

    def _told(self, job: Job, kind: str, over: NDArray[np.bool_], worst: int, text: str) -> Finding:
        assert self.blocks is not None
        tip = self.frame.point(self.blocks.machine.forward(self.blocks.values[[worst]])[0])[0]
        first = int(np.argmax(over))
        text = f"{text}, {self._where(worst)}" + (f", first {self._where(first)}" if first != worst else "")
        return axis_beyond(job.part, kind, tip, text)

    def _where(self, block: int) -> str:
        assert self.blocks is not None
        line, operation = int(self.blocks.line[block]), int(self.blocks.operation[block])
        where = f"in line {line}" if line else f"in block {block + 1}"
        return where + (f" of {self.names[operation]}" if operation < len(self.names) else "")
