import copy
import re
import tomllib

import pytest

from gearsim.errors import InputError
from gearsim.scene import check_scene, load_scene, scene_names, scene_text


@pytest.fixture
def tables():
    return tomllib.loads(scene_text("spiral-bevel-flank")[0])


@pytest.mark.parametrize("name", scene_names())
def test_built_in_scenes_load_and_comment_every_value(name):
    scene, _ = load_scene(name)
    assert scene.name == name
    section = ""
    for line in scene_text(name)[0].splitlines():
        section = line if line.startswith("[") else section
        value = re.match(r"\w+ = ", line) and section != "[scene]"
        if value and not section.lstrip("[").startswith("reference"):
            assert re.search(r" # \S", line), line


def test_the_published_scene_differs_only_in_the_cutter(tables):
    published = tomllib.loads(scene_text("spiral-bevel-flank-zhou")[0])
    for key in set(tables) - {"scene", "cutter"}:
        assert tables[key] == published[key]
    assert published["cutter"]["bottom_radius_mm"] == 1.0
    assert published["cutter"]["fillet_radius_mm"] == 1.5


def test_four_mistakes_are_told_at_once(tables):
    tables["surface"]["teeth"] = -3
    tables["surface"]["presure_angle_deg"] = 22.0
    tables["cutter"]["height_mm"] = "tall"
    del tables["metrology"]["tolerance_um"]
    with pytest.raises(InputError) as error:
        check_scene(tables, "my.toml")
    text = str(error.value)
    assert text.startswith("scene my.toml: 4 mistakes:")
    assert "surface.teeth: got -3" in text
    assert "surface.presure_angle_deg: unknown key; did you mean 'pressure_angle_deg'?" in text
    assert "cutter.height_mm: got 'tall'" in text
    assert "metrology.tolerance_um: missing" in text


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("surface.pressure_angle_deg", 0.384, "0.384 rad would be 22"),
        ("surface.face_angle_deg", 1.33, "are they in degrees"),
        ("surface.module_mm", float("nan"), "surface.module_mm: got nan"),
        ("surface.module_mm", 4833800.0, "um would be 4833.8"),
        ("cutter.kind", "conicle", "cutter.kind: got conicle; expected 'apt'"),
        ("cutter.taper_deg", 200.0, "cutter.taper_deg: got 200.0"),
        ("toolpath.points", 1, "toolpath.points: got 1"),
        ("toolpath.file", "a.cl", "'file' replaces our planner; remove decimals"),
        ("surface.fillet_radius_mm", 30.0, "working flank would be empty"),
        ("cutter.fillet_radius_mm", 60.0, "impossible conical cutter: height h = 25 mm must exceed"),
        ("surface.face_width_mm", 90.0, "face width 90 mm"),
    ],
)
def test_one_mistake_is_one_clear_line(tables, path, value, message):
    table, key = path.split(".")
    tables[table][key] = value
    with pytest.raises(InputError, match=message.replace("(", r"\(")) as error:
        check_scene(tables, "x")
    assert "1 mistake:" in str(error.value)


def test_impossible_geometry_is_told_for_tooth_and_cutter_together(tables):
    tables["surface"]["fillet_radius_mm"] = 30.0
    tables["cutter"]["fillet_radius_mm"] = 60.0
    with pytest.raises(InputError, match="2 mistakes"):
        check_scene(tables, "x")


def test_mistakes_in_tables_within_a_table_are_placed():
    mistakes = ["surface.head.radius_m=63.5", "surface.generator.ratio_of_rol=1.0", "surface.hand=left"]
    with pytest.raises(InputError) as error:
        load_scene("spiral-bevel-flank-conventional", mistakes)
    assert "3 mistakes" in str(error.value)
    assert "surface.head.radius_m: unknown key; did you mean 'radius_mm'?" in str(error.value)
    assert "surface.generator.ratio_of_rol: unknown key; did you mean 'ratio_of_roll'?" in str(error.value)
    tables = tomllib.loads(scene_text("spiral-bevel-flank-conventional")[0])
    tables["surface"]["head"] = tables["cutter"]
    with pytest.raises(InputError, match="no face-mill head"):
        check_scene(tables, "x")


def test_overrides_are_read_as_toml():
    scene, _ = load_scene(
        "spiral-bevel-flank", ["metrology.rows=9", "surface.hand=right", "metrology.convergence=[9, 17]"]
    )
    assert (scene.metrology.rows, scene.surface.hand, scene.metrology.convergence) == (9, "right", (9, 17))


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("rows=9", "expected table.key=value"),
        ("metrology.rows", "expected table.key=value"),
        ("metrology.rowz=9", "did you mean 'rows'"),
        ("scene.name.x=9", "'name' is a value, not a table"),
    ],
)
def test_bad_overrides_say_so(override, message):
    with pytest.raises(InputError, match=message):
        load_scene("spiral-bevel-flank", [override])


def test_unknown_scenes_and_broken_files(tmp_path):
    with pytest.raises(InputError, match="did you mean 'spiral-bevel-flank'"):
        load_scene("spiral-bevel-flnk")
    with pytest.raises(InputError, match="Built-in scenes: apt-envelope"):
        load_scene("nosuch")
    with pytest.raises(InputError, match="cannot read scene"):
        load_scene(tmp_path / "missing.toml")
    broken = tmp_path / "broken.toml"
    broken.write_text("[scene\nname=")
    with pytest.raises(InputError, match="not valid TOML"):
        load_scene(broken)


def test_apt_cutters_and_defaults(tables):
    tables = copy.deepcopy(tables)
    sizes = {"d_mm": 6.0, "r_mm": 1.0, "e_mm": 2.0, "f_mm": 1.0, "alpha_deg": 0.0, "beta_deg": 0.0, "h_mm": 20.0}
    tables["cutter"] = {"kind": "apt", **sizes}
    del tables["toolpath"], tables["simulation"], tables["reference"]
    scene = check_scene(tables, "x")
    assert scene.tool().height == 20.0
    assert scene.toolpath.points == 65
    tables["cutter"]["q_mm"] = 1.0
    with pytest.raises(InputError, match="unknown key"):
        check_scene(tables, "x")
