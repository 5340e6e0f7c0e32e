"""Predicted local gouging against the cut: contacts alone, causes of overcut, files, exit codes."""

import json
from dataclasses import replace

import numpy as np
import pytest

from gearsim.cutters.catalogue import bull
from gearsim.errors import InputError
from gearsim.gouging.attribution import Cause, straight_distance, tool_distance
from gearsim.gouging.prediction import predict_path
from gearsim.output.write import write_result
from gearsim.processes.run import plan, run, study
from gearsim.scene import check_scene, load_scene
from gearsim.simulation.operation import Variant
from gearsim.surfaces.nurbs_file import load_surfaces
from gearsim.toolpaths.sculptured import contact_path
from tests.surfaces.nurbs_shapes import sphere

SMALL = ("metrology.rows=41", "metrology.columns=13", "toolpath.stepover_mm=8", "toolpath.points=33")


def cut_with(result, tool="chosen"):
    """What one tool of a result cut."""
    return next(m.cut for k, m in result.measurements.items() if k[1:] == (f"{tool} tool", "gouging"))


def sizes_of(result):
    return next(m.sizes for k, m in result.measurements.items() if k[2] == "largest mill")


@pytest.fixture(scope="module")
def gouged():
    return run("gouge-horizontal-free-form", overrides=SMALL)


def test_every_contact_cut_alone_shows_the_predicted_curvature(gouged):
    for name in ("chosen", "larger"):
        rings = cut_with(gouged, name).rings
        assert len(rings.contact) > 200
        assert not rings.disagree.any()
        np.testing.assert_allclose(rings.found[~rings.near], rings.predicted[~rings.near], atol=1e-4)
        assert rings.gouging.any() == (name == "chosen")


def test_overcut_is_local_or_global_and_never_unpredicted(gouged):
    chosen, larger = cut_with(gouged), cut_with(gouged, "larger")
    assert chosen.made.count(Cause.LOCAL) > 100
    assert chosen.made.count(Cause.UNPREDICTED) == chosen.made.count(Cause.UNKNOWN) == 0
    assert larger.made.cause.max() == Cause.NONE
    assert larger.deviation.value.min() > -1e-9
    assert (gouged.verdict, gouged.exit_code) == ("fail", 1)


def test_overcut_is_as_deep_as_the_arc_in_the_parabola(gouged):
    """By brute force in the profile's plane: arcs of 15 mm that touch the parabola, against points of it."""
    t = np.linspace(0.02, 0.98, 2001)
    profile = np.stack([20.0 * (1.0 - t) ** 2, 20.0 * t**2], axis=1)
    slope = np.stack([-2.0 * (1.0 - t), 2.0 * t], axis=1)
    normal = np.stack([slope[:, 1], -slope[:, 0]], axis=1) / np.linalg.norm(slope, axis=1)[:, None]
    centres = profile + 15.0 * normal
    distance = np.linalg.norm(profile[::10, None] - centres[None], axis=2) - 15.0
    # depth along the normal and to the arc differ at second order only: 0.07 mm in 15
    assert 1e3 * distance.min() == pytest.approx(1e3 * cut_with(gouged).deviation.value.min(), rel=0.03)


def test_machined_points_touch_the_tool_by_a_search_of_its_own(gouged):
    assert all(cut_with(gouged, name).check_um < 1e-4 for name in ("chosen", "larger"))


def test_a_tie_is_neither(tmp_path):
    result = run("gouge-size-vertical-cylinder", overrides=(*SMALL, "toolpath.points=5"))
    chosen = cut_with(result)
    assert (chosen.contacts.decision == 1).all()
    assert chosen.made.cause.max() == Cause.NONE
    assert np.abs(chosen.deviation.value).max() < 1e-9
    assert cut_with(result, "larger").made.count(Cause.LOCAL) == chosen.grid.point[..., 0].size
    assert (sizes_of(result).whole.best.shank, sizes_of(result).whole.khan) == (20.0, (18.0, 18.0))
    assert result.exit_code == 0


def test_a_tool_that_meets_another_part_of_the_surface_gouges_globally():
    """On the flat tail of the standing parabola a shank of 20 mm is free, and 20 mm on it cuts the other tail."""
    scene = {
        "scene": {"name": "bowl"},
        "surface": {"kind": "nurbs", "file": "khan-9-2-free-form"},
        "cutter": {"kind": "ball", "diameter_mm": 40.0, "height_mm": 80.0},
        "toolpath": {"along": "u", "stepover_mm": 60.0, "points": 3, "margin": 0.1},
        "metrology": {"rows": 21, "columns": 5, "window_mm": 14.0},
    }
    result = run(check_scene(scene, "bowl"))
    made = cut_with(result).made
    assert made.count(Cause.GLOBAL) > 0
    assert made.count(Cause.UNPREDICTED) == 0
    assert np.nanmin(made.apart[made.cause == Cause.GLOBAL]) > 1.0


def test_dropped_tools_never_touch_where_gouging_is_predicted():
    surface, cutter = load_surfaces("khan-9-1-free-form")[0], bull(40.0, 15.0, 60.0)
    path = contact_path(surface, cutter, 30.0, 33, along="v", margin=0.02)
    assert predict_path(surface, cutter, path).gouges.any()
    settings = ("toolpath.stepover_mm=40", "toolpath.points=9", "toolpath.chord_um=0.9", "metrology.rows=31")
    result = run("gouge-free-form-dropped", overrides=(*settings, "metrology.columns=5", "metrology.tolerance_um=1.0"))
    cut = cut_with(result)
    assert not cut.contacts.gouges.any()
    assert cut.made.cause.max() == Cause.NONE
    assert result.exit_code == 0
    left = 1e3 * np.nanmax(cut.deviation.value)
    assert f"up to {left:.4g} um of material is left, which nothing is held against" in result.headline
    compared = f"compared at {len(cut.rings.contact):,} of {cut.contacts.touches.sum():,} contacts"
    assert (compared in result.headline) == (len(cut.rings.contact) < cut.contacts.touches.sum())


