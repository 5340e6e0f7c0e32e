"""Zerol and low-angle gears through the scene: both roads on a few samples; bad values of keys before the cut."""

import math

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.metrology.grid import grids
from gearsim.processes.run import estimate, plan, run
from gearsim.scene import load_scene

SMALL = ("metrology.rows=2", "metrology.columns=4", "simulation.dexel_pitch_mm=2.5")
MEAN, HEAD = 68.9207, 63.5


def at_spiral_angle(degrees, hand="left"):
    """Overrides that lead the head's circle through the mean point at a spiral angle."""
    x, y = MEAN - HEAD * math.sin(math.radians(degrees)), HEAD * math.cos(math.radians(degrees))
    turn = math.degrees(math.atan2(y, x)) * (-1.0 if hand == "left" else 1.0)
    return f"generator.radial_distance_mm={math.hypot(x, y)!r}", f"generator.cradle_angle_deg={turn!r}"


@pytest.mark.parametrize(
    ("degrees", "hand", "head"),
    [(0.0, "left", ()), (20.0, "right", ()), (10.0, "left", ("cutter.edge_radius_mm=0.0",))],
    ids=["zerol", "20 deg, right hand", "10 deg, sharp blades"],
)
def test_low_spiral_angles_are_cut_as_the_closed_form_says(degrees, hand, head):
    demand = f"metrology.tooth.spiral_angle_deg={degrees}", f'metrology.tooth.hand="{hand}"'
    result = run("spiral-bevel-face-milled", overrides=(*SMALL, *at_spiral_angle(degrees, hand), *head, *demand))
    assert (result.verdict, result.findings) == ("pass", ())
    found = grids(list(result.measurements.values()))
    assert set(found) == {(surface, "roll") for surface in result.job.part.surfaces}
    for m in found.values():
        assert m.measurable.all()
        assert np.abs(m.deviation.value).max() < 1e-6
        assert m.gap.max_um < 1e-3
        assert m.gap.disagree == 0


def refusal(scene, overrides):
    """What planning answers: the refusal's text, or nothing where the job can be cut. Anything else escapes."""
    try:
        plan(*load_scene(scene, overrides))
    except InputError as error:
        return str(error)
    return ""


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("surface.kind=[]", "surface.kind: got []"),
        ("surface.face_width_mm=1e-9", "face width 1e-09 mm must be at least 1e-06 of the cone distance"),
        ("cutter.point_width_mm=6.0", "slots overlap at the tooth's tip"),
        ("cutter.radius_mm=1000.0", "its tip circle passes the cradle axis at 9"),
        ("cutter.height_mm=5.0", "blade ends below the tooth's tip"),
        ("generator.ratio_of_roll=0", "the head never cuts"),
        ("generator.sliding_base_mm=9.0", "bottom lies outside the blank"),
        ("generator.modified_roll=[nan]", "modified_roll"),
        ("generator.radial_distance_mm=0.0", "its tip circle passes the cradle axis at 63"),
        ("surface.rim_mm=1e4", "rim 10000 mm reaches past the gear axis; it must be below"),
    ],
)
def test_teeth_that_cannot_be_are_refused_before_the_cut(override, message):
    assert message in refusal("spiral-bevel-face-milled", (override,))


def test_steps_and_pitches_that_make_too_many_are_refused():
    for scene, override, message in (
        ("spiral-bevel-formate", "simulation.dexel_pitch_mm=1e-300", "dexel pitch 1e-300 mm is too fine"),
        ("gouge-size-vertical-cylinder", "toolpath.stepover_mm=1e-9", "wanted is a step of at least 0.00032 mm"),
        ("gouge-size-vertical-cylinder", "catalogue.mills=[]", "catalogue.mills: got []"),
        ("spur-external", "toolpath.finishing.involute_step_mm=1e-9", "wanted is a step of at least"),
        ("spiral-bevel-flank", "toolpath.run_mm=99999.0", "lengthwise circle"),
    ):
        with pytest.raises(InputError) as refused:
            estimate(*load_scene(scene, (override,)))
        assert message in str(refused.value), override


VALUES = ("0", "-1.0", "1e-9", "nan", "-inf", "[]")


@pytest.mark.parametrize("scene", ["spiral-bevel-formate", "hypoid-pinion-phoenix"])
def test_no_value_of_a_key_escapes_planning(scene):
    """Every key with values no key should have; what is not refused can be planned."""
    tables = {
        "spiral-bevel-formate": ("surface", "cutter", "generator"),
        "hypoid-pinion-phoenix": ("toolpath", "machine"),
    }
    data = load_scene(scene)[0].model_dump()
    keys = [f"{table}.{key}" for table in tables[scene] for key, value in data[table].items()]
    refused = [refusal(scene, (f"{key}={value}",)) for key in keys for value in VALUES]
    assert sum(bool(text) for text in refused) > 0.5 * len(refused)
