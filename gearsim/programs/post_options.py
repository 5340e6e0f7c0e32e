"""What a post-processor is told beside the motions: the program's header, its numbers, the machine's own words."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

from gearsim.errors import InputError

FeedMode = Literal["inverse-time", "per-minute"]


@dataclass(frozen=True)
class Header:
    """``number`` of the program (O word), its ``title``, and ``lines`` of gear or scene data told in comments."""

    number: int = 1
    title: str = ""
    lines: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not 1 <= self.number <= 9999:
            raise InputError(f"program number {self.number}: an O word holds 1 to 9999")


@dataclass(frozen=True)
class Clamp:
    """The M codes that clamp and release one rotary axis."""

    axis: str
    clamp: int
    release: int


# The thesis's machine, read from its comments (errata of Groover 2018, part C).
CLAMPS = (Clamp("B", 68, 69), Clamp("C", 10, 11))


@dataclass(frozen=True)
class PostOptions:
    """How numbers and words are written.

    | option | meaning |
    | --- | --- |
    | ``linear_decimals`` | digits behind the point of X, Y, Z, I, J, K [mm]; the thesis writes 3 |
    | ``rotary_decimals`` | digits behind the point of A, B, C [deg]; the thesis writes 3 |
    | ``feed_mode`` | straight feeds by G93 (one over the minutes of a block) or G94 (mm/min) |
    | ``max_feed`` | largest F word; faster blocks are slowed down to it (the thesis's limit) |
    | ``work_offset`` | G54 to G59, or G54.1 P1 to P300 |
    | ``number_step`` | step of the N words, one an operation |
    | ``clamps`` | M codes of rotary axes that clamp; other axes than the machine's are passed over |
    """

    linear_decimals: int = 4
    rotary_decimals: int = 4
    feed_mode: FeedMode = "inverse-time"
    max_feed: float = 9999.0
    work_offset: str = "G54"
    number_step: int = 10
    clamps: tuple[Clamp, ...] = CLAMPS

    def __post_init__(self) -> None:
        for name in ("linear_decimals", "rotary_decimals"):
            if not 1 <= getattr(self, name) <= 12:
                raise InputError(f"{name} = {getattr(self, name)}: a program is written with 1 to 12 decimals")
        if not 0.001 <= self.max_feed <= 9999.0:
            raise InputError(f"max_feed = {self.max_feed:g}: an F word holds 0.001 to 9999")
        if not re.fullmatch(r"G5[4-9]|G54\.1 P([1-9]\d?|[12]\d\d|300)", self.work_offset):
            raise InputError(f"work_offset {self.work_offset!r}: expected G54 to G59 or G54.1 P1 to G54.1 P300")
        if self.number_step < 1:
            raise InputError(f"number_step = {self.number_step}: N words rise by at least 1")
