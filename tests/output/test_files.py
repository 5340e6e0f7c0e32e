import errno
import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from gearsim.errors import InputError, written
from gearsim.metrology.grid import DENSE
from gearsim.output.files import into, staged
from gearsim.output.meshes import write_vtp
from gearsim.output.painting import Painters
from gearsim.output.wanted import Wanted
from gearsim.output.write import write_result
from gearsim.surfaces.patch import SIDES
from tests.limits import files_no_larger_than

PICTURES = {
    "tooth.png",
    "inspection.png",
    "blanks.png",
    "toolpaths.png",
    "envelopes.png",
    "deviation.png",
    "mean-profile.png",
}
FILES = PICTURES | {
    "report.json", "report.md", "report.html", "deviation.exr", "tooth.vtp",
    "samples.parquet", "toolpath.cl", "program.nc",
}  # fmt: skip


def test_a_run_leaves_exactly_these_files(folder):
    assert {f.name for f in folder.iterdir()} == FILES


def test_report_json_holds_the_promised_keys(folder):
    report = json.loads((folder / "report.json").read_text())
    assert report["schema_version"] == 2
    assert report["verdict"] == "pass"
    assert report["device"] == "cpu"
    assert report["status"] == "OK"
    (stock,) = (f for f in report["findings"] if f["kind"] == "root_stock")
    assert (
        f"stock is left on the bottom land; it takes a pass of its own ({stock['depth_um']:+.4g} um)"
        in report["headline"]
    )
    assert f"**PASS**: {report['headline']}." in (folder / "report.md").read_text()
    assert set(report["timings_s"]) >= {"compile", "plan", "kernel", "total"}
    assert all(report["counts"][k] > 0 for k in ("rays", "segments", "pairs"))
    assert report["program"] == "program"
    assert set(report["measurements"]) == {*report["surfaces"], "part"}
    for side in ("convex", "concave"):
        assert report["surfaces"][side] == {"overcut_tolerance_um": 5.0, "excess_tolerance_um": 5.0}
        flank = report["measurements"][side]
        for variant in ("theory", "own_pass", "program"):
            assert variant in report["variants"]
            assert set(flank[variant]["dense_grid"]["deviation_um"]) >= {"min", "max", "mean", "rms"}
        for variant in ("theory", "own_pass"):
            gap = flank[variant]["dense_grid"]["envelope_gap_um"]
            assert gap["max"] <= 0.001
            assert (gap["valid"], gap["excluded"]) == (85, 0)
        assert flank["program"]["dense_grid"]["envelope_gap_um"] is None
        assert np.shape(flank["program"]["inspection_grid"]["topography"]["as_cut_um"]) == (5, 9)
        profile = flank["theory"]["mean_profile"]
        assert list(profile["normal_um"]) == [f"L{i}" for i in range(7)]
        assert abs(profile["normal_um"]["L0"]) < 1e-5
        assert len(profile["in_plane_um"]) == 7
        assert profile["published_um"]["L6"] < 0.0
        assert flank["own_pass"]["convergence"]["points"] == [9, 17]
        assert flank["own_pass"]["convergence"]["order"] == pytest.approx(2.0, abs=0.1)
    assert report["surfaces"]["bottom"] == {"overcut_tolerance_um": 5.0, "excess_tolerance_um": None}
    for finding in report["findings"]:
        assert {"kind", "depth_um", "place_mm"} <= set(finding)


def test_exr_has_a_part_per_flank_with_named_channels_and_headers(folder, result):
    import OpenEXR

    with OpenEXR.File(str(folder / "deviation.exr"), separate_channels=True) as file:
        assert [p.name() for p in file.parts[1:]] == ["convex", "concave", "concave fillet", "bottom", "convex fillet"]
        for part in file.parts[1:]:
            channels, header = part.channels, part.header
            m = result.measurements[part.name(), "program", DENSE]
            by_two_roads = {f"{name}.{what}.um" for name in ("theory", "own_pass") for what in ("deviation", "gap")}
            assert set(channels) == {
                "deviation.um", "P.X", "P.Y", "P.Z", "N.X", "N.Y", "N.Z", "segment.id", "valid",
                "share.length", "share.height", "parameter.u", "parameter.v",
                *(by_two_roads if part.name() in SIDES else ()),
            }  # fmt: skip
            assert all(c.pixels.dtype == np.float32 for c in channels.values())
            assert np.allclose(channels["deviation.um"].pixels, 1e3 * m.deviation.value, rtol=1e-6)
            assert np.allclose(channels["P.Y"].pixels, m.grid.point[..., 1], rtol=1e-6)
            stated_in_full({k: v for k, v in header.items() if k.startswith("gearsim.")}, result)
            assert (header["gearsim.rows"], header["gearsim.columns"]) == tuple(map(str, m.grid.shape))
            assert "share.height 0.01 to 0.99" in header["gearsim.parameters"]
            assert json.loads(header["gearsim.settings"])["cutter"]["kind"] == "conical"
            assert set(json.loads(header["gearsim.channels"])) == set(channels)


