"""Errors of tools, generators and mountings: what a run measures of each, against a hand calculation."""

import tomllib
from dataclasses import replace
from importlib.resources import files
from math import cos, pi, prod, radians, sin, tan
from pathlib import Path

import numpy as np
import pytest

from gearsim.cli import main
from gearsim.metrology.grid import DENSE, GridInspection, grids
from gearsim.motion.sources import MovedMotion
from gearsim.processes.run import plan, run, run_job
from gearsim.scene import load_scene, scene_names
from gearsim.studies.chunk import run_chunk
from gearsim.studies.records import Asked, Parameter, Study

FLANK, GENERATED, FORMATE = "spiral-bevel-flank", "spiral-bevel-face-milled", "spiral-bevel-formate"
HYPOID = "hypoid-pinion-phoenix"
SMALL = ("metrology.rows=3", "metrology.columns=5", "metrology.convergence=[]", "simulation.dexel_pitch_mm=1.5")
SIDES = ("concave", "convex")
ALPHA = radians(22.0)  # of both blades of the face-milled scenes


def planned(scene, *errors):
    points = ("toolpath.points=5",) * (scene == FLANK)
    return plan(*load_scene(scene, (*SMALL, *points, *(f"errors.{e}" for e in errors))))


def cut(job, variant="", names=SIDES):
    """Of flanks the grid's points, normals and deviations [um] under one variant, one row a sample."""
    variant = variant or job.main
    kept = {i.surface: i for i in job.inspections if isinstance(i, GridInspection) and i.name == DENSE}
    alone = [
        replace(kept[n], variants=(variant,), witnessed=(), judged=(), strangers="", series=(), generating="")
        for n in names
    ]
    found = grids(list(run_job(replace(job, inspections=tuple(alone))).measurements.values()))
    out = {}
    for (surface, _), m in found.items():
        assert m.deviation.measured.all()
        out[surface] = m.grid.point.reshape(-1, 3), m.grid.normal.reshape(-1, 3), 1e3 * m.deviation.value.ravel()
    return out


@pytest.fixture(scope="module")
def milled():
    """The flank-milled gear without errors: its job, and its flanks under the continuous passes."""
    job = planned(FLANK)
    return job, cut(job, "theory")


def added(milled, *errors):
    """What errors add to the deviations [um] of the flank-milled gear."""
    _, before = milled
    after = cut(planned(FLANK, *errors), "theory")
    return {side: after[side][2] - before[side][2] for side in SIDES}


def contact_heights(job, side, points):
    """Heights [mm] over the tip at which a cone of 15 deg comes closest to points, of many poses of the pass."""
    (motion,) = job.variant("theory", side).motions()
    t = np.linspace(0.0, 1.0, 8001)
    tip, axis = (s.value for s in motion.pose(np.zeros(len(t), dtype=int), t, 0))
    z = np.einsum("pti,ti->pt", points[:, None] - tip, axis)
    r = np.linalg.norm(points[:, None] - tip - z[..., None] * axis, axis=2)
    closest = np.argmin(r * cos(TAPER) - z * sin(TAPER), axis=1)
    return z[np.arange(len(points)), closest]


TAPER = radians(15.0)
CORNER = 1.04 + 0.8 * (1.0 - sin(TAPER)) / cos(TAPER)


@pytest.mark.parametrize(("errors", "depth"), [
    (("tool_radius_um=5", "tool_corner_um=20"), 5.0 * cos(TAPER)),  # the corner is not where the flank is cut
    (("tool_runout_um=5", "tool_length_um=-20"), 5.0 * cos(TAPER) - 20.0 * sin(TAPER)),
])  # fmt: skip
def test_a_parallel_cone_cuts_a_parallel_flank(milled, errors, depth):
    for deviation in added(milled, *errors).values():
        np.testing.assert_allclose(deviation, -depth, rtol=0.0, atol=1e-3)


