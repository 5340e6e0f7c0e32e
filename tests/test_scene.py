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


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ('metrology.rows="9"', "metrology.rows: got '9'; expected a whole number"),
        ("metrology.rows=9.0", "metrology.rows: got 9.0; expected a whole number"),
        ("metrology.rows=true", "metrology.rows: got True; expected a whole number"),
        ("surface.module_mm=true", "surface.module_mm: got True; expected a number"),
        ('surface.module_mm="4.8"', "surface.module_mm: got '4.8'; expected a number"),
        ("surface.tapered=1", "surface.tapered: got 1; expected true or false"),
        ("surface.hand=7", "surface.hand: got 7; "),
        (
            "metrology.profile_offsets_mm=[0.0, nan]",
            "metrology.profile_offsets_mm.1: got nan; input should be a finite",
        ),
        ('metrology.profile_offsets_mm=[0.0, "1"]', "metrology.profile_offsets_mm.1: got '1'; expected a number"),
        ("metrology.profile_offsets_mm=1.0", "metrology.profile_offsets_mm: got 1.0; expected a list"),
        ("metrology.convergence=[9, true]", "metrology.convergence.1: got True; expected a whole number"),
        ("program.machine.pivot_mm=[0.0, 0.0]", "program.machine.pivot_mm: got [0.0, 0.0]; expected 3 or more entries"),
        ("program.machine.pivot_mm=[0.0, 0.0, 0.0, 0.0]", "expected no more than 3 entries"),
        ("program.machine=7", "program.machine: got 7; expected a table"),
        ("reference.convex_um=[1.0]", "reference.convex_um has 1 entries, metrology.profile_offsets_mm 7"),
        ("reference.concave_um=[1, 2, 3, 4, 5, 6, inf]", "reference.concave_um.6: got inf"),
    ],
)
def test_values_have_the_type_of_their_key(override, message):
    with pytest.raises(InputError, match=re.escape(message)) as error:
        load_scene("spiral-bevel-flank-zhou", [override])
    assert "1 mistake:" in str(error.value)


def test_whole_numbers_are_numbers_and_long_values_are_cut_short():
    scene, _ = load_scene("spiral-bevel-flank", ["surface.module_mm=5", "program.machine.pivot_mm=[0, 0, -120]"])
    assert (scene.surface.module_mm, scene.program.machine.pivot_mm) == (5.0, (0.0, 0.0, -120.0))
    with pytest.raises(InputError) as error:
        load_scene("spiral-bevel-flank", [f"metrology.rows={list(range(5000))}"])
    assert len(str(error.value)) < 250


def test_names_in_lists_are_checked_before_anything_is_planned():
    with pytest.raises(InputError, match="names: no worked example of these sections begins with 'nosuch'; there are"):
        load_scene("gouge-vertical-cylinder", ['reference.names=["nosuch"]'])
    with pytest.raises(InputError, match=r"reference.sections: got \[\]; expected 1 or more entries"):
        load_scene("gouge-sizes", ["reference.sections=[]"])


@pytest.mark.parametrize(
    "name", ["..", "../x", "a/b", "/etc/x", "a\\b", "a\0b", "a\nb", "", ".", " a", "-a", "~", "a" * 201]
)
def test_a_name_that_could_leave_the_output_folder_is_refused(tables, name):
    tables["scene"]["name"] = name
    with pytest.raises(InputError, match=r"scene.name: got .* files are called so"):
        check_scene(tables, "x")


def test_machines_that_files_are_called_after_stay_in_the_folder():
    tables = tomllib.loads(scene_text("hypoid-pinion-phoenix")[0])
    tables["machine"]["../star"] = tables["machine"].pop("star")
    with pytest.raises(InputError, match=r"got '\.\./star'; files are called so, and '/' stands in no file's name"):
        check_scene(tables, "x")


def test_a_gear_s_pressure_angle_is_one_that_gears_have():
    for angle in ("2e-8", "0.35", "60.0", "-20.0"):
        with pytest.raises(InputError, match=r"transverse_pressure_angle_deg: got .* input should be .* than or equal"):
            load_scene("spur-external", [f"surface.transverse_pressure_angle_deg={angle}"])


def test_two_flanks_of_one_name_are_refused():
    tables = tomllib.loads(scene_text("apt-envelope")[0])
    tables["surface"]["flanks"].append(tables["surface"]["flanks"][0])
    with pytest.raises(InputError, match=r"surface: flanks: names .* must differ"):
        check_scene(tables, "x")


def test_more_samples_than_a_grid_can_have_are_refused_with_their_number():
    with pytest.raises(InputError, match=r"make 16,785,409 samples; expected no more than 1,000,000"):
        load_scene("spiral-bevel-flank", ["metrology.rows=4097", "metrology.columns=4097"])
    with pytest.raises(InputError, match=r"make 9,000,000 samples"):
        load_scene("gouge-vertical-cylinder", ["metrology.rows=3000", "metrology.columns=5"])


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
        ("metrology.rows=9\ncolumns=9", "expected one value"),
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
    with pytest.raises(InputError, match=r"cannot read scene .*missing.toml': there is no such file"):
        load_scene(tmp_path / "missing.toml")
    for odd in ("", "a\0b", "a" * 5000):
        with pytest.raises(InputError, match="no scene named"):
            load_scene(odd)
    broken = tmp_path / "broken.toml"
    broken.write_text("[scene\nname=")
    with pytest.raises(InputError, match="not valid TOML"):
        load_scene(broken)


