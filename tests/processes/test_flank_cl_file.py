"""A user's CL file in a flank-milling scene: what is told of it, what is refused before anything is cut."""

from pathlib import Path

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.processes.flank_milling import own_paths
from gearsim.processes.run import plan
from gearsim.programs.cldata import parse_cl
from gearsim.scene import load_scene
from gearsim.verify.scenes import closed_forms

DATA = Path(__file__).parents[1] / "data" / "cl"
SCENE = DATA / "twotools65.toml"
OWN = (DATA / "own65.cl").read_text()


@pytest.fixture
def planned(tmp_path):
    scene = load_scene(SCENE, ("toolpath.file=my.cl",))[0].model_copy(update={"reference": None})

    def make(text, use=plan):
        (tmp_path / "my.cl").write_text(text, encoding="latin-1")
        return use(scene, tmp_path)

    return make


def own_of(job, side):
    """The paths of a flank's own pass, and that the variant is made of them."""
    paths = own_paths(parse_cl(job.files["toolpath.cl"]), side)
    assert np.unique(job.variant("own pass", side).operations[0].table.path).tolist() == paths
    return paths


def test_pass_names_that_are_no_flanks_are_listed_with_the_nearest(planned):
    job = planned(OWN.replace("PASS convex", "PASS convx"))
    assert job.notes == (
        "CL file: passes named after no flank: 'convx' (line 10, did you mean convex?); flanks are convex and concave",
        "CL file: no pass is named convex: every cutting pass counts as its own",
    )
    assert own_of(job, "convex") == [1, 3]
    assert own_of(job, "concave") == [3]


def test_a_file_without_names_is_one_pass_for_both_flanks_and_needs_no_remark(planned):
    job = planned(OWN.replace("PPRINT PASS", "PPRINT THE"))
    assert job.notes == ()
    assert own_of(job, "convex") == own_of(job, "concave") == [1, 3]


def test_the_cutter_is_compared_by_verify_too(planned):
    with pytest.raises(InputError, match=r"my\.cl is for CUTTER/3\.5"):
        planned(OWN.replace("CUTTER/3.30772318,0.8", "CUTTER/3.5,0.9").replace("1.04,0.8", "1.04,0.9"), closed_forms)


def test_verify_takes_every_path_of_a_pass_that_rapids_divide(planned):
    lines = OWN.splitlines()
    inside = lines.index("PPRINT PASS convex") + 50
    text = "\n".join([*lines[:inside], "RAPID", *lines[inside:]])
    whole, divided = ([form.name for form in planned(t, closed_forms)] for t in (OWN, text))
    second = [name for name in divided if "convex 2" in name]
    assert len(second) == sum("convex" in name for name in whole) > 0
    assert len(divided) == len(whole) + len(second)


def test_other_conditions_of_the_machines_program_are_told(planned):
    job = planned(
        OWN.replace("PPRINT PASS concave\nFEDRAT/600", "SPINDL/RPM,2245,CLW\nPPRINT PASS concave\nFEDRAT/0.1,MMPR")
    )
    assert job.notes == (
        "CL file: the feeds of cutting moves are 224.5 to 600 mm/min; program.nc keeps the slowest throughout",
        "CL file: SPINDL states 2245/min; program.nc runs at the scene's program.spindle_rpm, 4000",
    )


def test_strange_letters_in_comments_do_not_stop_it(planned):
    assert planned(OWN.replace("PARTNO sb65", "PARTNO Fräser ß $")).notes == ()
