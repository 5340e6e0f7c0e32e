"""Poses of a tool as truncated series: what planners, machines and generators hand to the motion room."""

from __future__ import annotations

from typing import NamedTuple

from gearsim.geometry.series import Series


class PoseSeries(NamedTuple):
    """Tip position [mm] and unit axis (tip to shank) as vector series in a parameter, workpiece frame."""

    tip: Series
    axis: Series


class FrameSeries(NamedTuple):
    """A whole tool frame as vector series in a parameter, workpiece frame: a pose, and its turn about the axis.

    ``radial`` is the tool's own x direction, a unit vector normal to the axis.
    """

    tip: Series
    axis: Series
    radial: Series

    @property
    def pose(self) -> PoseSeries:
        """The frame without its turn about the axis."""
        return PoseSeries(self.tip, self.axis)
