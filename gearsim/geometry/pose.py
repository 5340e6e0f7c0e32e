"""Poses of a tool as truncated series: what planners, machines and generators hand to the motion room."""

from __future__ import annotations

from typing import NamedTuple

from gearsim.geometry.series import Series


class PoseSeries(NamedTuple):
    """Tip position [mm] and unit axis (tip to shank) as vector series in a parameter, workpiece frame."""

    tip: Series
    axis: Series
