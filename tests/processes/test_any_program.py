"""Programs of the user's own cut into surfaces of any kind: by G-code, by CL data, by several tools."""

from dataclasses import replace

import numpy as np
import pytest

from gearsim.cutters.catalogue import ball
from gearsim.errors import InputError
from gearsim.metrology.grid import DENSE
from gearsim.processes.run import plan, run, run_job
from gearsim.programs.cldata import CLPath, assemble, format_cl, parse_cl
from gearsim.scene import check_scene, load_scene
from gearsim.surfaces.nurbs_file import load_surfaces

SMALL = (
    "metrology.rows=5", "metrology.columns=17", "metrology.convergence=[]", "simulation.dexel_pitch_mm=0.8",
    "program.linear_decimals=6", "program.rotary_decimals=6",
)  # fmt: skip
GRID = {"tolerance_um": 5.0, "rows": 5, "columns": 17}


@pytest.fixture(scope="module")
def flank():
    """The README's scene, small, and its run."""
    scene, folder = load_scene("spiral-bevel-flank", SMALL)
    return scene.model_dump(exclude_none=True), run(scene, folder=folder)


def gcode_scene(tables, file="own.nc", **more):
    """The same gear, cut by its own program for the machine, which lies on its back."""
    return {
        "scene": {"name": "own"}, "surface": tables["surface"], "cutter": tables["cutter"],
        "machine": tables["program"]["machine"], "metrology": GRID, "simulation": tables["simulation"],
        "toolpath": {"file": file, "mounting": {"z_axis": [0.0, 0.0, -1.0]}},
    } | more  # fmt: skip


@pytest.fixture(scope="module")
def by_gcode(flank, tmp_path_factory):
    tables, result = flank
    folder = tmp_path_factory.mktemp("own")
    (folder / "own.nc").write_text(result.job.files["program.nc"])
    return run(check_scene(gcode_scene(tables), "own"), folder=folder), folder


def test_a_bevel_gear_cut_from_gcode_is_that_cut_from_cl_data(flank, by_gcode):
    """To what linear rotary axes and six decimals cost between 65 points: the tip runs straight in both."""
    (_, cl), (nc, _) = flank, by_gcode
    assert (nc.verdict, nc.exit_code) == ("pass", 0)
    for result in (nc, cl):
        assert "1 of 33 spaces is cut and judged: what indexing to the others adds is not in it" in result.headline
    for surface in ("convex", "concave"):
        ours, theirs = (r.measurements[surface, "program", DENSE].deviation.value for r in (nc, cl))
        assert 1e3 * np.nanmax(np.abs(ours - theirs)) < 0.2
    for side in ("convex", "concave"):
        gap = nc.measurements[side, "last operation", DENSE].gap
        assert gap.max_um < 1e-3
        assert gap.valid == 85
    assert nc.measurements["", "program", "tri-dexel"].check_um < 1e-3


def test_stock_in_the_root_is_named_whatever_the_program_is_written_in(flank, by_gcode):
    """The root's surfaces have no limit of what is left: CL data's verdict names it, so must G-code's."""
    (_, cl), (nc, _) = flank, by_gcode
    root = ("concave fillet", "bottom", "convex fillet")
    left = {f.patch: f for f in nc.findings if f.kind == "stock_left"}
    assert set(left) == set(root)
    for name in root:
        most = 1e3 * np.nanmax(nc.measurements[name, "program", DENSE].deviation.value)
        assert left[name].depth_um == pytest.approx(most, abs=1e-9)
        assert not left[name].fails
        assert left[name].told in nc.headline
    (theirs,) = (f for f in cl.findings if f.kind == "root_stock")
    assert max(f.depth_um for f in left.values()) == pytest.approx(theirs.depth_um, rel=0.2)  # other rows of samples


def test_a_program_that_stands_elsewhere_is_unchecked_with_one_reason_a_surface(flank, by_gcode):
    """Mounted half a metre off the gear's program cuts the air."""
    scene = gcode_scene(flank[0], toolpath={"file": "own.nc", "mounting": {"origin_mm": [0.0, 0.0, 500.0]}})
    result = run(check_scene(scene, "own"), folder=by_gcode[1])
    assert (result.verdict, result.exit_code) == ("unchecked", 3)
    for surface in result.job.part.surfaces:
        assert result.status.count(f"no operation touches {surface} under program") == 1
        assert f"cuts no sample of {surface}" not in result.status


def test_a_program_that_cuts_two_slots_of_many_is_judged_by_neither(flank, tmp_path):
    tables, result = flank
    program = parse_cl(result.job.files["toolpath.cl"], "own.cl")
    turn = 2.0 * np.pi / tables["surface"]["teeth"]
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]])
    more = [CLPath(path.name, path.tips @ rotation.T, path.axes @ rotation.T) for path in program.paths]
    (tmp_path / "two.cl").write_text(format_cl(replace(program, paths=(*program.paths, *more)), "two", 100.0, 6))
    table = {"file": "two.cl"}
    found = run(check_scene(tables | {"toolpath": table}, "two"), folder=tmp_path)
    assert (found.verdict, found.exit_code) == ("unchecked", 3)
    assert "nothing cuts 31 of 33 spaces (3, 4, 5, 6 and 27 more), though others are cut" in found.status


