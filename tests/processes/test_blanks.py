"""Blanks from files: bodies from STL and STEP, and stock that another run has left."""

import json
from importlib.util import find_spec
from pathlib import Path
from zipfile import ZipFile

import numpy as np
import pytest

from gearsim.cli import main
from gearsim.errors import InputError
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.solid import Block
from gearsim.geometry.triangles import TriangleMesh
from gearsim.metrology.stock_check import StockInspection
from gearsim.metrology.stock_surfaces import cut_ends
from gearsim.output.report import report_text
from gearsim.output.solid_files import SolidSurface, write_solid
from gearsim.output.summary import summary
from gearsim.processes.blanks import Given, given_blank
from gearsim.processes.run import estimate, plan, run
from gearsim.scene import check_scene, load_scene, scene_table
from gearsim.scene.stock import StockTable
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.stock import blank_stock, turn_stock
from gearsim.simulation.stock_file import load_stock, save_stock
from gearsim.surfaces.solid_file import read_solid
from tests.geometry.test_faceted import FACES, block

PLATE = (np.array([0.0, 0.0, -12.0]), np.array([60.0, 40.0, 0.0]))


def write_stl(file, lower, upper, faces=FACES):
    none = np.full(len(faces), -1)
    write_solid(SolidSurface(TriangleMesh(block(lower, upper).points, faces, none), none, ()), file)


def text_stl(file, corners):
    facets = "".join(
        "facet normal 0 0 0\n outer loop\n"
        + "".join(f"  vertex {x!r} {y!r} {z!r}\n" for x, y, z in triangle.tolist())
        + " endloop\nendfacet\n"
        for triangle in corners
    )
    file.write_text(f"solid a plate\n{facets}endsolid a plate\n")


def plate(blank, operations=slice(None), name="plate", **stock):
    """The scene drill-grid with another blank."""
    tables = scene_table(load_scene("drill-grid")[0])
    tables["scene"]["name"] = name
    tables["stock"] = {"pitch_mm": 1.0, "blank": blank} | stock
    tables["operations"] = tables["operations"][operations]
    return tables