def stated_in_full(notes, result):
    """Scene, units, sign, frame, motion, what rows and columns are, how the picture lies, version."""
    assert notes["gearsim.scene"] == "spiral-bevel-flank"
    assert "positive = material left" in notes["gearsim.sign"]
    assert notes["gearsim.units"].startswith("mm")
    assert notes["gearsim.version"]
    assert notes["gearsim.frame"] == result.frame
    assert notes["gearsim.program"] == "program"
    assert "deviation_um and segment.id are under program" in notes["gearsim.motion"]
    assert notes["gearsim.rows_and_columns"] == "rows root to tip, columns toe to heel"
    assert notes["gearsim.grid"].startswith("row 0 (the picture's top) is the root")


def test_parquet_holds_every_sample_with_its_metadata(folder, result):
    import pyarrow.parquet as pq

    table = pq.read_table(folder / "samples.parquet")
    assert table.num_rows == 2 * 5 * 17 + 3 * 3 * 17
    notes = {k.decode(): v.decode() for k, v in table.schema.metadata.items() if k.startswith(b"gearsim.")}
    stated_in_full(notes, result)
    columns = table.to_pydict()
    convex = np.array(columns["surface"]) == "convex"
    um = np.array(columns["program_um"])[convex]
    assert np.allclose(um, 1e3 * result.measurements["convex", "program", DENSE].deviation.value.ravel())
    root = ~np.isin(columns["surface"], SIDES)
    assert all(columns[name][i] is None for name in ("theory_um", "own_pass_gap_um") for i in np.flatnonzero(root))
    envelope = np.array(columns["theory_class"]) == "envelope"
    intended, machined = (np.array(columns[f"{w}_k2_per_mm"], dtype=float) for w in ("intended", "theory"))
    assert np.allclose(intended[envelope & convex], machined[envelope & convex], atol=2e-3)


def test_machined_surfaces_open_in_vtk(folder, result):
    import pyvista as pv

    mesh = pv.read(folder / "tooth.vtp")
    assert mesh.n_points == 2 * 85 + 3 * 3 * 17
    stated_in_full({k: str(mesh.field_data[k][0]) for k in mesh.field_data}, result)
    assert {"deviation_um", "crossing", "segment", "patch", "intended_normal"} <= set(mesh.point_data)
    moved = np.sum((mesh.points - mesh["intended_point_mm"]) * mesh["intended_normal"], axis=1)
    assert np.allclose(1e3 * moved, mesh["deviation_um"], atol=0.05)


def test_html_is_one_file_with_its_pictures_inside(folder):
    html = (folder / "report.html").read_text()
    assert html.count('<p><img src="data:image/png;base64,') == len(PICTURES)
    assert 'src="slot.png"' not in html
    assert "<table>" in html
    text = (folder / "report.md").read_text()
    for word in ("positive is material left", "Zhou 2015", "## Findings", "best rotated", "![", "order", "±5 µm"):
        assert word in text


def test_pictures_are_not_blank(folder):
    from matplotlib.image import imread

    for name in PICTURES:
        picture = imread(folder / name)[..., :3]
        assert picture.shape[0] > 400
        assert picture.std() > 0.02


def test_the_program_written_is_the_program_simulated(folder, result):
    from gearsim.programs.cldata import parse_cl

    text = (folder / "toolpath.cl").read_text()
    assert text == result.job.files["toolpath.cl"]
    assert (folder / "program.nc").read_text() == result.job.files["program.nc"]
    names = [p.name for p in parse_cl(text).paths]
    assert names == ["rapid", "convex", "rapid", "concave", "rapid"]


def test_an_error_leaves_nothing_and_an_older_run_whole(tmp_path):
    (tmp_path / "report.json").write_text("old")

    def fail_half_way():
        with staged(tmp_path) as stage:
            (stage / "report.md").write_text("new")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail_half_way()
    assert [f.name for f in tmp_path.iterdir()] == ["report.json"]


