"""Synthetic inspections: gears whose slope, form, pitch and runout are known."""

from math import cos, pi, radians

import numpy as np

from gearsim.metrology.gear_inspection import GearInspection
from gearsim.metrology.gear_pitch import pitch_deviations, runout
from gearsim.metrology.gear_traces import GearTraces, helix_range, profile_range, transverse_um
from gearsim.surfaces.cylindrical_gear import CylindricalGear

SLOPE, WAVE, STEP = {"left": 6.0, "right": -3.0}, 1.25, 4.0
TEETH = (0, 4, 8, 11)


def gear_of(teeth=15, helix_deg=10.0):
    return CylindricalGear.from_transverse(teeth, 5.0, radians(20.0), radians(helix_deg), 10.0)


def inspection(gear, size=1.0, gear_class=6, missing=False):
    """Traces of ``size`` times a slope [um, transverse, whole active flank], waves 2 WAVE high and a pitch step.

    Given as the measuring road gives them: normal deviations in mm.
    """
    rolls = (0.1, gear.tip_roll) if gear.teeth > 0 else (0.52, 0.12)
    profile = profile_range(*(gear.base_radius * xi for xi in rolls))
    helix = helix_range(10.0, gear.module)
    found = {"profile": {}, "helix": {}}
    for side, slope in SLOPE.items():
        for kind, span, stations in (("profile", profile, (-1.0, -5.0, -9.0)), ("helix", helix, (141.9, 150.0, 156.0))):
            position = np.linspace(span.start, span.end, 801)
            share = span.share(position)
            a, b = span.share([span.first, span.last])
            wave = WAVE * np.cos(2.0 * pi * 5.0 * (share - a) / (b - a))
            normal = 1e-3 * size * cos(gear.base_helix_angle) * np.tile(slope * share + wave + 2.0, (4, 3, 1))
            if missing and kind == "profile":
                normal[1, 1, 300:320] = np.nan
            um = transverse_um(normal, gear.base_helix_angle)
            found[kind][side] = GearTraces(kind, side, TEETH, stations, position, um, span)
    stepped = {side: size * step_mm(gear, side) for side in SLOPE}
    pitch = {side: pitch_deviations(gear, side, normal) for side, normal in stepped.items()}
    out = runout(gear, stepped["left"], stepped["right"])
    return GearInspection(
        "synthetic", gear, gear_class, found["profile"], found["helix"], pitch, out, {"left": (), "right": ()}
    )


def step_mm(gear, side):
    """Normal deviations [mm] of flanks 6 and up standing STEP um too far on, as arcs at the reference circle."""
    f = 1.0 if side == "right" else -1.0
    arc = np.where(np.arange(gear.count) >= 6, STEP, 0.0)
    return -1e-3 * f * gear.sign * arc * cos(gear.transverse_pressure_angle) * cos(gear.base_helix_angle)
