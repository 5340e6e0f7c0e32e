"""What a run of a cylindrical gear writes: files, keys, texts; also where much of it is missing."""

import json
import re
from dataclasses import replace

import numpy as np
import pyarrow.parquet as pq
import pytest

from gearsim.metrology.gear_budget import BudgetLine, BudgetMeasurement
from gearsim.metrology.grid import DENSE
from gearsim.output.files import staged
from gearsim.output.gear import budget, inspection
from gearsim.output.gear.budget import error_budget
from gearsim.output.gear.draw import _at
from gearsim.output.gear.strips import strips
from gearsim.output.gear.whole import layers
from gearsim.output.gear.words import exactly, order, size
from gearsim.output.programs import duration
from gearsim.output.report import report_text
from gearsim.output.screen import print_result
from gearsim.output.summary import summary, write_json
from gearsim.output.write import write_result
from gearsim.processes.run import run
from gearsim.scene import load_scene, scene_table
from gearsim.scene.cylindrical_paths import GearPathTable

PICTURES = {
    "inspection.png", "gear.png", "section.png", "deviation.png", "topography.png", "profile.png", "helix.png",
    "pitch.png", "roughness.png",
}  # fmt: skip
FILES = {
    "report.json", "report.md", "report.html", "deviation.exr", "tooth.vtp", "samples.parquet", "program.nc", *PICTURES,
}  # fmt: skip
SMALL = (
    "metrology.spaces=1", "metrology.points=25", "metrology.rows=5", "metrology.columns=9",
    "metrology.section_pitch_mm=0.4", "simulation.dexel_pitch_mm=0.8",
)  # fmt: skip


@pytest.fixture(scope="module")
def result():
    scene, _ = load_scene("spur-external", SMALL)
    return run(scene.model_copy(update={"budget": None, "toolpath": GearPathTable()}))


@pytest.fixture(scope="module")
def folder(result, tmp_path_factory):
    out = tmp_path_factory.mktemp("gear")
    with staged(out) as stage:
        assert write_result(result, stage) == []
    return out


def test_every_sample_knows_its_heading_and_block(folder):
    table, text = pq.read_table(folder / "samples.parquet"), (folder / "program.nc").read_text().splitlines()
    assert table["program_operation"].unique().to_pylist() == ["T1, TOOTH FINISHING"]
    blocks = [text[line - 1] for line in table["program_line"].to_pylist()]
    assert all(re.match(r"(G01 )?[XY]-?[\d.]+ .*F[\d.]+$", block) for block in blocks), blocks[:5]


@pytest.fixture(scope="module")
def report(folder):
    return json.loads((folder / "report.json").read_text())


def iso(result):
    return result.measurements["", "program", "ISO 1328-1"]


def line(cause, text, um, **parameters):
    return BudgetLine(cause, text, parameters, um, -0.5 * um, None)


def test_a_run_leaves_exactly_these_files(folder):
    assert {f.name for f in folder.iterdir()} == FILES


def test_pictures_are_not_blank(folder):
    from matplotlib.pyplot import imread

    for name in PICTURES:
        picture = imread(folder / name)[..., :3]
        assert picture.shape[1] > 1000
        assert len(np.unique((255 * picture).round().reshape(-1, 3).astype(int) @ [65536, 256, 1])) > 20


