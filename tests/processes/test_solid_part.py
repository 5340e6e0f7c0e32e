"""Solid parts: operations in sequence on a blank, held against the intended solid at every ray's ends."""

from math import pi, tan

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.output.report import report_text
from gearsim.output.summary import summary
from gearsim.processes.run import estimate, run
from gearsim.scene import check_scene, load_scene, scene_table
from gearsim.scene.stock import TurnedTable

COARSE = ("stock.pitch_mm=1.0",)


def changed(change, pitch=1.0):
    tables = scene_table(load_scene("drill-grid")[0])
    tables["stock"]["pitch_mm"] = pitch
    change(tables)
    return run(check_scene(tables, "changed"))


def turned(*corners):
    return {"kind": "turned", "outline_mm": corners}


def measured(result):
    return result.measurements["", "program", "stock"]


def exact_volume():
    """Six holes of 6 through 12 mm, three of 5 and 8 deep with their points, a slot of 4 x 3 x 60 mm."""
    point = 2.5 / tan(59.0 * pi / 180.0)
    blind = pi * 2.5**2 * (8.0 - point + point / 3.0)
    return 6.0 * pi * 9.0 * 12.0 + 3.0 * blind + 4.0 * 3.0 * 60.0


def test_the_plate_comes_out_as_it_is_meant():
    result = run("drill-grid", overrides=COARSE)
    assert (result.verdict, result.exit_code) == ("pass", 0)
    (solid,) = measured(result).surfaces
    assert solid.ends > 5000
    assert -1e-6 < solid.overcut <= solid.excess < 1e-6
    assert "by one road only, at the ends of a tri-dexel's rays" in result.headline
    assert "Tolerances: solid: ±0.1 µm." in report_text(result, summary(result) | {"not_drawn": []}, {}, [])


def test_its_volume_converges_to_the_closed_form():
    errors = []
    for pitch in (1.0, 0.25):
        found = measured(run("drill-grid", overrides=(f"stock.pitch_mm={pitch}",)))
        removed = np.subtract(found.blank_volumes, found.stock.volumes)
        errors.append(np.abs(removed - exact_volume()).max() / exact_volume())
    assert errors[1] < 0.01
    assert errors[1] < 0.5 * errors[0]


@pytest.mark.parametrize("um", [2.0, 10.0, 100.0])
def test_a_slot_too_deep_or_too_shallow_is_found_with_its_depth_and_place(um):
    def cut(by):
        def change(tables):
            tables["operations"][2]["points_mm"] = ((-4.0, 20.0, -3.0 - by), (64.0, 20.0, -3.0 - by))

        return changed(change)

    deep, shallow = cut(1e-3 * um), cut(-1e-3 * um)
    for result, sign in ((deep, -1.0), (shallow, 1.0)):
        assert result.exit_code == 1
        (found,) = (f for f in result.findings if f.kind == "stock_out_of_tolerance")
        assert found.depth_um == pytest.approx(sign * um, abs=1e-3)
        assert 18.0 < found.place_mm[1] < 22.0
        assert found.place_mm[2] == pytest.approx(-3.0 + sign * 1e-3 * um)


@pytest.mark.parametrize("tolerance", ["1e-5", "1e-2"])
def test_ends_cut_less_exactly_are_still_known_for_what_made_them(tolerance):
    result = run("drill-grid", overrides=(*COARSE, f"simulation.tolerance_mm={tolerance}"))
    (solid,) = measured(result).surfaces
    assert max(-solid.overcut, solid.excess) < 2.0 * float(tolerance)
    assert measured(result).contour.mesh.open_edges == 0


def test_memory_is_asked_for_once_for_all_operations():
    scene, folder = load_scene("drill-grid", COARSE)
    few = estimate(scene, folder)
    thrice = scene.model_copy(update={"operations": scene.operations * 3})
    many = estimate(thrice, folder)
    assert many["rays"] == 3 * few["rays"]
    assert many["memory_mb"] == few["memory_mb"]


def test_what_was_forgotten_fails():
    result = changed(lambda tables: tables.update(operations=tables["operations"][:2]))
    assert result.verdict == "fail"
    (found,) = (f for f in result.findings if f.kind == "stock_out_of_tolerance")
    assert found.depth_um == pytest.approx(2000.0, abs=501.0)  # the slot's middle is 2 mm off its walls


def test_a_blank_that_is_wholly_gone_is_unchecked():
    def change(tables):
        tables["stock"]["blank"] = {"kind": "block", "lower_mm": (28.0, 6.0, -4.0), "upper_mm": (32.0, 10.0, -1.0)}

    result = changed(change, 0.5)
    assert (result.verdict, result.exit_code) == ("unchecked", 3)
    assert "no ray of the stock holds any material" in result.headline


