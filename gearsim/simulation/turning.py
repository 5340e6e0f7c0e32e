"""Turning of a blank before its operations, as an exact body of revolution."""

from __future__ import annotations

from typing import NamedTuple

from gearsim.geometry.turned import Turned


class Turning(NamedTuple):
    """What is ``kept`` within an outline, by an operation of a ``name``, at a ``rate`` [mm³/min], where it is known."""

    name: str
    kept: Turned
    rate: float | None = None
