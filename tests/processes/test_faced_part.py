"""Parts bounded by NURBS faces: what comes out, gouges put in, what is left, holders, what cannot be."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.geometry.rigid import Rigid
from gearsim.metrology.holder_check import HolderInspection
from gearsim.metrology.stock_check import StockInspection
from gearsim.processes.run import estimate, plan, run_job
from gearsim.scene import check_scene, load_scene, scene_table

AS_OVER = {f"{name} {what}": name for what in ("fillet", "platform")
           for name in ("leading edge", "suction side", "trailing edge", "pressure side")}  # fmt: skip


def coarse(name, **operation):
    """A shipped scene in one operation over all its faces, with few passes, rays and samples, and limits to fit."""
    tables = scene_table(load_scene(name)[0])
    faces = [face["name"] for face in tables["surface"]["faces"]]
    tables["stock"]["pitch_mm"] = 2.0
    tables["metrology"].update(rows=3, columns=3)
    for face in tables["surface"]["faces"]:
        face.update(overcut_um=8.0, excess_um=400.0)
    own = {"faces": tuple(faces), "stepover_mm": 1.5, "points": 5, "chord_um": 5.0, "allowances_mm": (0.0,)}
    tables["operations"] = [{**tables["operations"][-1], **own, **operation}]
    return tables


def channel(**operation):
    return coarse("impeller-channel", **operation)


def blade():
    """Its tip is left to the blank, which ends there."""
    tables = coarse("blade-tip", axis={"kind": "leaning", "lean_deg": 20.0, "as_over": AS_OVER})
    tables["surface"]["faces"] = tables["surface"]["faces"][:12]
    tables["operations"][0]["faces"] = tables["operations"][0]["faces"][:12]
    tables["stock"]["blank"]["upper_mm"] = (17.0, 9.0, 20.0)
    tables["operations"][0].update(stepover_mm=2.0, points=5)
    for face in tables["surface"]["faces"]:
        face["excess_um"] = 1000.0
    tables["stock"]["pitch_mm"] = 0.7  # the tip has small faces
    tables["operations"].insert(0, scene_table(load_scene("blade-tip")[0])["operations"][0])
    return tables


def gouged(job, um, face):
    """The job with the passes over a face once more, so much deeper in the middle of their ball's way."""
    (own,) = (v for v in job.variants if v.surfaces == (face,))
    patch = job.part.patch(face)
    normal = patch.jet(*patch.locate(np.array([0.5]), np.array([0.5]))).normal[0]
    (passes,) = own.operations
    deeper = passes.table.moved(Rigid(np.eye(3), -1e-3 * um * normal))
    whole = job.variant(job.main)
    return job.under({job.main: replace(whole, operations=(*whole.operations, replace(passes, table=deeper)))})


@cache
def made(scene):
    job = plan(check_scene(scene(), "coarse"))
    return job, run_job(job)


def ends(result):
    return {found.surface: found for found in result.measurements["", "program", "stock"].surfaces}


@pytest.mark.parametrize("scene", [channel, blade])
def test_every_face_comes_out_and_is_judged_by_its_own_tolerance(scene):
    job, result = made(scene)
    assert (result.verdict, result.exit_code, result.findings) == ("pass", 0, ())
    (stock,) = (i for i in job.inspections if isinstance(i, StockInspection))
    assert set(ends(result)) == set(stock.intended.tolerances)
    assert all(found.ends for found in ends(result).values())
    for name in stock.intended.tolerances:
        if name not in job.part.surfaces:
            assert max(-ends(result)[name].overcut, ends(result)[name].excess) < 1e-9  # the blank's own
    for name in job.part.surfaces:
        assert result.measurements[name, "own passes", "dense grid"].gap.valid == 9


@pytest.mark.parametrize(("scene", "face"), [(channel, "hub"), (blade, "suction side platform")])
def test_a_gouge_of_ten_micrometres_is_found_on_its_face(scene, face):
    job, _ = made(scene)
    asked = [i for i in job.inspections if getattr(i, "surface", face) == face and not isinstance(i, HolderInspection)]
    part = replace(job.part, surfaces={face: job.part.surfaces[face]})
    result = run_job(gouged(replace(job, inspections=tuple(asked), part=part), 10.0, face))
    assert (result.verdict, result.exit_code) == ("fail", 1)
    deepest = {f.kind: f.depth_um for f in result.findings if f.patch == face and f.fails}
    assert deepest["out_of_tolerance"] == pytest.approx(-10.0, abs=3.0)
    assert deepest["stock_out_of_tolerance"] == pytest.approx(-10.0, abs=4.0)