def toml(value):
    """A value as TOML has it in line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{k} = {toml(v)}" for k, v in value.items() if v is not None) + "}"
    return f"[{', '.join(map(toml, value))}]" if isinstance(value, list | tuple) else json.dumps(value)


def write_scene(file, tables):
    file.write_text("".join(f"{k} = {toml(v)}\n" for k, v in tables.items()))


def same(a, b):
    names = ("first", "lo", "hi", "lo_segment", "hi_segment")
    return all(np.array_equal(getattr(p, n), getattr(q, n)) for p, q in zip(a.left, b.left, strict=True) for n in names)


@pytest.fixture(scope="module")
def whole():
    return run(check_scene(plate({"kind": "block", "lower_mm": (0.0, 0.0, -12.0), "upper_mm": (60.0, 40.0, 0.0)}), ""))


def test_a_plate_from_a_file_is_cut_as_the_block_is(whole, tmp_path):
    write_stl(tmp_path / "plate.stl", *PLATE)
    result = run(check_scene(plate({"kind": "solid-file", "file": "plate.stl"}), "plate"), folder=tmp_path)
    found, meant = (r.measurements["", "program", "stock"] for r in (result, whole))
    assert same(found.stock, meant.stock)
    assert result.verdict == "pass"
    assert found.exact_blank_volume == 28_800.0
    assert [n for n in result.job.notes if "12 triangles, 60 x 40 x 12 mm; no unit is said in it, mm are assumed" in n]


def test_what_one_run_has_left_another_goes_on_from_with_the_same_bits(whole, tmp_path):
    """Through the command line: one operation, its stock.parquet, two more; and all three in one run."""
    block = {"kind": "block", "lower_mm": [0.0, 0.0, -12.0], "upper_mm": [60.0, 40.0, 0.0]}
    saved = {"kind": "saved", "file": "first/stock.parquet"}
    write_scene(tmp_path / "first.toml", plate(block, slice(0, 1), "first"))
    write_scene(tmp_path / "second.toml", plate(saved, slice(1, 3), "second", pitch_mm=None))
    codes = [
        main(["run", str(tmp_path / f"{name}.toml"), "--out", str(tmp_path / name), "--no-pictures", "--only", only])
        for name, only in (("first", "stock.parquet"), ("second", "stock.parquet,report.json,report.md,part.3mf"))
    ]
    assert codes == [1, 0]  # the slot is not there yet
    stock, job = load_stock(tmp_path / "second" / "stock.parquet")
    assert same(stock, whole.measurements["", "program", "stock"].stock)
    assert [d.name for d in stock.done] == ["through holes", "blind holes", "slot"]
    assert job == "second"
    told = json.loads((tmp_path / "second" / "report.json").read_text())
    assert "what first has left after: through holes" in str(told["notes"])
    assert "What an earlier run has left by a tri-dexel" in (tmp_path / "second" / "report.md").read_text()
    with ZipFile(tmp_path / "second" / "part.3mf") as package:
        assert b'"through holes"' in package.read("3D/3dmodel.model")


def test_a_saved_stock_has_its_own_pitch_and_box(whole, tmp_path):
    save_stock(whole.measurements["", "program", "stock"].stock, tmp_path / "stock.parquet", "plate")
    given = given_blank(StockTable(blank={"kind": "saved", "file": "stock.parquet"}), tmp_path)
    assert given.box(None) == given.saved.box
    lower, upper = given.solid.box
    assert np.allclose([lower, upper], PLATE, atol=1.0)  # a cell
    assert given.top == 0.0
    assert given.solid.contains(np.array([[30.0, 12.0, -6.0], [10.0, 8.0, -6.0]])).tolist() == [True, False]
    with pytest.raises(InputError, match=r"stock.pitch_mm = 2: stock.parquet was saved with 1; leave the key out"):
        given_blank(StockTable(pitch_mm=2.0, blank={"kind": "saved", "file": "stock.parquet"}), tmp_path)
    wide = plate({"kind": "saved", "file": "stock.parquet"})
    wide["surface"]["body"]["upper_mm"] = (90.0, 40.0, 0.0)
    with pytest.raises(InputError, match="does not hold the body of"):
        run(check_scene(wide, "wide"), folder=tmp_path)


def test_a_saved_stock_s_turned_box_holds_a_body_only_with_all_its_corners():
    turned = Rigid(np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]]), np.zeros(3))
    stock = blank_stock(DexelBox(turned, np.full(3, -5.0), np.full(3, 5.0), 1.0), Block(np.full(3, -1.0), np.ones(3)))
    given = Given(Block(np.full(3, -1.0), np.ones(3)), stock)
    reach = 25.0 / 7.0  # turned so, a cube's farthest corners lie 7/5 of that along an axis of the box
    inside, outside = (Block(np.full(3, -half), np.full(3, half)) for half in (reach - 1e-6, reach + 1e-6))
    assert given.box(None, [inside]) is stock.box
    with pytest.raises(InputError, match="does not hold the body"):
        given.box(None, [outside])


def test_text_and_binary_stl_are_the_same_body_in_any_unit(tmp_path):
    write_stl(tmp_path / "inch.stl", PLATE[0] / 32.0, PLATE[1] / 32.0)
    solid = read_solid(tmp_path / "inch.stl", 0.1, 32.0, np.array([1.0, 2.0, 3.0])).solid
    assert np.array_equal(solid.box, np.add(PLATE, [1.0, 2.0, 3.0]))
    text_stl(tmp_path / "text.stl", solid.mesh.points[solid.mesh.triangles])
    again = read_solid(tmp_path / "text.stl", 0.1, None, np.zeros(3)).solid
    assert np.array_equal(again.mesh.points, solid.mesh.points)
    assert again.volume == solid.volume


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "no whole STL file"),
        (b"x" * 100, "no whole STL file"),
        (b"solid a\nfacet\nouter loop\nvertex 0 0 0\nendloop\nendfacet\nendsolid a\n", "1 corners of 1 facets"),
        (b"solid a\nvertex 0 0 x vertex 0 0 0 vertex 0 0 0 endfacet\nendsolid a\n", "a corner is no number"),
        (b"solid a\nvertex 0 0 nan vertex 0 0 0 vertex 0 0 0 endfacet\nendsolid a\n", "triangle 1 is not finite"),
        (b"solid a\nvertex 0 0 2e5 vertex 0 0 0 vertex 0 1 0 endfacet\nendsolid a\n", "is its unit mm?"),
        (b"solid a\nendsolid a\n", "it has no triangles"),
        (b"solid a\nvertex 0 0 2 vertex 0 0 0 vertex 0 1 0 endfacet\nendsolid a\n", "its surface is not closed"),
    ],
)
def test_files_that_hold_no_body_are_refused(data, message, tmp_path):
    (tmp_path / "a.stl").write_bytes(data)
    with pytest.raises(InputError, match=message) as told:
        read_solid(tmp_path / "a.stl", 0.1, None, np.zeros(3))
    assert "a.stl" in str(told.value)


def test_other_files_are_refused(tmp_path):
    for name, message in (("a.obj", "a solid is read from .stl, .stp, .step"), ("a.stl", "cannot read solid")):
        with pytest.raises(InputError, match=message):
            read_solid(tmp_path / name, 0.1, None, np.zeros(3))
    with pytest.raises(InputError, match="says its unit itself; remove scale"):
        read_solid(tmp_path / "a.step", 0.1, 25.4, np.zeros(3))


@pytest.fixture(scope="module")
def step_file(tmp_path_factory):
    """A ball of 10 and a ring about z, written in inches."""
    if find_spec("OCP") is None:
        pytest.skip("needs the extra cad")
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
    from OCP.Interface import Interface_Static
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

    STEPControl_Writer()  # there are no settings before
    Interface_Static.SetCVal_s("write.step.unit", "INCH")
    writer = STEPControl_Writer()
    writer.Transfer(BRepPrimAPI_MakeSphere(10.0).Shape(), STEPControl_StepModelType.STEPControl_AsIs)
    file = tmp_path_factory.mktemp("step") / "ball.step"
    writer.Write(str(file))
    Interface_Static.SetCVal_s("write.step.unit", "MM")
    return Path(file)


def test_a_step_file_in_inches_comes_out_in_mm_within_its_chord(step_file):
    solid, told = read_solid(step_file, 0.05, None, np.zeros(3))
    assert "chord_mm 0.05" in told
    middle = solid.mesh.points[solid.mesh.triangles].mean(axis=1)
    assert np.allclose(np.linalg.norm(solid.mesh.points, axis=1), 10.0, atol=1e-6)
    assert 10.0 - np.linalg.norm(middle, axis=1).min() < 0.05
    assert solid.volume == pytest.approx(4.0 / 3.0 * np.pi * 1e3, rel=0.01)
    assert solid.mesh.open_edges == 0


def test_a_bar_is_turned_before_it_is_drilled(tmp_path):
    """From a bar of 50 to a disc of 40 with a bore: the body of the part, exactly; then two holes."""
    disc = ((5.0, -8.0), (20.0, -8.0), (20.0, 0.0), (5.0, 0.0))
    bar = {"kind": "cylinder", "diameter_mm": 50.0, "bottom_mm": -10.0, "top_mm": 1.0}
    tables = plate(
        bar, slice(0, 1), turning={"outline_mm": disc, "speed_m_min": 200.0, "feed_mm_rev": 0.2, "depth_mm": 2.0}
    )
    hole = {"shape": tables["surface"]["minus"][0]["shape"], "at_mm": ((12.5, 0.0), (-12.5, 0.0))}
    tables["surface"].update(body={"kind": "turned", "outline_mm": disc}, minus=(hole,))
    tables["operations"][0].update(at_mm=hole["at_mm"])
    result = run(check_scene(tables, "disc"))
    found = result.measurements["", "program", "stock"]
    (solid,) = found.surfaces
    assert result.verdict == "pass"
    assert max(-solid.overcut, solid.excess) < 1e-9
    assert [d.name for d in found.stock.done] == ["turning", "through holes"]
    left = np.pi * (20.0**2 - 5.0**2) * 8.0
    assert np.mean(found.turned.removed) == pytest.approx(np.pi * 25.0**2 * 11.0 - left, rel=0.01)
    assert found.turned.seconds == pytest.approx(60.0 * np.mean(found.turned.removed) / 80_000.0)
    assert np.mean(found.operations[0].removed) == pytest.approx(2.0 * np.pi * 9.0 * 8.0, rel=0.1)
    save_stock(found.stock, tmp_path / "stock.parquet")
    assert load_stock(tmp_path / "stock.parquet")[0].done == found.stock.done
    made = found.stock.operation_of(found.contour.mesh.tag)
    assert set(made.tolist()) == {0, 1}  # nothing of the bar's own surface is left
    assert found.contour.mesh.open_edges == 0
    told = report_text(result, summary(result) | {"not_drawn": []}, {}, [])
    assert "| turning | turning tool |" in told


def test_holders_meet_what_blank_and_turning_both_have(tmp_path):
    """An outline that reaches beyond the blank adds nothing to it."""
    bar = {"kind": "block", "lower_mm": (0.0, 0.0, -12.0), "upper_mm": (60.0, 40.0, 0.0)}
    wide = {"outline_mm": ((0.0, -12.0), (100.0, -12.0), (100.0, 40.0), (0.0, 40.0))}
    tables = plate(bar, slice(2, 3), pitch_mm=2.0, turning=wide)
    tables["tools"][2]["holder"] = {"sections_mm": [[30.0, 30.0, 40.0]]}
    found = {f.kind for f in run(check_scene(tables, "plate"), folder=tmp_path).findings}
    assert "holder_cut" not in found


def test_turning_keys_that_cannot_be_are_told():
    bar = {"kind": "cylinder", "diameter_mm": 50.0, "bottom_mm": -10.0, "top_mm": 1.0}
    for turning, message in (
        ({"speed_m_min": 200.0}, "give all three or none"),
        ({"outline_mm": ((0.0, 0.0), (1.0, 1.0), (2.0, 2.0))}, "enclose no area"),
        ({}, "stock.turning.outline_mm: missing; this part has no blank of its own"),
    ):
        with pytest.raises(InputError, match=message):
            run(check_scene(plate(bar, turning=turning), "bar"))


def test_a_bar_is_turned_to_the_gear_s_own_blank():
    """The same rays, cut alike, as where the gear's blank is there from the start."""
    small = ("metrology.rows=3", "metrology.columns=3", "toolpath.points=9", "stock.pitch_mm=4")
    bar = (
        "stock.blank.kind='cylinder'",
        "stock.blank.diameter_mm=400",
        "stock.blank.bottom_mm=-50",
        "stock.blank.top_mm=200",
    )
    job = plan(*load_scene("spiral-bevel-flank", (*small, *bar, "stock.turning.name='to the blank'")))
    (asked,) = (i for i in job.inspections if isinstance(i, StockInspection))
    assert asked.turning.kept is job.part.stock
    turned = turn_stock(blank_stock(asked.box, asked.blank), asked.turning.kept, asked.turning.name)
    meant = blank_stock(asked.box, job.part.stock)
    for a, b in zip(turned.left, meant.left, strict=True):
        assert np.array_equal(a.first, b.first)
        assert np.allclose(a.lo, b.lo, atol=1e-12)
        assert np.allclose(a.hi, b.hi, atol=1e-12)
    assert all((k.lo_segment == 0).all() for k in turned.left)
    assert not len(cut_ends(turned))  # none is held against the teeth


def test_a_saved_stock_s_rapids_and_rays_are_those_of_its_own_rays(whole, tmp_path):
    """Rapids down holes that were drilled before touch nothing, however near their walls; as many rays as announced."""
    save_stock(whole.measurements["", "program", "stock"].stock, tmp_path / "stock.parquet", "plate")
    tables = plate({"kind": "saved", "file": "stock.parquet"}, slice(0, 1), pitch_mm=None)
    scene = check_scene(tables, "again")
    result = run(scene, folder=tmp_path)
    (done,) = result.measurements["", "program", "stock"].operations
    assert not [f for f in result.findings if f.kind == "rapid_cut"]
    assert done.removed == (0.0, 0.0, 0.0)
    assert (done.volume == 0.0).all()
    assert estimate(scene, tmp_path)["rays"] == result.counts["rays"] - result.counts["following_rays"]
