"""A generated tooth beside its blank: every figure against brute force from points, exact limits, verdicts."""

from dataclasses import replace

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.metrology.tooth_check import ToothFigure, ToothInspection
from gearsim.processes.run import plan, run
from gearsim.scene import check_scene, load_scene, scene_table
from gearsim.surfaces.face_milled import FaceMilledTooth

SMALL = ("metrology.rows=3", "metrology.columns=5", "metrology.convergence=[]", "simulation.dexel_pitch_mm=1.5")
GEAR, PLUNGED, PINION = "spiral-bevel-face-milled", "spiral-bevel-formate", "hypoid-pinion-phoenix"
CASES = (
    (GEAR,), (PLUNGED,), (PINION,), (GEAR, "generator.tilt_deg=3"), (GEAR, "generator.sliding_base_mm=1"),
    (GEAR, "generator.blank_offset_mm=2"), (PINION, "generator.swivel_deg=-21"),
)  # fmt: skip


def looked(name, *overrides, tooth=None):
    """The tooth (or another in its place), and the figures and reading of its inspection, nothing cut."""
    scene, folder = load_scene(name, overrides)
    job = plan(scene, folder)
    (asked,) = (i for i in job.inspections if isinstance(i, ToothInspection))
    asked = replace(asked, tooth=tooth or asked.tooth)
    steps = asked.steps(job)
    next(steps)
    with pytest.raises(StopIteration) as stop:
        steps.send([])
    reading = stop.value.value
    return asked.tooth, {f.name.split()[0]: f for f in reading.measurements[0].figures}, reading


@pytest.fixture(scope="module", params=CASES, ids=" ".join)
def case(request):
    return looked(*request.param)


def head_points(tooth, cut):
    """Points [mm] of the turning head's tip land over its whole motion, in the gear's frame, shape (n, 3)."""
    land = cut.element("bottom", "convex")
    radii = land.at(np.linspace(0.0, land.length, 3)).r
    phi, angle = np.linspace(*cut.motion_range, 401), np.linspace(-np.pi, np.pi, 2001)
    pose = cut.poses(phi, 0)
    out = []
    for tip, axis in zip(pose.tip.value, pose.axis.value, strict=True):
        x = np.cross(axis, [0.0, 0.0, 1.0])
        x /= np.linalg.norm(x)
        ring = np.cos(angle)[:, None] * x + np.sin(angle)[:, None] * np.cross(axis, x)
        out.append((tip + radii[:, None, None] * ring).reshape(-1, 3))
    return np.concatenate(out)


def test_the_deepest_point_of_the_bottom_land_is_the_deepest_that_the_head_ever_reaches(case):
    """The root cone by its apex and angle alone, the head by its poses alone."""
    tooth, figures, _ = case
    blank = tooth.blank
    points = head_points(tooth, tooth.cut("concave"))
    radius, z = np.hypot(points[:, 0], points[:, 1]), points[:, 2]
    cone = radius * np.sin(blank.pitch) + z * np.cos(blank.pitch)
    inside = (cone > blank.toe) & (cone < blank.cone_distance)
    off = radius * np.cos(blank.root_angle) - (z + blank.root_apex) * np.sin(blank.root_angle)
    off /= np.cos(blank.pitch - blank.root_angle)  # across the root cone, then along the pitch cone's normal
    assert 1e3 * off[inside].min() == pytest.approx(figures["bottom"].least, abs=2.0)


def on_pitch_cone(flank):
    """Angle about the gear's axis and cone distance [mm] where a fine net of the flank crosses the pitch cone."""
    blank = flank.blank
    length = 0.5 + np.linspace(-0.02, 0.02, 41)
    height = np.linspace(0.05, 0.95, 401)
    ll, hh = np.meshgrid(length, height, indexing="ij")
    r = flank.jet(*flank.locate(ll.ravel(), hh.ravel())).r.reshape(*ll.shape, 3)
    over = np.hypot(r[..., 0], r[..., 1]) * np.cos(blank.pitch) - r[..., 2] * np.sin(blank.pitch)
    angle = np.unwrap(np.arctan2(r[..., 1], r[..., 0]), axis=1)
    at = [np.interp(0.0, *(x[::sense] for x in (o, a))) for o, a in zip(over, angle, strict=True)
          for sense in [1 if o[-1] > o[0] else -1]]  # fmt: skip
    return np.unwrap(at), blank.toe + blank.face_width * length