def stock_alone(tables):
    job = plan(check_scene(tables, "changed"))
    asked = tuple(i for i in job.inspections if isinstance(i, StockInspection))
    return run_job(replace(job, inspections=asked, part=replace(job.part, surfaces={})))


def test_a_groove_where_nothing_is_machined_is_a_gouge_there():
    tables = channel()
    mill = {"kind": "flat", "diameter_mm": 6.0, "height_mm": 9.0}
    tables["tools"] = (*tables["tools"], {"number": 2, "cutter": mill})
    tables["operations"] = [{
        "kind": "mill", "name": "groove", "tool": 2, "points_mm": ((-24.0, 35.0, 25.99), (-12.0, 35.0, 25.99)),
        "clear_mm": 28.0, "feed_mm_min": 500.0,
    }]  # fmt: skip
    result = stock_alone(tables)
    (found,) = (f for f in result.findings if f.fails and f.depth_um < 0.0)
    assert (found.kind, found.patch) == ("stock_out_of_tolerance", "left top")
    assert found.depth_um == pytest.approx(-10.0, abs=1e-3)


@pytest.mark.parametrize("finished", [True, False])
def test_a_face_is_left_as_high_as_it_likes_only_where_that_is_said(finished):
    tables = channel(faces=("left wall", "left fillet", "right fillet", "right wall"))
    tables["operations"].append({**tables["operations"][0], "faces": ("hub",), "allowances_mm": (0.4,)})
    for face in tables["surface"]["faces"]:
        if face["name"] == "hub":
            face.pop("excess_um")
            face.update({"excess_um": 100.0} if finished else {})
    result = stock_alone(tables)
    assert [(f.patch, f.fails) for f in result.findings] == [("hub", True)] * finished
    assert result.verdict == ("fail" if finished else "pass")
    assert 0.3 < ends(result)["hub"].excess < 0.7


def test_a_face_that_no_ray_ends_at_is_not_judged():
    tables = channel()
    tables["stock"]["pitch_mm"] = 9.0
    result = stock_alone(tables)
    assert result.verdict == "unchecked"
    assert "no ray of the whole part ends at" in result.headline


@pytest.mark.parametrize(("height", "touches"), [(8.0, True), (25.0, False)])
def test_a_holder_wider_than_what_its_cutter_opens_touches(height, touches):
    tables = channel()
    tables["tools"][0]["cutter"]["height_mm"] = height
    tables["tools"][0]["holder"] = {"sections_mm": ((16.0, 16.0, 30.0),)}
    tables["operations"] = [{
        "kind": "mill", "name": "plunge", "tool": 1, "points_mm": ((2.0, 20.0, 27.0), (2.0, 20.0, 12.0)),
        "clear_mm": 28.0, "feed_mm_min": 500.0,
    }]  # fmt: skip
    job = plan(check_scene(tables, "held"))
    asked = tuple(i for i in job.inspections if isinstance(i, HolderInspection))
    result = run_job(replace(job, inspections=asked))
    assert bool([f for f in result.findings if f.kind == "holder_cut"]) == touches


def test_the_rays_that_were_announced_are_those_that_are_cut():
    counts = made(channel)[1].counts
    assert estimate(check_scene(channel(), "coarse"))["rays"] == counts["rays"] - counts["following_rays"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t["surface"].update(file="impeler-chanel"), "did you mean 'impeller-channel'"),
        (lambda t: t["surface"]["faces"][0].update(number=23), "holds 22 faces, got number 23"),
        (lambda t: t["surface"]["faces"][0].update(number=8), "each number stands once"),
        (lambda t: t["surface"]["faces"][0].update(name="hub"), "each name stands once"),
        (lambda t: t["surface"]["faces"][0].update(name="left top"), "two faces of .* are called 'left top'"),
        (lambda t: t["operations"][0].update(faces=("hbu",)), r"0.faces: got 'hbu'; \[\[surface.faces\]\] has"),
        (lambda t: t["operations"][0]["axis"].update(faces=("hbu",)), "operations.0.axis.faces: got 'hbu'"),
        (lambda t: t["operations"][0].update(axis={"kind": "fixed", "direction": (0, 0, 0)}), "direction: .*must have"),
        (lambda t: t["operations"][0].update(tool=7), "operations.0.tool: got 7"),
        (lambda t: t["stock"].pop("blank"), "stock.blank: missing"),
        (lambda t: t["stock"].update(spaces="all"), "stock.spaces: got 'all'"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_told(change, message):
    tables = channel(faces=("hub",))
    if "left top" in message or "each" in message:
        tables["operations"][0]["axis"] = {"kind": "fixed"}
    change(tables)
    with pytest.raises(InputError, match=message):
        plan(check_scene(tables, "changed"))