def test_a_taper_error_grows_with_the_height_over_the_tip(milled):
    job, before = milled
    more = tan(TAPER + radians(0.02)) - tan(TAPER)
    for side, deviation in added(milled, "tool_taper_deg=0.02").items():
        deeper = 1e3 * contact_heights(job, side, before[side][0]) * more * cos(TAPER)
        np.testing.assert_allclose(deviation, -deeper, rtol=2e-3)


def test_a_form_error_leaves_a_crowned_flank(milled):
    job, before = milled
    length = 25.0 / cos(TAPER)
    for side, deviation in added(milled, "tool_form_um=5").items():
        way = contact_heights(job, side, before[side][0]) / cos(TAPER) - 0.5 * length
        np.testing.assert_allclose(deviation, 5.0 * (2.0 * way / length) ** 2, rtol=0.0, atol=0.01)


def test_a_gear_off_its_place_is_cut_off_its_place(milled):
    _, before = milled
    off = np.array([8.0 * cos(radians(30.0)), 8.0 * sin(radians(30.0)), 6.0])
    errors = ("eccentricity_um=8", "eccentricity_direction_deg=30", "mounting_distance_um=6")
    for side, deviation in added(milled, *errors).items():
        np.testing.assert_allclose(deviation, -before[side][1] @ off, rtol=0.0, atol=2e-3)


def test_the_path_of_an_erring_tool_is_that_of_the_nominal_one(milled):
    job, _ = milled
    off = planned(FLANK, "tool_radius_um=5", "eccentricity_um=8")
    assert off.files == job.files
    for nominal, real in zip(job.variants, off.variants, strict=True):
        for a, b in zip(nominal.operations, real.operations, strict=True):
            assert b.cutter.radius_at(10.0) == pytest.approx(a.cutter.radius_at(10.0) + 0.005)
            np.testing.assert_allclose(b.sources[0].pose(np.zeros(1, int), np.zeros(1), 0).tip.value[0] + [0.008, 0, 0],
                                       a.sources[0].pose(np.zeros(1, int), np.zeros(1), 0).tip.value[0])  # fmt: skip
    assert any("errors act: eccentricity_um = 8, tool_radius_um = 5" in note for note in off.notes)


@pytest.mark.parametrize(("scene", "keys", "values"), [
    (FLANK, ("tool_taper_deg", "eccentricity_um"), ((0.02, 0.0), (0.0, 8.0), (0.01, 5.0))),
    (FORMATE, ("head.outer_wear_um", "generator.sliding_base_um"), ((0.0, 0.0), (4.0, 0.0), (4.0, 3.0))),
])  # fmt: skip
def test_a_study_of_errors_gives_what_runs_give(scene, keys, values):
    tables = planned(scene).scene
    tables.pop("reference", None)
    columns = (Parameter(f"errors.{key}", column) for key, column in zip(keys, zip(*values, strict=True), strict=True))
    study = Study("errors", "", tables, Path(), tuple(columns), "list", 1, Asked(cross_checked=0.0))
    for outcome, given in zip(run_chunk(study, range(3))[0], values, strict=True):
        alone = cut(planned(scene, *(f"{key}={value}" for key, value in zip(keys, given, strict=True))))
        assert outcome.verdict == "unchecked"
        for side in SIDES:
            np.testing.assert_array_equal(outcome.maps[side].deviation_um.ravel(), alone[side][2])


@pytest.mark.parametrize("scene", [FLANK, FORMATE])
def test_errors_of_zero_are_none(scene):
    zeros = {
        FLANK: ("tool_radius_um=0", "tool_form_um=0.0", "eccentricity_um=0.0", "eccentricity_direction_deg=90.0"),
        FORMATE: ("head.inner_wear_um=0.0", "generator.cradle_angle_deg=0", "mounting_distance_um=0.0"),
    }[scene]
    job, zero = planned(scene), planned(scene, *zeros)
    assert [v.name for v in job.variants] == [v.name for v in zero.variants]
    assert job.notes == zero.notes
    assert [type(i) for i in job.inspections] == [type(i) for i in zero.inspections]
    for a, b in zip(job.variants, zero.variants, strict=True):
        for one, other in zip(a.operations, b.operations, strict=True):
            assert one.cutter == other.cutter
            assert not any(isinstance(source, MovedMotion) for source in other.sources)
            np.testing.assert_array_equal(one.table.tip, other.table.tip)
            np.testing.assert_array_equal(one.table.axis, other.table.axis)