def test_surfaces_that_are_not_judged_have_no_tolerance_and_no_say(flank, by_gcode):
    """The root's surfaces keep their stock; only the convex flank decides."""
    scene = gcode_scene(flank[0], metrology=GRID | {"judged": ["convex"]})
    result = run(check_scene(scene, "own"), folder=by_gcode[1])
    assert result.verdict == "pass"
    assert "not judged: concave, concave fillet, bottom, convex fillet;" in result.headline
    assert [n for n, s in result.job.part.surfaces.items() if s.tolerance is not None] == ["convex"]
    assert ("concave", "program", DENSE) in result.measurements


def test_every_cut_knows_its_line(by_gcode):
    result, _ = by_gcode
    (operation,) = result.job.variant("program").operations
    made = result.measurements["convex", "program", DENSE].deviation.segment.ravel()
    lines = operation.text.splitlines()
    assert all(lines[operation.line[k] - 1].strip() for k in made)
    assert not operation.rapid[made].any()


def test_tools_by_number_cut_with_their_own_shape(flank, by_gcode):
    """The same program twice, by tool 1 and by a larger tool 2, which gouges."""
    (tables, _), (_, folder) = flank, by_gcode
    text = (folder / "own.nc").read_text()
    body = text[text.index("T1 M06") :].replace("M30", "").replace("%", "")
    head, tail = text[: text.index("T1 M06")], "M30\n%\n"
    (folder / "two.nc").write_text(
        head + body + body.replace("T1 M06", "T2 M06").replace("G43.4 H1", "G43.4 H2") + tail
    )
    large = tables["cutter"] | {"bottom_radius_mm": tables["cutter"]["bottom_radius_mm"] + 0.1}
    tools = [{"number": 1, "cutter": tables["cutter"]}, {"number": 2, "cutter": large}]
    scene = gcode_scene(tables, "two.nc", tools=tools)
    del scene["cutter"]
    result = run(check_scene(scene, "two"), folder=folder)
    assert [o.name for o in result.job.variant("program").operations] == ["T1", "T2"]
    assert (result.verdict, result.exit_code) == ("fail", 1)
    assert result.measurements["convex", "program", DENSE].deviation.summary_um()["min"] < -50.0
    del scene["tools"][1]
    with pytest.raises(InputError, match=r"two\.nc, line .*tool T2 is not among the tools there are: T1"):
        plan(check_scene(scene, "two"), folder)


def test_a_net_is_cut_from_cl_data(tmp_path):
    net, mill = load_surfaces("khan-9-1-cylinder")[0], ball(20.0, 60.0)
    passes = []
    for k, v in enumerate(np.linspace(*net.domain[1], 41)):
        jet = net.jet(np.array(net.domain[0]), np.full(2, v))
        tips = jet.r + 10.0 * jet.normal - [0.0, 0.0, 10.0]
        passes.append(CLPath(f"line {k}", tips, np.tile([0.0, 0.0, 1.0], (2, 1))))
    (tmp_path / "net.cl").write_text(format_cl(assemble(passes, 80.0, mill), "net", 600.0, 9))
    scene = {
        "scene": {"name": "net"}, "surface": {"kind": "nurbs", "file": "khan-9-1-cylinder"},
        "cutter": {"kind": "ball", "diameter_mm": 20.0, "height_mm": 60.0}, "toolpath": {"file": "net.cl"},
        "metrology": {"tolerance_um": 10.0, "rows": 9, "columns": 9, "margin": 0.05},
    }  # fmt: skip
    result = run_job(plan(check_scene(scene, "net"), tmp_path))
    um = result.measurements[net.name, "program", DENSE].deviation.summary_um()
    assert result.verdict == "pass"
    assert um["min"] > -1e-3
    assert 2.0 < um["max"] < 10.0  # scallops of lines 1.2 mm apart


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"machine": None}, "machine: missing; G-code is run by"),
        ({"cutter": None}, r"give one \[cutter\], which is tool 1, or \[\[tools\]\]"),
        ({"tools": [{"number": 1, "cutter": {"kind": "ball", "diameter_mm": 2.0, "height_mm": 9.0}}]}, "not both"),
        ({"metrology": GRID | {"judged": ["convexe"]}}, "metrology.judged: got 'convexe', .* did you mean 'convex'"),
        ({"toolpath": {"file": "own.nc", "mounting": {"x_axis": [0.0, 0.0, 1.0]}}}, "must be at right angles"),
        ({"toolpath": {"file": "gone.nc"}}, r"cannot read program .*gone\.nc"),
        ({"toolpath": {"file": "own.nc", "points": 3}}, "toolpath.points: unknown key"),
    ],
)
def test_what_does_not_fit_is_refused_by_its_key(flank, by_gcode, change, message):
    scene = {k: v for k, v in (gcode_scene(flank[0]) | change).items() if v is not None}
    with pytest.raises(InputError, match=message):
        plan(check_scene(scene, "own"), by_gcode[1])


def test_scenes_of_old_keep_their_own_kind():
    for name, kind in (("spiral-bevel-flank", "FlankMillingScene"), ("spur-external", "CylindricalGearScene")):
        assert type(load_scene(name)[0]).__name__ == kind
