"""The examples of docs/examples run as they stand, and print what they promise."""

import subprocess
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1] / "docs" / "examples"
SAID = {
    "part_of_your_own.py": ("pass {'min':", "the two roads agree to"),
    "what_a_scene_measures.py": ("concave fillet   overcut 5 µm", "own pass", "pass the convex fillet is overcut"),
    "study_of_errors.py": ("as planned", "z + 5 um"),
    "study_ridge.py": ("job 0 drawn: 5 x 17 samples", "8 unseen jobs: maps predicted to 0.00"),
    "gcode_on_rays.py": ("x =   0.0: cut down to z = -2.000000 mm by line 8: G01 X20.",),
    "tolerances.py": ("theory  ±0.1 µm   pass: OK", "cl      ±0.1 µm   fail: OK", "unchecked: nothing was judged"),
}


@pytest.mark.parametrize("name", SAID)
def test_an_example_runs_and_says_what_it_promises(name):
    done = subprocess.run([sys.executable, FOLDER / name], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    for words in SAID[name]:
        assert words in done.stdout


def test_every_example_is_run():
    of_verify = {"helical_groove.py"}  # tests/verify runs it
    assert {f.name for f in FOLDER.glob("*.py")} == set(SAID) | of_verify