def test_files_nearby_are_offered(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.toml").write_text(scene_text("gouge-sizes")[0])
    for near in ("mine", "mine.toml.toml", "mne.toml"):
        with pytest.raises(InputError, match=r"did you mean 'mine\.toml'"):
            load_scene(near)
    (tmp_path / "mine.toml").rename(tmp_path / "mine.toml.toml")
    with pytest.raises(InputError, match=r"did you mean 'mine\.toml\.toml'"):
        load_scene("mine.toml")


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


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("teth", "surface.teth: unknown key; did you mean 'teeth'?"),
        ("module", "surface.module: unknown key; did you mean 'module_mm'?"),
        ("density", "surface.density: unknown key; known: teeth, face_width_mm, "),
    ],
)
def test_keys_that_resemble_none_are_answered_by_those_there_are(tables, key, said):
    tables["surface"][key] = 1
    with pytest.raises(InputError) as error:
        check_scene(tables, "s")
    assert said in str(error.value)


@pytest.mark.parametrize(
    ("tables_of_it", "told"),
    [
        ({"toolpath": {"file": "own.txt"}, "machine": {"kind": "phoenix"}}, True),
        ({"toolpath": {"file": "own.txt", "mounting": {"z_axis": [0.0, 0.0, -1.0]}}}, True),
        ({"toolpath": {"file": "own.cl"}, "nothing": 1}, False),
    ],
)
def test_a_file_read_as_cl_data_beside_tables_for_g_code_is_told(tables, tables_of_it, told):
    with pytest.raises(InputError) as error:
        check_scene(tables | tables_of_it, "s")
    said = "toolpath.file: 'own.txt' is read as CL data by its ending; G-code ends in .cnc, "
    assert (said in str(error.value)) == told


def test_a_mistake_of_the_whole_scene_begins_with_its_key(tables):
    tables |= {"toolpath": {"file": "own.nc"}, "metrology": {"tolerance_um": 5.0, "rows": 5, "columns": 9}}
    del tables["program"], tables["reference"]
    with pytest.raises(InputError) as error:
        check_scene(tables, "s")
    assert "\n  - machine: missing" in str(error.value)


@pytest.mark.parametrize(
    ("override", "said"),
    [
        ("machine.pivot_mm=[0.0, -90.0]", "machine.pivot_mm: got [0.0, -90.0]; expected 3 or more entries"),
        ("metrology.spaces=16", "metrology.spaces: got 16; the gear has 15 (0 probes them all)"),
        ('program.file=""', "program.file: got ''; string should have at least 1 character"),
        ("toolpath.slots.tool=3", "toolpath.slots.tool: no tool 3 (1 where none is named); tools has 1"),
        ("toolpath.finishing.tool=2", "toolpath.finishing.tool: no tool 2 (1 where none is named); tools has 1"),
    ],
)
def test_mistakes_of_a_gear_name_their_key_once(override, said):
    with pytest.raises(InputError) as error:
        load_scene("spur-external", [override])
    assert str(error.value).count("\n  - ") == 1
    assert said in str(error.value)
    load_scene("spur-external", ["metrology.spaces=15"])


@pytest.mark.parametrize(
    ("tools", "said"),
    [
        ([], "tools: got []; expected 1 or more entries"),
        ([{"flutes": 2, "flute_length_mm": 9.0}], "diameter_mm: missing"),
    ],
)
def test_a_list_is_too_short_only_where_no_entry_of_it_is_wrong(tools, said):
    with pytest.raises(InputError) as error:
        check_scene(tomllib.loads(scene_text("spur-external")[0]) | {"tools": tools}, "s")
    assert str(error.value).startswith("scene s: 1 mistake:\n  - tools")
    assert said in str(error.value)


def test_a_gear_s_rays_have_room_for_a_cut_in_each_space():
    tables = tomllib.loads(scene_text("spur-internal")[0])
    del tables["simulation"]["interval_slots"]
    assert check_scene(tables, "s").simulation.interval_slots == 64
    del tables["simulation"]
    assert check_scene(tables, "s").simulation.interval_slots == 64


def test_a_scene_with_a_byte_order_mark_is_read(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text("\ufeff" + scene_text("spiral-bevel-flank")[0], encoding="utf-8")
    assert load_scene(file)[0] == load_scene("spiral-bevel-flank")[0]


def test_a_folder_and_a_line_that_is_no_toml_are_named(tmp_path):
    for folder in (".", str(tmp_path)):
        with pytest.raises(InputError, match=rf"cannot read scene {re.escape(folder)}: Is a directory"):
            load_scene(folder)
    file = tmp_path / "mine.toml"
    file.write_text("[surface]\n  module_mm = 4,2  # outer\n")
    with pytest.raises(InputError, match=r"\(at line 2, column 16\): 'module_mm = 4,2  # outer'$"):
        load_scene(file)
    file.write_text("[surface")
    with pytest.raises(InputError, match="not valid TOML"):
        load_scene(file)


def test_numbers_that_are_none_get_no_remark_on_their_unit():
    with pytest.raises(InputError, match=r"surface\.module_mm: got inf; input should be a finite number$"):
        load_scene("spiral-bevel-flank", ["surface.module_mm=inf"])


def test_a_misspelled_key_of_a_machine_that_the_scene_names_is_told():
    with pytest.raises(InputError, match=r"machine\.phoenix.mounting_mmx: unknown key; did you mean 'mounting_mm'"):
        load_scene("hypoid-pinion-phoenix", ["machine.phoenix.mounting_mmx=120.0"])


def test_no_tool_is_ten_metres_long():
    with pytest.raises(InputError, match=r"cutter\.height_mm: got 25000"):
        load_scene("spiral-bevel-flank", ["cutter.height_mm=25000.0"])