def test_report_json_gives_every_size_its_unit(report, result):
    assert report["schema_version"] == 2
    assert report["verdict"] in ("pass", "fail")
    whole = report["measurements"]["part"]["program"]
    found = whole["ISO_1328-1"]
    assert found["spaces"] == [1]
    parameters = {row["parameter"]: row for row in found["parameters"]}
    assert parameters["F_alpha"]["class_achieved"] == 1
    assert parameters["F_p"]["left_um"] is None
    for side in ("left", "right"):
        assert np.shape(found["profile"][side]["total_um"]) == (1, 3)
        assert found["profile"][side]["total_um"][0][1] > 0.0
        motion = report["measurements"][side]["last_operation"]["dense_grid"]
        assert motion["envelope_gap_um"]["max"] <= 0.001
        assert motion["deviation_um"]["samples"] == 45
    assert found["gear"]["tip_radius_mm"] == pytest.approx(42.5)
    assert whole["program"]["lines"] == len(result.job.files["program.nc"].splitlines())
    assert whole["program"]["cutting_s"] == pytest.approx(sum(o["cutting_s"] for o in whole["program"]["operations"]))
    assert "error_budget" not in whole


def test_printed_figures_stand_beside_ours_of_the_same_station(result):
    assert "reference" not in result.scene  # it is cut by finishing alone, which is not the thesis's program
    printed = scene_table(load_scene("spur-external")[0])["reference"]
    table = printed["tables"][0]
    assert (table["kind"], table["side"]) == ("profile", "left")
    told = replace(result, job=replace(result.job, scene=result.scene | {"reference": printed}))
    (text,) = [s["beside"] for s in [inspection.sections(told, [iso(told)])]]
    whole = report_text(told, summary(told) | {"not_drawn": []}, {}, [])
    for words in (
        "## Beside measured gears",
        "table 5.11",
        "flutes are not modelled",
        "1 to 3 h printed",
        "(measured)",
    ):
        assert words in whole
    ours = iso(result).found.profile["left"].evaluated().total_um
    for k, station in enumerate(("top", "middle", "bottom")):
        assert table["stations"][k] == station
        start = f"| {table['name']} | profile, left | {station}"
        row = next(line for line in text.splitlines() if line.startswith(start))
        assert row.endswith(f"| {size(table['total_um'][k])} | {size(ours[0, k])} |")


def test_exr_and_parquet_say_units_and_sign(folder, result):
    import OpenEXR
    import pyarrow.parquet as pq

    with OpenEXR.File(str(folder / "deviation.exr"), separate_channels=True) as file:
        assert [p.name() for p in file.parts] == ["preview", "left", "right"]
        for part in file.parts[1:]:
            expected = 1e3 * result.measurements[part.name(), "program", DENSE].deviation.value
            assert np.allclose(part.channels["deviation.um"].pixels, expected, atol=1e-6)
            assert {"P.X", "N.Z", "valid", "segment.id", "last_operation.gap.um"} <= set(part.channels)
            assert "positive = material left" in part.header["gearsim.sign"]
            assert "mm" in part.header["gearsim.units"]
    samples = pq.read_table(folder / "samples.parquet")
    assert samples.num_rows == 90
    assert {"surface", "u", "x_mm", "nx", "program_um", "last_operation_um"} <= set(samples.column_names)
    notes = samples.schema.metadata
    assert b"gear axis" in notes[b"gearsim.frame"]
    assert b"material left" in notes[b"gearsim.sign"]


def test_tooth_vtp_holds_both_flanks(folder):
    import pyvista as pv

    tooth = pv.read(folder / "tooth.vtp")
    assert set(np.unique(tooth["patch"])) == {0, 1}
    assert tooth.n_points == 90


def test_report_tells_what_was_asked_and_achieved(folder):
    text = (folder / "report.md").read_text()
    for words in (
        "Class 1 of ISO 1328-1:2013, transverse", "| F_alpha |", "## Can the number be trusted?", "1 of 15 spaces",
        "tooth finishing", "±0.5 µm", "[reference] is left out",
    ):  # fmt: skip
        assert words in text
    assert "printed; ours" not in text
    assert "## Error budget" not in text
    assert not re.search(r"\bnan\b", text, re.IGNORECASE)
    assert (folder / "report.html").read_text().count('<p><img src="data:image/png') == len(PICTURES)