def test_spiral_angle_and_thickness_are_those_of_the_flanks_crossings_with_the_pitch_cone(case):
    """Seen from the apex x runs to the right and y down: clockwise is a growing angle, and a right hand if outwards."""
    tooth, figures, _ = case
    blank, angles, middle, hands = tooth.blank, [], [], set()
    for side in ("concave", "convex"):
        theta, cone = on_pitch_cone(tooth.flank(side))
        slope = np.polyfit(cone - blank.mean, theta, 4)[-2]
        angles.append(np.degrees(np.arctan(abs(slope) * blank.mean * np.sin(blank.pitch))))
        middle.append(np.interp(blank.mean, cone, theta))
        hands.add("right" if slope > 0.0 else "left")
    radius = blank.mean * np.sin(blank.pitch)
    slot = radius * abs(np.angle(np.exp(1j * (middle[1] - middle[0]))))
    assert figures["spiral"].most == pytest.approx(np.mean(angles), abs=1e-3)
    assert {figures["spiral"].hand} == hands
    assert figures["tooth"].most == pytest.approx(2.0 * np.pi * radius / blank.teeth - slot, abs=1e-4)


@pytest.mark.parametrize(("cradle", "hand"), [(-56.78, "left"), (56.78, "right")])
def test_a_tooth_of_the_other_hand_is_not_the_part_s(cradle, hand):
    """The mirrored cradle angle leaves the mirrored tooth: every figure but its hand is the same."""
    for demanded in ("left", "right"):
        settings = (f"generator.cradle_angle_deg={cradle}", f'metrology.tooth.hand="{demanded}"')
        _, figures, reading = looked(GEAR, *settings)
        assert figures["spiral"].hand == hand
        assert figures["spiral"].most == pytest.approx(31.77, abs=5e-3)
        assert [f.fails for f in reading.findings] == [True] * (demanded != hand)
        assert all(f"31.77 deg, {hand} hand, 32 ± 0.5, {demanded} hand demanded" in f.text for f in reading.findings)


def test_a_hand_may_be_left_open_or_demanded_alone():
    table = scene_table(load_scene(GEAR)[0])
    tooth = table["metrology"]["tooth"]
    for keys, text in (({}, "none demanded"), ({"hand": "left"}, "left hand demanded")):
        table["metrology"]["tooth"] = {"depth_tolerance_um": tooth["depth_tolerance_um"]} | keys
        job = plan(check_scene(table, "s"))
        (asked,) = (i for i in job.inspections if isinstance(i, ToothInspection))
        steps = asked.steps(job)
        next(steps)
        with pytest.raises(StopIteration) as stop:
            steps.send([])
        assert f"spiral angle at mean 31.77 deg, left hand ({text})" in stop.value.value.remarks[0]


@pytest.mark.parametrize(("cradle", "hand"), [(-42.655881, "left"), (42.655881, "right")])
def test_a_zerol_tooth_s_hand_is_that_of_its_outer_half(cradle, hand):
    """At mean it runs along the cone's generator (a spiral angle of 0); the head's circle decides."""
    _, figures, _ = looked(GEAR, "generator.radial_distance_mm=93.713995", f"generator.cradle_angle_deg={cradle}")
    assert figures["spiral"].most < 1.0
    assert figures["spiral"].hand == hand


def test_the_slots_surfaces_meet(case):
    _, figures, _ = case
    assert figures["gap"].most < 1e-6


def test_fillets_of_a_head_that_stands_10_um_higher_gape_and_fail():
    tooth, _, _ = looked(GEAR)
    raised = replace(tooth, generator=replace(tooth.generator, sliding_base=tooth.generator.sliding_base + 0.01))

    class Gaping(FaceMilledTooth):
        def fillet(self, side):
            return raised.fillet(side)

    gaping = Gaping(tooth.blank, tooth.head, tooth.generator)
    _, _, reading = looked(GEAR, tooth=gaping)
    gap = reading.measurements[0].figures[1]
    assert 5.0 < gap.most < 30.0
    assert [f.text.split(":")[1].split(" flank")[0] for f in reading.findings] == [" gap between"]


