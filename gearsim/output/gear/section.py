"""section.png: the whole gear as cut in one transverse plane, with the nominal gear as thin lines."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.gear.strips import section_strips
from gearsim.output.gear.style import SIDE_COLOURS
from gearsim.output.panels import pyplot
from gearsim.output.saving import Save
from gearsim.simulation.section import Section
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear
from gearsim.surfaces.involute import InvoluteFlank

_METAL, _LINE = "#c9ced6", "0.25"
_POINTS = 81


def draw_section(section: Section, gear: CylindricalGear, title: str, save: Save) -> None:
    """The whole gear at the left, space 0 and its neighbours at the right."""
    plt = pyplot()
    figure, (whole, near) = plt.subplots(1, 2, figsize=(15, 8.3), constrained_layout=True)
    for axis, width in ((whole, 0.5), (near, 1.1)):
        _add_material(axis, section)
        _add_circles(axis, gear, width)
        _add_involutes(axis, gear, section.z, width)
        axis.set_aspect("equal")
        axis.set_xlabel("x [mm]")
        axis.tick_params(labelsize=9)
    whole.set_ylabel("y [mm]")
    whole.set_title("whole gear", fontsize=11, loc="left")
    reach = 1.04 * abs(section.start)
    whole.set(xlim=(-reach, reach), ylim=(-reach, reach))
    _zoom(near, gear, section)
    near.set_title("space 1", fontsize=11, loc="left")
    figure.legend(*near.get_legend_handles_labels(), loc="outside lower center", ncols=6, fontsize=9, frameon=False)
    pitch = float(np.diff(section.y).mean())
    figure.suptitle(
        f"{title}: transverse section as cut at z = {f'{section.z:g}'.replace('-', '−')} mm"
        f"   ({len(section.y)} rays along x, {pitch:.3g} mm apart)\n",
        fontsize=13, weight="bold",
    )  # fmt: skip
    save(figure, "section.png", 130)


def _add_material(axis: Any, section: Section) -> None:
    from matplotlib.collections import PolyCollection

    quads = section_strips(section).quads
    axis.add_collection(PolyCollection(list(quads), facecolors=_METAL, linewidths=0, antialiaseds=False))
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


def _zoom(axis: Any, gear: CylindricalGear, section: Section) -> None:
    """A square around space 0."""
    angle = float(gear.space_centre(0, section.z))
    middle = 0.5 * (gear.tip_radius + gear.root_radius)
    half = max(0.62 * gear.pitch_angle * middle, 0.75 * abs(gear.tip_radius - gear.root_radius))
    x, y = middle * np.cos(angle), middle * np.sin(angle)
    axis.set(xlim=(x - half, x + half), ylim=(y - half, y + half))