def test_everything_is_told_without_reference_roads_and_roughness_numbers(result, tmp_path):
    def bare(m):
        if m.inspection == "roughness":
            nothing = {"ra_um": np.nan, "rq_um": np.nan, "rz_um": np.nan}
            return replace(m, traces={n: replace(r, **nothing) for n, r in m.traces.items()})
        return m

    readings = tuple(
        replace(r, measurements=tuple(bare(m) for m in r.measurements if m.variant != "last operation"))
        for r in result.readings
    )
    scene = {k: v for k, v in result.scene.items() if k != "reference"}
    told = replace(result, job=replace(result.job, scene=scene), readings=readings)
    figures = summary(told)
    figures["not_drawn"] = ["gear.png: no screen"]
    write_json(figures, tmp_path / "report.json")
    text = report_text(told, figures, {}, ["report.json"])
    assert "Not drawn: gear.png" in text
    assert "measured gears" not in text
    assert "| left: program |" in text
    assert "| left: last operation |" not in text


def test_screen_shows_parameters_beside_their_tolerances(result, folder, capsys):
    print_result(result, folder, [])
    out = capsys.readouterr().out
    assert "f_Halpha" in out
    assert "2.5 µm" in out
    assert "verdict" in out


def test_budget_reads_its_own_lines():
    lines = (
        line("none", "exact numbers, all axes linear", 2e-8, F_alpha=1e-8),
        *(line("involute step", f"{h:g} mm, all axes linear", 1e-7 * h, F_alpha=1e-7) for h in (1.0, 0.5)),
        *(
            line("involute step", f"{h:g} mm, tool-centre-point control", 8 * h**2, F_alpha=8 * h**2)
            for h in (1.0, 0.5)
        ),
        *(line("axial step", f"{h:g} mm, tool-centre-point control", 8.0, F_beta=3.0) for h in (1.0, 0.5)),
        *(line("decimals", f"{n} (mm and deg)", 0.7 * 10.0 ** (3 - n), F_alpha=None) for n in (3, 4)),
        line("tool radius", "+1 um", 1.0, F_alpha=0.0, F_beta=0.0),
        replace(line("mounting eccentricity", "10 um", 10.0, F_p=21.0), runout_um=20.0),
    )
    text = error_budget(budget.figures(BudgetMeasurement("program", lines))["lines"])
    for words in (
        "**2.0e−05 nm** of the design", "up to 1 mm costs 1.0e−04 nm", "8.00 µm at 1 mm, 2.00 µm at 0.5 mm",
        "to the power 2.00", "F_beta hardly depends on the axial step", "3 decimals 700 nm, 4 decimals 70.0 nm",
        "divides it by 10.0", "tool radius of +1 µm moves the flanks by up to 1.00 µm, −500 nm on average",
        "makes F_p 21.0 µm and a runout F_r of 20.0 µm",
    ):  # fmt: skip
        assert words in text
    assert text.count("\n|") == 2 + len(lines)
    assert error_budget([]) == ""


def test_unknown_stations_and_no_hours_are_told_as_gaps(result):
    printed = {
        "source": "x", "note": "", "hours": None, "roughness_um": {},
        "tables": [{"name": "t", "kind": "helix", "side": "right", "stations": ["edge"], "slope_um": [1.0],
                    "form_um": [2.0], "total_um": [3.0]}],
    }  # fmt: skip
    told = replace(result, job=replace(result.job, scene=result.scene | {"reference": printed}))
    text = inspection.sections(told, [iso(told)])["beside"]
    assert "| t | helix, right | edge | 1.00 µm | – | 2.00 µm | – | 3.00 µm | – |" in text
    assert "Cutting time" not in text


