"""Every file of tests/data/cl: small CL files that were once read wrong, and what is right."""

from pathlib import Path

import numpy as np
import pytest

from gearsim.processes.run import plan
from gearsim.programs.cldata import RAPID, parse_cl, read_cl_text
from gearsim.scene import load_scene

FOLDER = Path(__file__).parents[1] / "data" / "cl"


def read(name):
    return parse_cl(read_cl_text(FOLDER / name), name)


def planned(name):
    """The scene beside the files with another file's path, so without what was printed for the planned one."""
    scene, folder = load_scene(FOLDER / "twotools65.toml", (f"toolpath.file={name}",))
    return plan(scene.model_copy(update={"reference": None}), folder)


def ipm():
    assert read("ipm.cl").feed == 599.44


def dollar():
    cut, rapid = read("dollar.cl").paths
    assert (rapid.name, rapid.tips.tolist()) == (RAPID, [[10.0, 0.0, 0.0], [10.0, 0.0, 90.0]])
    assert cut.tips.tolist() == [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]]


def multax():
    (path,) = read("multax.cl").paths
    assert path.tips.tolist() == [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]]
    assert path.axes.tolist() == [[0.6, 0.0, 0.8], [0.0, 0.0, 1.0]]


def own65():
    job = planned("own65.cl")
    names = [p.name for p in parse_cl(job.files["toolpath.cl"]).paths]
    assert names == [RAPID, "convex", RAPID, "concave", RAPID]
    assert job.notes == ()


def cutter4():
    ours, theirs = planned("own65.cl"), planned("cutter4.cl")
    assert theirs.notes == ()
    assert np.array_equal(*(job.variant("program").operations[0].table.tip for job in (ours, theirs)))


def twotools65():
    """The ball of the first pass, which the scene does not know, is cut as its CUTTER states it."""
    job = planned("twotools65.cl")
    first, second = job.variant("program").operations
    assert (first.cutter.max_radius, first.cutter.height) == (8.0, 60.0)
    assert second.cutter == load_scene(FOLDER / "twotools65.toml")[0].tool()
    assert "tool 1, CUTTER/16, 8, 0, 8, 0, 0, 60 (line 4) is cut as CUTTER states it" in job.notes[0]
    assert [line for line in job.files["program.nc"].splitlines() if "M06" in line] == ["T1 M06", "T2 M06"]
    assert [len(job.variant("own pass", side).operations) for side in ("convex", "concave")] == [1, 1]


RIGHT = {f"{case.__name__}.cl": case for case in (ipm, dollar, multax, own65, cutter4, twotools65)}


@pytest.mark.parametrize("name", sorted(f.name for f in FOLDER.glob("*.cl")))
def test_a_file_that_was_read_wrong_is_read_right(name):
    RIGHT[name]()
