"""Files of runs without flanks: a surface cut by one tool and by two, and numbers for which nothing is cut."""

from dataclasses import replace

import numpy as np
import pytest

from gearsim.output.columns import Column
from gearsim.output.drawer import patch_meshes
from gearsim.output.exr import header, write_exr
from gearsim.output.gouging.charts import rows_of
from gearsim.output.gouging.curvature import CurvaturePlot, Piece, draw_curvatures, ranges
from gearsim.output.meshes import values_of
from gearsim.output.presenters import arrays, promised
from gearsim.output.saving import Save
from gearsim.output.write import REPORTS, write_result
from gearsim.processes.run import run
from gearsim.scene import check_scene
from gearsim.surfaces.nurbs_file import load_surfaces, write_surfaces
from tests.output.pages import overlaps

ROWS, COLUMNS = 9, 5
NOTHING = np.empty((0, 2))
BALL = {"kind": "ball", "diameter_mm": 20.0, "height_mm": 60.0}


def cut(folder, name="khan-9-1-free-form", **more):
    """The free-form of Khan 9.1 under another name, cut by few passes and measured on few points."""
    surface = replace(load_surfaces("khan-9-1-free-form")[0], name=name)
    write_surfaces([surface], folder / "surface.json")
    tables = {
        "scene": {"name": "few passes"},
        "surface": {"kind": "nurbs", "file": "surface.json"},
        "cutter": BALL,
        "toolpath": {"along": "v", "stepover_mm": 30.0, "points": 5},
        "metrology": {"rows": ROWS, "columns": COLUMNS},
        **more,
    }
    return run(check_scene(tables, "few passes"), folder=folder)


@pytest.mark.parametrize("name", ["khan-9-1-free-form", "patch", "a: b"])
def test_one_tool_is_drawn_on_one_surface_whatever_its_name(tmp_path, name):
    import pyvista as pv

    result = cut(tmp_path, name)
    assert write_result(result, tmp_path) == []
    assert (tmp_path / "surface.png").stat().st_size > 10_000
    left = {f.name for f in tmp_path.iterdir()} - {"surface.json"}
    assert left <= {*REPORTS, *promised(result.job)}
    assert pv.read(tmp_path / "tooth.vtp").n_points == ROWS * COLUMNS


def test_every_tool_has_its_surface_once_the_main_one_first(tmp_path):
    result = cut(tmp_path, larger={**BALL, "diameter_mm": 30.0})
    shown = [values_of(mesh, "deviation_um") for mesh in patch_meshes(arrays(result)).values()]
    tools = [m for key, m in result.measurements.items() if key[2] == "gouging"]
    assert [m.variant for m in tools] == ["chosen tool", "larger tool"]
    for um, m in zip(shown, tools, strict=True):
        np.testing.assert_array_equal(np.sort(um), np.sort(1e3 * m.cut.deviation.value, axis=None))
    assert len({um.tobytes() for um in shown}) == 2


def test_a_report_claims_two_roads_only_where_two_were_taken(tmp_path):
    write_result(cut(tmp_path), tmp_path)
    text = (tmp_path / "report.md").read_text()
    assert "two roads" not in text
    assert "By the kernel alone: khan-9-1-free-form." in text
    assert "Does the overcut appear where it is predicted?" in text


def test_a_report_of_numbers_alone_speaks_of_no_deviation(tmp_path):
    result = run("gouge-verification")
    write_result(result, tmp_path)
    text = (tmp_path / "report.md").read_text()
    assert "**PASS**: nothing is cut" in text
    for word in ("deviation", "within tolerance", "## Findings"):
        assert word not in text


def test_parts_of_different_sizes_share_one_exr(tmp_path):
    import OpenEXR

    parts = {"small": {"a": Column(np.ones((2, 3)), "one")}, "tall": {"a": Column(np.full((7, 2), 2.0), "two")}}
    write_exr(parts, header("faces", "part"), tmp_path / "a.exr")
    with OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True) as file:
        assert {p.name(): p.channels["a"].pixels.shape for p in file.parts[1:]} == {"small": (2, 3), "tall": (7, 2)}
        assert file.parts[0].channels["R"].pixels.shape == (2 + 1 + 7, 3)


def test_a_surface_may_bear_the_name_of_the_preview(tmp_path):
    import OpenEXR

    values = np.ma.masked_less([[-1, 0, 5]], 0)
    write_exr({"preview": {"shank.mm": Column(values, "radius")}}, header("faces", "part"), tmp_path / "a.exr")
    with OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True) as file:
        assert [p.name() for p in file.parts] == ["preview_", "preview"]
        np.testing.assert_array_equal(file.parts[1].channels["shank.mm"].pixels, [[np.nan, 0.0, 5.0]])
        red, green, blue = (file.parts[0].channels[c].pixels[0] for c in "RGB")
    assert red[0] == green[0] == blue[0]
    assert abs(red[1] - blue[1]) < 1e-3
    assert red[2] > 2 * blue[2]


def test_a_map_has_its_causes_beside_it_only_where_there_are_several():
    assert rows_of({}) == []
    assert rows_of({"a": False}) == [[("a", False)]]
    assert rows_of({"a": False, "b": False, "c": False}) == [[("a", False), ("b", False)], [("c", False)]]
    assert rows_of({"a": False, "b": True, "c": False}) == [
        [("a", False), ("c", False)], [("b", False), ("b", True)]
    ]  # fmt: skip


def contact(high, part=0.05):
    return CurvaturePlot("", lambda a: high + 0.0 * a, (Piece("part", lambda a: part * np.cos(a) ** 2),), NOTHING, "")


def test_contacts_of_one_part_are_drawn_to_one_scale():
    assert ranges([contact(0.1), contact(0.2)]) == [pytest.approx((0.0, 0.224))] * 2
    assert ranges([contact(0.1), contact(0.2, -0.1)]) == [
        pytest.approx((0.0, 0.112)), pytest.approx((-0.136, 0.236))
    ]  # fmt: skip
    assert ranges([contact(0.1)]) == [pytest.approx((0.0, 0.112))]


def test_no_text_of_curvatures_lies_over_another(texts, tmp_path):
    tilted = CurvaturePlot("edge", lambda a: 0.1 + 0.0 * a, (Piece("part", lambda a: -0.2 + 0.0 * a),),
                           np.array([[350.0, 370.0]]), "gouges", rim=0.1, borders=(0.2, 0.2 + np.pi))  # fmt: skip
    draw_curvatures([contact(0.1), contact(0.3), tilted], "heading", "zero", "curvature.png", Save(tmp_path))
    assert [pair for page in texts for pair in overlaps(page)] == []