def test_an_unwritable_folder_is_named(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("")
    with pytest.raises(InputError, match=r"cannot write into output folder .*file.*--out"), staged(blocked / "out"):
        pass


def test_killing_a_run_half_way_leaves_no_file_that_looks_finished(tmp_path):
    out = tmp_path / "out"
    command = [sys.executable, "-m", "gearsim.cli", "run", "spiral-bevel-flank", "--out", str(out)]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 60.0
    while not list(out.glob(".unfinished-*/*")) and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.02)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert [f.name for f in out.iterdir() if not f.name.startswith(".unfinished-")] == []
    assert list(out.iterdir())
    with staged(out):
        assert len(list(out.iterdir())) == 1  # a later run's own
    assert list(out.iterdir()) == []


@pytest.mark.parametrize("size", [3_000, 60_000])
def test_a_disk_that_takes_no_more_leaves_nothing(result, tmp_path, size):
    out = tmp_path / "out"
    with pytest.raises(InputError, match=r"cannot write into output folder .*out: .*File too large"), \
            files_no_larger_than(size), staged(out) as stage, into(out):  # fmt: skip
        write_result(result, stage, Painters(Wanted(pictures=False)))
    assert list(tmp_path.iterdir()) == []


def test_a_drawing_process_that_the_disk_refuses_ends_the_run(tmp_path):
    painters = Painters(Wanted(pictures=False))
    pipe, ending = subprocess.PIPE, f"import sys; sys.exit(100 + {errno.ENOSPC})"
    process = subprocess.Popen([sys.executable, "-c", ending], stdin=pipe, stderr=pipe, text=True)
    painters._processes, painters._folder = {"flat": process}, tmp_path
    with pytest.raises(OSError, match="No space left on device"):
        painters.finish()


def test_a_mesh_that_finds_no_room_ends_no_process(tmp_path):
    import pyvista as pv

    with pytest.raises(OSError, match="File too large"), files_no_larger_than(1000):
        write_vtp(pv.Sphere(), {"scene": "a"}, tmp_path / "tooth.vtp")


def test_scratch_folders_of_killed_runs_are_cleared_and_those_of_living_ones_kept(tmp_path):
    killed = tmp_path / ".unfinished-killed"
    killed.mkdir()
    (killed / "report.md").write_text("half")
    (tmp_path / ".unfinished-file").write_text("a user's own")
    with staged(tmp_path) as living:
        assert not killed.exists()
        (living / "report.md").write_text("first")
        with staged(tmp_path) as other:
            (other / "report.md").write_text("second")
            assert living.exists()
        assert (living / "report.md").read_text() == "first"
    assert (tmp_path / "report.md").read_text() == "first"
    assert sorted(f.name for f in tmp_path.iterdir()) == [".unfinished-file", "report.md"]


KILLED = """
import os, sys
from pathlib import Path
from gearsim.errors import written
with written(Path(sys.argv[1])) as scratch:
    scratch.write_text("half")
    os.kill(os.getpid(), 9)
"""


def test_scratch_files_of_killed_commands_are_cleared_and_those_of_living_ones_kept(tmp_path):
    mine, target = tmp_path / ".unfinished-file", tmp_path / "v.json"
    mine.write_text("a user's own")
    for later in (lambda: staged(tmp_path), lambda: written(tmp_path / "other.json")):
        process = subprocess.run([sys.executable, "-c", KILLED, str(target)], check=False)
        assert process.returncode == -signal.SIGKILL
        (left,) = tmp_path.glob(".unfinished-*-v.json")
        assert left.read_text() == "half"
        with later() as scratch:
            assert not left.exists()
            (scratch / "a" if scratch.is_dir() else scratch).write_text("whole")
    with written(target) as scratch:
        scratch.write_text("first")
        with written(tmp_path / "other.json") as other:
            assert scratch.exists()
            other.write_text("second")
    assert {f.name: f.read_text() for f in tmp_path.iterdir()} == {
        ".unfinished-file": "a user's own", "a": "whole", "other.json": "second", "v.json": "first",
    }  # fmt: skip


def test_a_link_named_like_scratch_is_not_followed(tmp_path):
    (tmp_path / "kept.txt").write_text("kept")
    (tmp_path / ".unfinished-1-v.json").symlink_to(tmp_path / "kept.txt")
    with written(tmp_path / "v.json") as scratch:
        scratch.write_text("new")
    assert (tmp_path / "kept.txt").read_text() == "kept"
