"""Figures printed for one geometry stand beside no other; a new scene begins without them."""

import tomllib

import pytest

from gearsim.cli import main
from gearsim.processes.run import plan
from gearsim.scene import check_scene, load_scene, scene_names, scene_table
from gearsim.scene.printed import printed_elsewhere, without_reference

OF_NUMBERS = ("gouge-border", "gouge-cases", "gouge-flat-end-mill", "gouge-sizes", "gouge-verification")
WITH_PRINT = [name for name in scene_names() if "reference" in scene_table(load_scene(name)[0])]


@pytest.mark.parametrize("name", WITH_PRINT)
def test_built_in_scenes_keep_their_print(name, tmp_path):
    assert printed_elsewhere(load_scene(name)[0], tmp_path) == ""


@pytest.mark.parametrize(
    ("name", "override", "table"),
    [
        ("spiral-bevel-flank", "surface.pressure_angle_deg=20", "surface"),
        ("spiral-bevel-flank", "cutter.taper_deg=14", "cutter"),
        ("spiral-bevel-flank", "metrology.profile_offsets_mm=[0, 1, -1, 2, -2, 3, -3]", "metrology.profile_offsets_mm"),
        ("spur-external", "surface.teeth=31", "surface"),
        ("helical-internal", "surface.teeth=-81", "surface"),
        ("gouge-vertical-cylinder", "cutter.height_mm=70", "cutter"),
    ],
)
def test_another_geometry_is_not_set_beside_the_print_and_the_report_says_so(name, override, table):
    scene, folder = load_scene(name, [override])
    if hasattr(scene, "budget"):  # a third of what planning takes
        scene = scene.model_copy(update={"budget": None})
    job = plan(scene, folder)
    assert "reference" not in job.scene
    assert job.notes[-1].startswith(
        f"[reference] is left out: it is printed for the geometry of the built-in scene {name}"
    )
    assert job.notes[-1].endswith(f"{table} differs here")
    assert all(getattr(i, "published", None) is None for i in job.inspections)
    assert not any(i.name == "worked examples" for i in job.inspections)


@pytest.mark.parametrize(
    ("name", "override", "table"),
    [
        ("spiral-bevel-flank", "toolpath.file=own.cl", "toolpath.file"),
        ("spiral-bevel-flank-conventional", "toolpath.file=own.cl", "toolpath.file"),
        ("spur-external", "program.file=own.nc", "program.file"),
        ("spur-external", "toolpath.finishing.axial_step_mm=0.25", "toolpath"),
    ],
)
def test_figures_of_a_toolpath_stand_beside_no_other_one(name, override, table, tmp_path):
    tables, (key, file) = scene_table(load_scene(name)[0]), override.split("=")
    if key == "toolpath.file":
        (tmp_path / file).write_text(plan(load_scene(name)[0]).files["toolpath.cl"])
        scene = check_scene(tables | {"toolpath": {"file": file}}, "s")
    else:
        scene, _ = load_scene(name, [override])
    print_of = f"[reference] is left out: it is printed for the toolpath of the built-in scene {name}"
    told = f"{print_of}, and {table} differs here"
    assert printed_elsewhere(scene, tmp_path) == told
    if key == "toolpath.file":
        job = plan(scene, tmp_path)
        assert job.notes[-1] == told
        assert "reference" not in job.scene
        assert all(getattr(i, "published", None) is None for i in job.inspections)


def test_how_finely_a_printed_geometry_is_cut_and_measured_is_free():
    scene, folder = load_scene("spiral-bevel-flank", ["toolpath.points=33", "metrology.rows=5"])
    job = plan(scene, folder)
    assert job.notes == ()
    assert any(getattr(i, "published", None) for i in job.inspections)


def test_a_surface_of_the_user_s_own_under_a_shipped_name_is_another_geometry(tmp_path):
    nurbs, _ = load_scene("gouge-size-vertical-free-form")
    assert printed_elsewhere(nurbs, tmp_path) == ""
    (tmp_path / nurbs.surface.file).write_text("")
    assert printed_elsewhere(nurbs, tmp_path).endswith("surface.file differs here")


def test_a_print_of_the_user_s_own_stays():
    table = scene_table(load_scene("spiral-bevel-flank", ["surface.pressure_angle_deg=20"])[0])
    table["reference"]["source"] = "our own measuring report"
    assert printed_elsewhere(check_scene(table, "s"), None) == ""


def test_worked_examples_of_no_built_in_scene_belong_to_no_surface():
    scene, folder = load_scene("gouge-vertical-cylinder", ['reference.sections=["6.3"]', "reference.names=[]"])
    assert "printed for the geometry of the built-in scene gouge-flat-end-mill" in printed_elsewhere(scene, folder)
    scene, folder = load_scene("gouge-vertical-cylinder", ['reference.sections=["9.1.1"]', "reference.names=[]"])
    assert printed_elsewhere(scene, folder) == "[reference] is left out: no built-in scene has these worked examples"


@pytest.mark.parametrize("name", scene_names())
def test_a_new_scene_speaks_of_no_worked_example(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["new", "mine", "--like", name]) == 0
    table = tomllib.loads((tmp_path / "mine.toml").read_text())
    assert table["scene"] == {"name": "mine", "summary": ""}
    assert ("reference" in table) == (name in OF_NUMBERS)
    old, new = scene_table(load_scene(name)[0]), scene_table(load_scene(tmp_path / "mine.toml")[0])
    for lost in ("scene", *(["reference"] if name not in OF_NUMBERS else [])):
        old.pop(lost, None), new.pop(lost, None)
    assert new == old


def test_the_table_is_cut_out_wherever_it_stands():
    text = "[a]\nx = 1\n\n[reference]\ny = 2\n[reference.deep]\n[[reference.tables]]\nz = 3\n\n[b]\n[[c]]\n"
    assert without_reference(text) == "[a]\nx = 1\n\n[b]\n[[c]]\n"
    assert without_reference("[a]\n\n[reference]\n") == "[a]\n"
