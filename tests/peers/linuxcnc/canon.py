"""From the peer's canonical calls to moves of the spindle nose."""

from __future__ import annotations

import math
import re

from tests.peers.linuxcnc.moves import FUZZ, TURN, Move, stands

PLANES = {"XY": (17, 0, 1, 2), "XZ": (18, 2, 0, 1), "YZ": (19, 1, 2, 0)}
_NUMBER = re.compile(r"-?(?:[\d.]+|nan|inf)\b")
NOTHING = (0.0,) * 6


class Canon:
    """The world as the calls change it; ``moves`` are those made so far."""

    def __init__(self) -> None:
        self.moves: list[Move] = []
        self.scale, self.plane = 1.0, "XY"
        self.g5x, self.g92, self.length = NOTHING, NOTHING, NOTHING
        self.nose = NOTHING
        self.feed, self.turning, self.per_turn, self.speed = 0.0, 0.0, False, 0.0

    def call(self, line: str) -> None:
        """Take one call."""
        name, _, rest = line.partition("(")
        action = getattr(self, f"_{name.lower()}", None)
        if action is not None:
            action([float(number) for number in _NUMBER.findall(rest)] or [rest])

    def _use_length_units(self, told: list) -> None:
        self.scale = 25.4 if "INCHES" in told[0] else 1.0

    def _select_plane(self, told: list) -> None:
        self.plane = told[0].strip(")")[-2:]

    def _set_g5x_offset(self, told: list) -> None:
        self.g5x = self._place(told[1:])

    def _set_g92_offset(self, told: list) -> None:
        self.g92 = self._place(told)

    def _set_xy_rotation(self, told: list) -> None:
        assert told[0] == 0.0, "turned work offsets are beyond the reader of G-code"

    def _use_tool_length_offset(self, told: list) -> None:
        self.length = self._place(told[:6])

    def _set_feed_rate(self, told: list) -> None:
        self.feed, self.turning = told[0] * self.scale, told[0]

    def _set_feed_mode(self, told: list) -> None:
        self.per_turn = bool(told[1])

    def _set_spindle_speed(self, told: list) -> None:
        self.speed = told[1]

    def _dwell(self, told: list) -> None:
        if told[0]:
            self.moves.append(Move("dwell", self.nose, told[0]))

    def _straight_traverse(self, told: list) -> None:
        self._go(Move("rapid", self._machine(told)))

    def _straight_feed(self, told: list) -> None:
        end = self._machine(told)
        way = math.dist(end[:3], self.nose[:3])
        turn = math.dist(end[3:], self.nose[3:])
        minutes = way / self._rate(self.feed) if way > 1e-7 else turn / self._rate(self.turning)
        self._go(Move("feed", end, 60.0 * minutes))

    def _arc_feed(self, told: list) -> None:
        number, a, b, c = PLANES[self.plane]
        linear, centre = [0.0] * 3, [0.0] * 3
        linear[a], linear[b], linear[c] = told[0], told[1], told[5]
        centre[a], centre[b] = told[2], told[3]
        end, middle = self._machine([*linear, *told[6:9]]), self._machine([*centre, 0.0, 0.0, 0.0])
        sweep = self._sweep(end, middle, a, b, int(told[4]))
        radius = math.hypot(self.nose[a] - middle[a], self.nose[b] - middle[b])
        way = math.hypot(radius * sweep, end[c] - self.nose[c])
        self._go(Move("arc", end, 60.0 * way / self._rate(self.feed), (middle[a], middle[b]), sweep, number))

    def _sweep(self, end: tuple[float, ...], middle: tuple[float, ...], a: int, b: int, turns: int) -> float:
        first = math.atan2(self.nose[b] - middle[b], self.nose[a] - middle[a])
        last = math.atan2(end[b] - middle[b], end[a] - middle[a])
        angle = (last - first if turns > 0 else first - last) % TURN
        if angle < FUZZ:
            angle += TURN
        return math.copysign(angle + TURN * (abs(turns) - 1), turns)

    def _go(self, move: Move) -> None:
        if not stands(move, self.nose):
            self.moves.append(move)
        self.nose = move.end

    def _rate(self, feed: float) -> float:
        rate = feed * (self.speed if self.per_turn else 1.0)
        return rate or math.nan

    def _place(self, told: list[float]) -> tuple[float, ...]:
        return (*(value * self.scale for value in told[:3]), *told[3:6])

    def _machine(self, told: list[float]) -> tuple[float, ...]:
        parts = zip(self._place(told), self.g5x, self.g92, self.length, strict=True)
        return tuple(map(sum, parts))


def moves(calls: list[str]) -> list[Move]:
    """The moves that the calls make."""
    canon = Canon()
    for call in calls:
        canon.call(call)
    return canon.moves
