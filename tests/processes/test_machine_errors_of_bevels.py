"""Flank-milled bevels cut by their program on a machine with errors, against hands; and the same by a scene of G-code.

Errors that move a conical tool by g up its axis leave g sin(taper), exactly and everywhere: the shifted cone is an
offset of itself, and so is what it sweeps.
"""

from dataclasses import replace
from math import exp, radians, sin

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.metrology.grid import GridInspection
from gearsim.metrology.inspection import perform
from gearsim.motion.real_motion import RealMotion
from gearsim.processes.run import plan
from gearsim.scene import check_scene, load_scene
from gearsim.simulation.workshop import Workshop

SMALL = (
    "toolpath.points=9", "metrology.convergence=[]", "simulation.dexel_pitch_mm=2.0",
    "program.linear_decimals=6", "program.rotary_decimals=6",
)  # fmt: skip
NOTHING = "errors.axes.B.offset_y_um=1"  # along its own axis: the program of the machine as it is


def scene(*errors):
    return load_scene("spiral-bevel-flank", (*SMALL, *errors))[0]


def deviations(job, device):
    """Deviations [mm] of both flanks under the whole program, on a few points."""
    found = {}
    for side in ("convex", "concave"):
        grid = GridInspection(side, ("program",), (), 3, 5, 0.1)
        (measured,) = perform(grid.steps(job), Workshop(device, 1e-10, 16)).measurements
        found[side] = measured.deviation.value
    return found


@pytest.fixture(scope="module")
def nominal():
    return deviations(plan(scene(NOTHING)), "cpu")


def test_the_program_read_back_is_the_cl_data_but_for_its_digits_and_axes(nominal, device):
    """Rotary axes run linearly between 9 points, CL data's axes on great circles."""
    without = plan(scene())
    assert not without.notes
    for side, cl in deviations(without, device).items():
        assert nominal[side] == pytest.approx(cl, abs=2e-3)


def test_a_spindle_that_has_grown_leaves_its_growth_times_the_tapers_sine(nominal, device):
    """8 um (1 - exp(-t / 0.5 s)) down the tool: all of it before the second flank's pass begins."""
    job = plan(scene("errors.thermal.spindle_um=8", "errors.thermal.spindle_minutes=0.00833"))
    acting, note = job.notes
    assert acting.startswith("errors act: thermal.spindle_um = 8;")
    assert "errors of its axes included, does with program.nc" in note
    found = deviations(job, device)
    (last,) = (o for o in job.variant("program").operations)
    assert exp(-float(np.nansum(last.seconds)) / 2.0 / 0.5) < 1e-4
    deeper = nominal["concave"] - found["concave"]
    assert deeper == pytest.approx(8e-3 * sin(radians(15.0)), abs=1e-6)  # along the intended normal: 9 points lean it


def test_both_roads_are_asked_for_the_real_motion(device):
    """The envelope road solves the motion itself, the removal road asks the table compiled from it."""
    job = plan(scene("errors.axes.B.tilt_x_urad=50", "errors.axes.Z.bow_x_um=9", "errors.axes.C.backlash_urad=30"))
    for side in ("convex", "concave"):
        grid = next(i for i in job.inspections if isinstance(i, GridInspection) and i.surface == side)
        few = replace(grid, variants=("program",), witnessed=(), strangers="", series=(), rows=3, columns=5)
        reading = perform(few.steps(job), Workshop(device, 1e-10, 16))
        last = next(m for m in reading.measurements if m.variant == "last operation")
        assert last.gap.valid == 15
        assert last.gap.max_um < 1e-5
        assert not reading.doubts


def test_the_same_program_in_a_scene_of_its_own_is_cut_alike(tmp_path, nominal, device):
    errors = ("errors.axes.X.scale_um_m=40", "errors.axes.C.backlash_urad=30", "errors.axes.B.tilt_x_urad=50")
    given = scene(*errors)
    job, tables = plan(given), given.model_dump(exclude_none=True)
    (tmp_path / "own.nc").write_text(job.files["program.nc"])
    own = check_scene(
        {
            "scene": {"name": "own"}, "surface": tables["surface"], "cutter": tables["cutter"],
            "machine": tables["program"]["machine"], "metrology": {"tolerance_um": 5.0},
            "simulation": tables["simulation"], "errors": {"axes": tables["errors"]["axes"]},
            "toolpath": {"file": "own.nc", "mounting": {"z_axis": [0.0, 0.0, -1.0]}},
        },
        "own",
    )  # fmt: skip
    twin = plan(own, tmp_path)
    assert isinstance(twin.variant("program").operations[0].sources[0].source, RealMotion)
    ours, theirs = deviations(job, device), deviations(twin, device)
    for side, nothing in nominal.items():
        assert theirs[side] == pytest.approx(ours[side], abs=1e-9)
        assert np.abs(ours[side] - nothing).max() > 1e-4


def test_errors_need_a_machine_that_runs_gcode():
    given, lean = scene().model_dump(exclude_none=True), {"squareness": {"c0y_urad": 1.0}}
    tables = {name: table for name, table in given.items() if name != "program"}
    with pytest.raises(InputError, match=r"errors: axes, squareness and thermal are a machine's.*give \[program\]"):
        check_scene(tables | {"errors": lean}, "own")
    csv = {"kind": "program", "file": "axes.csv"}
    own = {name: given[name] for name in ("surface", "cutter", "simulation")} | {"scene": {"name": "own"}}
    own |= {"machine": given["program"]["machine"], "metrology": {"tolerance_um": 5.0}, "toolpath": csv}
    with pytest.raises(InputError, match=r"errors: a machine with errors runs G-code here, not axes\.csv"):
        check_scene(own | {"errors": lean}, "own")
