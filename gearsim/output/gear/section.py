"""section.png: the whole gear as cut in one transverse plane, with the nominal gear as thin lines."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.gear.strips import Strips, section_strips
from gearsim.output.gear.style import SIDE_COLOURS
from gearsim.output.panels import Room, page
from gearsim.output.saving import Save
from gearsim.simulation.section import Section
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear
from gearsim.surfaces.involute import InvoluteFlank

_METAL, _LINE = "#c9ced6", "0.25"
_POINTS = 81
_OFF = 0.01  # mm: a small part of a pixel
_ROOM = Room(left=0.7, right=0.2, bottom=0.85, top=0.75, across=0.6)


def draw_section(section: Section, gear: CylindricalGear, title: str, save: Save) -> None:
    """The whole gear at the left, space 0 and its neighbours at the right."""
    pitch = float(np.diff(section.y).mean())
    heading = (
        f"{title}: transverse section as cut at z = {f'{section.z:g}'.replace('-', '−')} mm"
        f"   ({len(section.y)} rays along x, {pitch:.3g} mm apart)"
    )
    figure, ((whole, near),) = page(1, 2, (6.9, 6.9), _ROOM, heading)
    reach, (x, y) = 1.04 * abs(section.start), _zoom(gear, section)
    strips = section_strips(section, _OFF), section_strips(section, 0.1 * _OFF, x, (y[0] - pitch, y[1] + pitch))
    limits = ((-reach, reach), (-reach, reach)), (x, y)
    for axis, width, shown, (across, up) in zip((whole, near), (0.5, 1.1), strips, limits, strict=True):
        _add_material(axis, shown)
        _add_circles(axis, gear, width)
        _add_involutes(axis, gear, section.z, width)
        axis.set(xlabel="x [mm]", xlim=across, ylim=up, aspect="equal")
        axis.tick_params(labelsize=9)
    whole.set_ylabel("y [mm]")
    whole.set_title("whole gear", fontsize=11, loc="left", y=1.0)
    near.set_title("space 1", fontsize=11, loc="left", y=1.0)
    figure.legend(*near.get_legend_handles_labels(), loc="lower center", ncols=6, fontsize=9, frameon=False)
    save(figure, "section.png", 130)


def _add_material(axis: Any, strips: Strips) -> None:
    from matplotlib.collections import PolyCollection

    shown: dict[str, Any] = {"facecolors": _METAL, "linewidths": 0, "antialiaseds": False}
    axis.add_collection(PolyCollection(list(strips.quads), **shown), autolim=False)
    axis.plot([], [], color=_METAL, lw=8, label="material left")


def _add_circles(axis: Any, gear: CylindricalGear, width: float) -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 1441)
    circles = (
        ("tip and root circle", (gear.tip_radius, gear.root_radius), "-"),
        ("reference circle", (gear.reference_radius,), "-."),
        ("base circle", (gear.base_radius,), ":"),
    )
    for name, radii, style in circles:
        for number, radius in enumerate(radii):
            axis.plot(
                radius * np.cos(turn), radius * np.sin(turn), color=_LINE, lw=0.7 * width, ls=style,
                label="_" if number else name,
            )  # fmt: skip


def _add_involutes(axis: Any, gear: CylindricalGear, z: float, width: float) -> None:
    """The nominal flanks of all spaces."""
    roll = gear.roll(np.linspace(gear.root_form_radius, gear.tip_form_radius, _POINTS))
    for side in SIDES:
        first = InvoluteFlank(gear, side).jet(roll, np.full(_POINTS, z)).r[:, :2]
        points = _turned(first, gear.pitch_angle * np.arange(gear.count))
        for k, line in enumerate(points):
            axis.plot(*line.T, color=SIDE_COLOURS[side], lw=1.4 * width, label="_" if k else f"{side} flanks")


def _turned(points: NDArray, angle: NDArray) -> NDArray:
    """Points (n, 2) turned about the origin by angles (k,) [rad], (k, n, 2)."""
    cos, sin = np.cos(angle)[:, None], np.sin(angle)[:, None]
    x, y = points.T
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)


def _zoom(gear: CylindricalGear, section: Section) -> tuple[tuple[float, float], tuple[float, float]]:
    """The ends in x and in y of a square around space 0."""
    angle = float(gear.space_centre(0, section.z))
    middle = 0.5 * (gear.tip_radius + gear.root_radius)
    half = max(0.62 * gear.pitch_angle * middle, 0.75 * abs(gear.tip_radius - gear.root_radius))
    x, y = middle * np.cos(angle), middle * np.sin(angle)
    return (x - half, x + half), (y - half, y + half)