def test_words():
    assert [size(v) for v in (None, np.nan, 1e-6, -0.0268, 1.5, 349.0)] == [
        "–",
        "–",
        "0",
        "−26.8 nm",
        "1.50 µm",
        "349 µm",
    ]
    assert [duration(v) for v in (None, 59.6, 3661.0)] == ["–", "0:01:00", "1:01:01"]
    assert exactly(2.3e-8) == "2.3e−05 nm"
    assert order([1.0, 0.5, 0.25], [4.0, 1.0, 0.25]) == pytest.approx(2.0)
    assert order([1.0, 0.5], [4.0, 0.0]) is None


def test_the_pictures_section_is_as_large_as_what_is_left(result):
    found = result.measurements["", "program", "transverse section"]
    data, section = layers(result, [found]), found.section
    apart = float(np.diff(section.y).mean())
    left = apart * float((section.left.hi - section.left.lo).sum())
    assert area(data["section:quads"]) == pytest.approx(left, rel=0.01)
    gear = result.job.part.patch("left").gear
    assert 0.02 * left < area(data["space:quads"]) < 3.0 * left / gear.count
    assert data["space:quads"][..., 0].min() > 0.0
    assert np.allclose(_at(np.array([[1.0, 0.0, 0.0]]), -3.0, data | {"gear:twist": 0.1, "section:z": -5.0})[0, :2],
                       [np.cos(0.2), np.sin(0.2)])  # fmt: skip


def area(quads):
    x, y = np.moveaxis(quads, -1, 0)
    return 0.5 * float(np.abs((x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)).sum())


def test_strips_join_the_ends_of_neighbouring_rays():
    """A trapezoid whose sides are almost parallel to the rays, cut at rays a tenth apart: no steps, the right area."""
    y = np.arange(0.05, 1.0, 0.1)
    found = strips(y, np.arange(10), 0.0 * y, 1.0 + 20.0 * y, 1e-6)
    assert len(found.quads) == 2 + 2  # from ray 0 to 8 and to 9, and half a strip at either end
    assert area(found.quads) == pytest.approx(11.0, abs=1e-9)
    (right,) = np.nonzero(np.abs(np.diff(found.edges[..., 0], axis=1)[:, 0]) > 1e-9)
    slopes = np.diff(found.edges[right], axis=1)[:, 0]
    assert np.allclose(slopes[:2, 0] / slopes[:2, 1], 20.0)
    assert np.isclose(np.ptp(found.edges[..., 1]), 1.0)


def test_strips_pass_over_what_is_straight_and_keep_corners():
    """A square that stands on its corner: few strips, and they are off by less than a part of the rays' distance."""
    y = np.linspace(-1.0, 1.0, 2001)
    half = 1.0 - np.abs(y)
    kept = half > 1e-9
    found = strips(y, np.flatnonzero(kept), -half[kept], half[kept], 1e-6)
    assert len(found.quads) < 60
    assert area(found.quads) == pytest.approx(2.0, abs=1e-5)
    round_ = np.sqrt(1.0 - y[1:-1] ** 2)
    circle = strips(y[1:-1], np.arange(1999), -round_, round_, 1e-5)
    assert len(circle.quads) < 700
    assert area(circle.quads) == pytest.approx(np.pi, abs=3e-4)


def test_strips_end_where_material_forks_begins_or_ends():
    y = np.array([0.0, 1.0, 2.0, 3.0])
    ray, low, high = np.array([0, 1, 1, 3]), np.array([0.0, 0.0, 7.0, 0.0]), np.array([10.0, 3.0, 10.0, 3.0])
    found = strips(y, ray, low, high, 0.01)
    assert len(found.quads) == 8  # two halves of each: nothing is joined over a fork or a ray without material
    assert area(found.quads) == pytest.approx(10.0 + 3.0 + 3.0 + 3.0)
    touching = strips(y[:2], np.array([0, 1]), np.array([0.0, 2.0]), np.array([2.0, 4.0]), 0.01)
    assert len(touching.quads) == 4  # what only meets in a point is not joined
    none = np.empty(0)
    assert [len(part) for part in strips(y, none.astype(int), none, none, 0.01)] == [0, 0]