def test_rapids_that_begin_too_low_go_through_material():
    def change(tables):
        tables["operations"][1].update(clear_mm=-1.0)

    result = changed(change)
    (told,) = (f for f in result.findings if f.kind == "rapid_cut")
    assert "a rapid move of blind holes goes through material" in told.text
    assert told.fails


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t["operations"][0].update(tool=7), r"operations.0.tool: got 7; \[\[tools\]\] has 1, 2, 3"),
        (lambda t: t["operations"][0].update(clear_mm=-20.0), "must be above bottom_mm"),
        (lambda t: t["operations"][2].update(clear_mm=-3.0), "must be above all points"),
        (lambda t: t["stock"].pop("blank"), "stock.blank: missing"),
        (lambda t: t["tools"][1].update(number=1), "must differ"),
        (lambda t: t["operations"][0].update(peck_mm=4e-9), "peck_mm of 4e-09 mm over 16 mm makes more than"),
        (
            lambda t: t["surface"].update(body=turned((0, 0), (9, 0), (9, 5), (9, 5), (0, 5))),
            "corner 3 of 5 is the next",
        ),
        (lambda t: t["surface"].update(body=turned((0, 0), (9, 0), (0, 5), (0, 0))), "corner 4 of 4 is the next"),
        (
            lambda t: t["surface"].update(body=turned((9, 0), (2, 5), (9, 5), (2, 0))),
            "after corner 1 and after corner 3",
        ),
        (
            lambda t: t["surface"].update(body=turned((1, 0), (4, 5), (1, 10), (7, 10), (4, 5), (7, 0))),
            "after corner 1 and after corner 4",
        ),
        (lambda t: t["tools"][0]["cutter"].update(point_angle_deg=180.0), "point_angle_deg"),
    ],
)
def test_what_cannot_be_is_told(change, message):
    with pytest.raises(InputError, match=message):
        changed(change)


def parted(tables):
    """A bar that a slot across it parts into two blocks."""
    body = {"kind": "block", "lower_mm": (0.0, 0.0, -10.0), "upper_mm": (40.0, 20.0, 0.0)}
    slot = {"kind": "block", "lower_mm": (18.0, -1.0, -11.0), "upper_mm": (22.0, 21.0, 5.0)}
    tables["surface"].update(body=body, minus=[{"shape": slot}])
    tables["stock"]["blank"] = dict(body)
    tables["operations"] = [{**tables["operations"][2], "points_mm": ((20.0, -4.0, -11.0), (20.0, 24.0, -11.0))}]


def test_a_piece_that_is_missing_as_a_whole_fails_though_no_end_lies_off_the_part():
    def of_half_a_bar(tables):
        parted(tables)
        tables["stock"]["blank"]["upper_mm"] = (18.0, 20.0, 0.0)

    assert changed(parted, 2.0).verdict == "pass"
    result = changed(of_half_a_bar, 2.0)
    (told,) = (f for f in result.findings if f.kind == "stock_out_of_tolerance")
    assert (result.verdict, told.depth_um) == ("fail", pytest.approx(-5000.0))
    assert told.place_mm[0] > 22.0


@pytest.mark.parametrize("at", [(30.0, 12.0), (300.0, 12.0)], ids=["between rays", "off the body"])
def test_a_hole_that_no_ray_meets_is_not_judged(at):
    def change(tables):
        shape = {"kind": "cylinder", "diameter_mm": 0.2, "bottom_mm": -20.0, "top_mm": 5.0}
        tables["surface"]["minus"] = [*tables["surface"]["minus"], {"shape": shape, "at_mm": (at,)}]

    result = changed(change)
    assert result.verdict == "unchecked"
    assert (
        f"no ray meets 1 of 11 shapes that surface.minus takes from the body, one about ({at[0]:g}" in result.headline
    )


def test_an_operation_that_begins_within_the_blank_goes_there_by_rapid():
    def change(tables):
        tables["operations"][1].update(clear_mm=-2.0)
        tables["operations"] = tables["operations"][1:2]

    result = changed(change)
    (told,) = (f for f in result.findings if f.kind == "rapid_cut")
    assert told.fails
    assert told.place_mm[2] > -2.0


def test_the_rays_that_were_announced_are_those_that_are_cut():
    scene, folder = load_scene("drill-grid", COARSE)
    counts = run("drill-grid", overrides=COARSE).counts
    assert estimate(scene, folder)["rays"] == counts["rays"] - counts["following_rays"]
    assert counts["following_rays"] > 0  # the drill goes down by rapid where it has been


@pytest.mark.parametrize(("diameter", "verdict"), [(30.0, "fail"), (4.0, "pass")])
def test_a_holder_is_held_against_what_stands(diameter, verdict):
    """The first drill cuts 5 mm high; what is above it follows it into holes of 6 mm, 12 mm deep."""

    def change(tables):
        tables["tools"][0]["cutter"]["height_mm"] = 5.0
        tables["tools"][0]["holder"] = {"sections_mm": ((diameter, diameter, 40.0),)}

    result = changed(change)
    told = [f.text for f in result.findings if f.kind == "holder_cut"]
    assert result.verdict == verdict
    assert len(told) == (verdict == "fail")
    assert all("the holder of through holes touches material" in text for text in told)


def test_an_outline_may_come_back_to_the_axis_and_to_a_line_it_was_on():
    """Two cones, tip to tip; a disc with two feet."""
    for corners in (
        ((0, 0), (8, 0), (0, 5), (8, 10), (0, 10)),
        ((1, 0), (2, 0), (2, 1), (4, 1), (4, 0), (5, 0), (5, 2), (1, 2)),
    ):
        assert TurnedTable(**turned(*corners)).build().volume > 0.0