def test_what_is_wrong_is_named_with_its_number_and_what_is_not_demanded_is_said():
    _, _, reading = looked(GEAR)
    assert reading.findings == ()
    assert "bottom land over the root cone 0.8291 to 4.071 um (0 ± 100 demanded)" in reading.remarks[0]
    assert "spiral angle at mean 31.77 deg, left hand (32 ± 0.5, left hand demanded)" in reading.remarks[0]
    assert "tooth thickness at mean 3.579 mm (none demanded)" in reading.remarks[0]


@pytest.mark.parametrize(
    ("override", "told"),
    [
        ("generator.tilt_deg=3", "bottom land over the root cone 2595 to 3308 um"),
        ("generator.tilt_deg=-1", "bottom land over the root cone"),
        ("generator.sliding_base_mm=1", "bottom land over the root cone 1213 to 1216 um"),
        ("generator.sliding_base_mm=-1", "bottom land over the root cone -"),
        ("generator.machine_centre_to_back_mm=2", "bottom land over the root cone 1883 to 1886 um"),
        ("generator.blank_offset_mm=2", "spiral angle at mean 32.96 deg, left hand, 32 ± 0.5, left hand demanded"),
        ("generator.blank_offset_mm=-2", "spiral angle at mean"),
        ("cutter.point_width_mm=2.3", ""),
        ("metrology.tooth.thickness_mm=3.7", "tooth thickness at mean 3.579 mm, 3.7 ± 0.05 demanded (-120."),
    ],
)
def test_a_tooth_that_does_not_sit_in_its_blank_fails(override, told):
    _, _, reading = looked(GEAR, override)
    assert bool(reading.findings) == bool(told)
    assert all(f.fails and f.kind == "off_the_blank" for f in reading.findings)
    assert any(told in f.told for f in reading.findings) or not told


@pytest.mark.parametrize(
    ("least", "most", "wanted", "fails"),
    [(-5.0, 5.0, 0.0, False), (-5.1, 5.0, 0.0, True), (0.0, 5.1, 0.0, True), (9.0, 9.0, None, False),
     (1.0, 1.0, 6.0, False), (0.9, 0.9, 6.0, True), (np.nan, np.nan, 0.0, True)],
)  # fmt: skip
def test_a_figure_holds_at_the_very_ends_of_its_tolerance(least, most, wanted, fails):
    assert ToothFigure("n", "s", "um", least, most, wanted, 5.0, np.zeros(3)).fails == fails


def test_the_verdict_line_says_against_what_the_roll_is_measured():
    result = run(GEAR, overrides=SMALL)
    assert (result.verdict, result.exit_code) == ("pass", 0)
    assert "under roll the surfaces are measured against themselves, as its own envelope; 1 of 33" in result.headline
    tilted = run(GEAR, overrides=(*SMALL, "generator.tilt_deg=3"))
    assert (tilted.verdict, tilted.exit_code) == ("fail", 1)
    assert "bottom land over the root cone 2595 to 3308 um, 0 ± 100 demanded (+3308 um)" in tilted.headline
    assert "no blank says what the part demands" in run("flat-end-envelope", overrides=SMALL).headline


def test_demands_are_for_teeth_that_a_head_generates():
    scene, _ = load_scene("spiral-bevel-flank-conventional")
    assert any(isinstance(i, ToothInspection) for i in plan(scene).inspections)
    ruled = scene_table(load_scene("spiral-bevel-flank")[0])
    ruled["metrology"]["tooth"] = {}
    with pytest.raises(InputError, match=r"metrology\.tooth: it is for teeth that a head generates, not ruled-bevel"):
        check_scene(ruled, "s")


def test_two_cuts_of_one_pinion_are_both_held_against_the_blank():
    """The convex flank's own head stands 1 mm too far out: its bottom land is that much too high."""
    scene, _ = load_scene(PINION, SMALL)
    table = scene_table(scene)
    generator = table["generator"] | {"sliding_base_mm": table["generator"]["sliding_base_mm"] + 1.0}
    table["convex"] = {"cutter": table["cutter"], "generator": generator}
    job = plan(check_scene(table, "s"))
    (asked,) = (i for i in job.inspections if isinstance(i, ToothInspection))
    assert len(asked.tooth.bottoms) == 2
    steps = asked.steps(job)
    next(steps)
    with pytest.raises(StopIteration) as stop:
        steps.send([])
    depth = stop.value.value.measurements[0].figures[0]
    assert depth.most > 800.0 > -100.0 > depth.least