def turn(axis, angle):
    c, s, (i, j) = cos(angle), sin(angle), {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    out = np.eye(4)
    out[i, i] = out[j, j] = c
    out[j, i], out[i, j] = s, -s
    return out


def shift(x=0.0, y=0.0, z=0.0):
    out = np.eye(4)
    out[:3, 3] = x, y, z
    return out


def head_frame(g, phi):
    """The head's frame in the gear's as Zhou (A.1) multiplies it, from the gear outward."""
    return (
        turn("z", -g["ratio_of_roll"] * phi) @ shift(z=-g["machine_centre_to_back_mm"])
        @ turn("y", -(0.5 * pi - radians(g["machine_root_angle_deg"])))
        @ shift(y=g["blank_offset_mm"], z=-g["sliding_base_mm"]) @ turn("z", radians(g["cradle_angle_deg"]) + phi)
        @ shift(x=g["radial_distance_mm"]) @ turn("z", radians(g.get("swivel_deg", 0.0)) + 0.5 * pi)
        @ turn("y", radians(g.get("tilt_deg", 0.0)))
    )  # fmt: skip


def moved(nominal, errors, phi, points):
    """How far [um] errors of the settings move a head's points, those in contact at cradle angles phi."""
    real = dict(nominal)
    for key, value in errors.items():
        name, size = (key.removesuffix("_um") + "_mm", 1e-3) if key.endswith("_um") else (key, 1.0)
        real[name] = real.get(name, 0.0) + size * value
    steps = [head_frame(real, f) @ np.linalg.inv(head_frame(nominal, f)) for f in phi]
    at = np.column_stack([points, np.ones(len(points))])
    return 1e3 * (np.einsum("nij,nj->ni", np.array(steps), at) - at)[:, :3]


SETTINGS = {
    "radial_distance_um": 10.0, "cradle_angle_deg": 0.005, "machine_root_angle_deg": -0.005, "ratio_of_roll": 0.0005,
    "tilt_deg": 0.01, "swivel_deg": 0.3, "sliding_base_um": 12.0, "blank_offset_um": -9.0,
    "machine_centre_to_back_um": 8.0,
}  # fmt: skip


def check_settings(scene, errors):
    job = planned(scene, *(f"generator.{key}={value}" for key, value in errors.items()))
    for side, (points, normals, deviation) in cut(job).items():
        patch, phi = job.part.patch(side), np.zeros(len(points))
        if scene != FORMATE:
            u, v = patch.locate(*np.meshgrid(np.linspace(0.01, 0.99, 5), np.linspace(0.01, 0.99, 3)))
            phi = patch.pose_parameter(u.ravel(), v.ravel())
        by_hand = np.sum(moved(job.scene["generator"], errors, phi, points) * normals, axis=1)
        assert np.abs(by_hand).max() > 0.3
        np.testing.assert_allclose(deviation, by_hand, rtol=0.0, atol=0.02)


@pytest.mark.parametrize("key", [key for key in SETTINGS if key not in ("ratio_of_roll", "swivel_deg")])
def test_a_setting_off_moves_the_shape_that_a_head_at_rest_leaves(key):
    check_settings(FORMATE, {key: SETTINGS[key]})


def test_settings_off_move_what_the_roll_generates():
    """To first order a generated surface moves as the head that touches it: what the contact slides adds nothing."""
    check_settings(GENERATED, {k: 0.1 * value for k, value in SETTINGS.items()})  # the second order is 0.9 um of 20


def test_another_ratio_of_roll_turns_the_head_about_the_gear_s_axis():
    rng, phi = np.random.default_rng(2), np.array([0.1, -0.2, 0.3])
    points, normals, more = rng.normal(size=(3, 3)), rng.normal(size=(3, 3)), 1e-5
    by_chain = np.sum(
        moved(load_scene(GENERATED)[0].generator.model_dump(), {"ratio_of_roll": more}, phi, points) * normals, 1
    )
    np.testing.assert_allclose(by_chain, -1e3 * more * phi * np.cross(points, normals)[:, 2], rtol=1e-4)


def test_machine_centre_to_back_moves_all_along_the_gear_s_axis():
    for _, normals, deviation in cut(planned(FORMATE, "generator.machine_centre_to_back_um=8")).values():
        np.testing.assert_allclose(deviation, -8.0 * normals[:, 2], rtol=0.0, atol=2e-3)


@pytest.mark.parametrize(("scene", "errors", "concave", "convex"), [
    (GENERATED, ("head.outer_wear_um=3", "head.inner_wear_um=5"), 3.0, 5.0),
    (FORMATE, ("head.outer_wear_um=3", "head.inner_wear_um=5"), 3.0, 5.0),
    (FORMATE, ("head.point_width_um=10",), -5.0 * cos(ALPHA), -5.0 * cos(ALPHA)),
    (FORMATE, ("head.radius_um=4", "head.tip_wear_um=30"), -4.0 * cos(ALPHA), 4.0 * cos(ALPHA)),
    (FORMATE, ("head.length_um=10", "head.runout_um=2"), *2 * (-10.0 * sin(ALPHA) - 2.0 * cos(ALPHA),)),
])  # fmt: skip
def test_parallel_blades_cut_parallel_flanks(scene, errors, concave, convex):
    """Rolled or not: a body and its parallel one envelop parallel surfaces under one motion."""
    found = cut(planned(scene, *errors))
    np.testing.assert_allclose(found["concave"][2], concave, rtol=0.0, atol=1e-5)
    np.testing.assert_allclose(found["convex"][2], convex, rtol=0.0, atol=1e-5)


def test_a_blade_angle_error_grows_with_the_height_over_the_tip_plane():
    job = planned(FORMATE, "head.outer_angle_deg=0.02")
    frame, found = head_frame(job.scene["generator"], 0.0), cut(job, names=("concave", "convex", "bottom"))
    points, _, deviation = found["concave"]
    height = -(points - frame[:3, 3]) @ frame[:3, 2]  # the head's z goes into the gear
    np.testing.assert_allclose(deviation, -1e3 * height / cos(ALPHA) * tan(radians(0.02)), rtol=0.0, atol=1e-4)
    np.testing.assert_allclose(found["convex"][2], 0.0, atol=1e-6)
    np.testing.assert_allclose(found["bottom"][2], 0.0, atol=1e-6)


def test_worn_tips_leave_material_on_the_bottom_land():
    found = cut(planned(FORMATE, "head.tip_wear_um=7"), names=("bottom",))
    np.testing.assert_allclose(found["bottom"][2], 7.0, rtol=0.0, atol=1e-6)


def test_a_pinion_s_errors_act_on_the_roll_and_on_the_axes_of_six():
    """Settings move the head, worn blades leave material, the mounting moves the pinion: all add up."""
    settings = {"radial_distance_um": 10.0, "tilt_deg": 0.004}
    errors = [f"generator.{key}={value}" for key, value in settings.items()]
    job = planned(HYPOID, *errors, "head.outer_wear_um=4", "head.inner_wear_um=2", "mounting_distance_um=5")
    u, v = np.meshgrid(np.linspace(0.01, 0.99, 5), np.linspace(0.01, 0.99, 3))
    rolled, stepped, exact = cut(job, "roll"), cut(job, "phoenix"), cut(planned(HYPOID), "phoenix")
    for side, (points, normals, deviation) in rolled.items():
        patch = job.part.patch(side)
        phi = patch.pose_parameter(*(x.ravel() for x in patch.locate(u, v)))
        by_hand = np.sum(moved(job.scene["generator"], settings, phi, points) * normals, axis=1) - 5.0 * normals[:, 2]
        by_hand += {"concave": 4.0, "convex": 2.0}[side]
        np.testing.assert_allclose(deviation, by_hand, rtol=0.0, atol=0.02)
        np.testing.assert_allclose(stepped[side][2] - exact[side][2], deviation, rtol=0.0, atol=0.05)


def test_what_has_errors_is_judged_against_what_was_intended():
    """A large error fails: it is neither measured against itself, nor trimmed, nor out of the witnesses' sight."""
    bad = run(
        FORMATE, overrides=(*SMALL, "errors.generator.machine_centre_to_back_um=300", "metrology.tolerance_um=20.0")
    )
    assert bad.verdict == "fail"
    assert "not judged: nominal" in bad.headline
    found = grids(list(bad.measurements.values()))
    for surface in ("concave", "convex"):
        assert found[surface, "plunge"].deviation.value[1].min() > 0.03
        assert found[surface, "plunge"].gap.max_um < 1e-6
        assert np.abs(found[surface, "nominal"].deviation.value).max() < 1e-9
        assert not found[surface, "plunge"].trimmed.any()
    assert bad.measurements["", "plunge", "tri-dexel"].check_um < 1e-3
    assert any("generator.machine_centre_to_back_um = 300" in note for note in bad.job.notes)


@pytest.mark.parametrize(("scene", "override", "message"), [
    (FLANK, "errors.tool_radius_um=2000", "errors.tool_radius_um: got 2000"),
    (FLANK, "errors.tool_form_um=-1.0", "errors.tool_form_um: got -1"),
    (FLANK, "errors.tool_corner_um=-900", "errors of the tool leave none: the corner's radius = -0.1 mm"),
    (FLANK, "errors.tool_raduis_um=1", "did you mean 'tool_radius_um'?"),
    (FORMATE, "errors.generator.ratio_of_roll=0.001", "nothing rolls (surface.generated = false); remove it"),
    (FORMATE, "errors.head.inner_wear_um=-1", "errors.head.inner_wear_um: got -1"),
    (FORMATE, "errors.head.edge_radius_um=999", "point_width = 2.54 mm must exceed"),
    (FORMATE, "errors.generator.tilt_deg=nan", "errors.generator.tilt_deg: got nan"),
    (HYPOID, "errors.convex.head.radius_um=1", "one head cuts both flanks; give [convex] or remove the table"),
])  # fmt: skip
def test_errors_that_cannot_be_are_refused(scene, override, message, capsys):
    assert main(["run", scene, "--dry-run", "--set", override]) == 2
    assert message in capsys.readouterr().err


def test_alike_spaces_and_a_gear_off_its_axis_exclude_each_other(capsys):
    whole = ["--set", "stock.pitch_mm=1.0", "--set", 'stock.spaces="all"', "--set", "errors.eccentricity_um=5"]
    for scene in (FLANK, GENERATED, HYPOID):
        assert main(["run", scene, "--dry-run", *whole]) == 2
        assert "the spaces of a gear off its axis are not alike" in capsys.readouterr().err


def test_the_study_of_worn_blades_is_a_study_and_no_scene():
    text = files("gearsim.scenes").joinpath("studies/blade-wear.toml").read_text("utf-8")
    tables = tomllib.loads(text)
    study = tables["study"]
    assert "blade-wear" not in scene_names()
    fixed = [f"{key}={value}" for key, value in study["set"].items()]
    varied = [v["key"].removeprefix("errors.") for v in tables["vary"]]
    assert prod(len(v["values"]) for v in tables["vary"]) == 75
    most = [f"errors.{key}={v['values'][-1]}" for key, v in zip(varied, tables["vary"], strict=True)]
    scene, _ = load_scene(study["scene"], (*fixed, *most))
    assert scene.errors.acting() == ["head.edge_radius_um = 100", "head.inner_wear_um = 20", "head.outer_wear_um = 20"]