def test_straight_moves_are_as_near_as_their_nearest_instant():
    cutter, random = bull(10.0, 2.0, 30.0), np.random.default_rng(3)
    start, end, point = random.uniform(-8.0, 8.0, (3, 40, 3))
    t = np.linspace(0.0, 1.0, 4001)
    swept = start[:, None] + t[:, None] * (end - start)[:, None]
    wanted = tool_distance(cutter, swept, point[:, None]).min(axis=1)
    np.testing.assert_allclose(straight_distance(cutter, start, end, point), wanted, atol=2e-3)


def test_a_tool_that_cuts_no_sample_is_unchecked():
    """Three passes 60 mm apart and windows of a micrometre: no ray of the grid meets a cut."""
    few = ("toolpath.stepover_mm=60", "toolpath.points=5", "metrology.window_mm=0.001", "metrology.margin=0.1")
    result = run(
        "gouge-size-horizontal-free-form", overrides=(*few, "metrology.columns=8", "metrology.tolerance_um=1.0")
    )
    assert not cut_with(result).deviation.measured.any()
    assert (result.verdict, result.exit_code) == ("unchecked", 3)
    assert "no operation touches the surface with the chosen tool" in result.status
    assert "samples are met by no cut within metrology.window_mm" in result.headline
    assert "10 % of the surface was left out at every edge" in result.headline


def test_worked_examples_that_choose_none_are_refused():
    assert run("gouge-cases").verdict == "pass"
    with pytest.raises(InputError, match="no worked example of these sections begins with 'no such example'"):
        run("gouge-cases", overrides=('reference.names=["no such example"]',))


def test_the_files_of_a_run(gouged, tmp_path):
    write_result(gouged, tmp_path)
    names = {f.name for f in tmp_path.iterdir()}
    assert {"report.json", "report.md", "report.html", "deviation.exr", "tool_size.exr", "samples.parquet", "tooth.vtp",
            "deviation.png", "gouging.png", "tool_size.png", "curvature.png"} <= names  # fmt: skip
    report = json.loads((tmp_path / "report.json").read_text())
    measured = report["measurements"][gouged.job.part.surfaces.copy().popitem()[0]]["chosen_tool"]
    assert measured["gouging"]["cut_alone"]["disagree"] == 0
    assert measured["gouging"]["overcut_samples"]["local"] == cut_with(gouged).made.count(Cause.LOCAL)
    assert measured["largest_mill"]["optimum"]["corner_mm"] == 14.1
    assert report["measurements"]["part"]["printed"]["worked_examples"]["differ"] == 1
    import OpenEXR

    channels = OpenEXR.File(str(tmp_path / "deviation.exr"), separate_channels=True).parts[1].channels
    um = channels["deviation.um"].pixels
    np.testing.assert_allclose(um, 1e3 * cut_with(gouged).deviation.value, rtol=1e-6)


def test_refused_scenes():
    scene, _ = load_scene("gouge-horizontal-free-form")
    tables = scene.model_dump(exclude_none=True)
    with pytest.raises(InputError, match="run along u or v"):
        check_scene({**tables, "toolpath": {**tables["toolpath"], "along": "x"}}, "s")
    with pytest.raises(InputError, match="chord_um must be below"):
        check_scene({**tables, "toolpath": {**tables["toolpath"], "chord_um": 2.0}}, "s")
    with pytest.raises(InputError, match=r"no worked example in section '9\.9'"):
        check_scene({**tables, "reference": {"sections": ["9.9"]}}, "s")
    with pytest.raises(InputError, match="holds 1 surfaces"):
        run(check_scene({**tables, "surface": {**tables["surface"], "number": 2}}, "s"))
    with pytest.raises(InputError, match="corner radius"):
        check_scene({**tables, "catalogue": {"mills": [[2.0, 3.0]]}}, "s")


def test_a_sphere_is_not_reached_from_below():
    path = contact_path(sphere(10.0), bull(4.0, 1.0, 30.0), 6.0, 9, along="v")
    below = path.touches.normal[:, 2] < -1e-6
    assert below.any()
    assert np.isnan(path.touches.tip[below]).all()


def test_the_larger_tool_in_the_place_of_the_chosen_one_cuts_what_it_cuts_beside_it(gouged):
    job = plan(*load_scene("gouge-horizontal-free-form", SMALL))
    table = study(job, {"larger": {"chosen tool": "larger tool"}})
    lines = {(row["change"], row["variant"]): row for row in table if row["inspection"] == "gouging"}
    named = ("change", "variant")
    alone = {k: v for k, v in lines["larger", "chosen tool"].items() if k not in named}
    assert alone == {k: v for k, v in lines["", "larger tool"].items() if k not in named}
    assert alone["contacts_gouging"] == 0 < lines["", "chosen tool"]["contacts_gouging"]


def test_a_tool_whose_contacts_are_not_known_does_not_stand_in_for_the_chosen_one(gouged):
    job = gouged.job
    (made_by,) = job.variant("chosen tool").operations
    strange = Variant("chosen tool", "", (replace(made_by, name="a stranger"),))
    with pytest.raises(InputError, match=r"contacts of 'a stranger' are not known.*'chosen tool', 'larger tool'"):
        study(job, {"another": {"chosen tool": strange}})
