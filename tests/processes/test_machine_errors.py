"""Gears cut by machines with errors, against what a hand finds.

The tool stands at Y = r_b and a flank is the envelope of its side, which touches square to the machine's X: the left
one at X = -(r + L), the right one at r + L, L being the roll length along the normal. To first order what moves it
along X is seen, and what turns the gear: deviations along the normal are the tool's way along X, +-.
"""

from math import cos, tan
from pathlib import Path
from unittest import mock

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.machines.catalogue import table_table_bc
from gearsim.motion.program import ProgramMotion
from gearsim.processes import cylindrical
from gearsim.processes.gear_budget import disturbed_operations
from gearsim.scene import load_scene
from gearsim.scene.cylindrical import ErrorsTable
from gearsim.scene.error_table import ErrorTable
from gearsim.scene.machine_errors import MachineErrorsTable
from gearsim.studies.records import Parameter
from gearsim.surfaces.cylindrical_gear import SIDES
from tests.processes import test_gear_cutting
from tests.processes.test_gear_cutting import Work, one_space, traces

FEW_BLOCKS = ("toolpath.finishing.axial_step_mm=5", "toolpath.finishing.involute_step_mm=8")
SENSE = {"left": -1.0, "right": 1.0}


def work(name):
    """A gear's plan without its operations, which are compiled for one space below."""
    with (
        mock.patch.object(test_gear_cutting, "plan", lambda scene: cylindrical.plan(scene, Path())),
        mock.patch.object(cylindrical, "disturbed_operations", return_value=()),
    ):
        return Work(name, *FEW_BLOCKS)


@pytest.fixture(scope="module")
def spur():
    return work("spur-external")


@pytest.fixture(scope="module")
def helical():
    return work("helical-external")


def errors(**tables):
    return cylindrical.disturbance(ErrorsTable.model_validate(tables))


def deviations(job, device, **tables):
    return traces(job, device, one_space(job).blocks, errors(**tables))


def slope(found, kind, side):
    """How a side's transverse deviations grow along its traces; but for their ends, which the last block cuts."""
    lines = getattr(found, kind)[side]
    inside = slice(2, -2)
    return np.polyfit(
        lines.position[inside], 1e-3 * lines.deviation_um.reshape(-1, len(lines.position))[:, inside].T, 1
    )[0]


def test_what_does_not_move_the_tools_side_is_not_seen(spur, device):
    """Y moves it along itself, Z the cylinder along its axis."""
    _, mm = deviations(spur, device, axes={"Z": {"scale_um_m": 10.0}, "Y": {"scale_um_m": 1.0}})
    assert max(np.nanmax(np.abs(mm[side])) for side in SIDES) < 1e-8


def test_a_scale_of_x_is_a_profile_slope_and_on_helical_gears_a_helix_slope(spur, helical, device):
    """50 um/m: k L on the profile; along a helix L grows by tan(beta_b) z: f_Hbeta = k tan(beta_b) b, 83 nm here."""
    k = 50e-6
    for job in (spur, helical):
        found, _ = deviations(job, device, axes={"X": {"scale_um_m": 50.0}})
        for side in SIDES:
            assert slope(found, "profile", side) == pytest.approx(k, abs=1e-8)
            lead = SENSE[side] * k * tan(job.gear.base_helix_angle)
            assert slope(found, "helix", side) == pytest.approx(lead, abs=1e-8)


def test_backlash_of_x_shifts_the_space_by_all_of_it(spur, device):
    """Both flanks are cut with X going back, which leaves it 3 um farther on: deeper left, not so deep right."""
    _, mm = deviations(spur, device, axes={"X": {"backlash_um": 3.0}})
    for side in SIDES:
        assert mm[side] == pytest.approx(SENSE[side] * 3e-3, abs=1e-8)


def test_backlash_and_scale_of_c_turn_the_gear(spur, helical, device):
    """100 urad of backlash: r_b cos(beta_b) b, C going back; a scale s of as much: a base circle that is off by s, and
    a lead that is, f_Hbeta = s tan(beta_b) b."""
    for job in (spur, helical):
        arm = job.gear.base_radius * cos(job.gear.base_helix_angle)
        _, mm = deviations(job, device, axes={"C": {"backlash_urad": 100.0}})
        found, _ = deviations(job, device, axes={"C": {"scale_urad_rad": 100.0}})
        for side in SIDES:
            assert mm[side] == pytest.approx(-SENSE[side] * arm * 1e-4, abs=5e-8)
            assert slope(found, "profile", side) == pytest.approx(-1e-4, abs=5e-8)
            lead = -SENSE[side] * 1e-4 * tan(job.gear.base_helix_angle)
            assert slope(found, "helix", side) == pytest.approx(lead, abs=5e-8)


def test_a_lean_of_the_tool_is_the_helix_slope(spur, device):
    """E_BY of 200 urad/m at Y = r_b leans the tool to X by 7.05 urad, all along the face."""
    found, _ = deviations(spur, device, axes={"Y": {"about_y_urad_m": 200.0}})
    for side in SIDES:
        lean = SENSE[side] * 200e-9 * spur.gear.base_radius
        assert slope(found, "helix", side) == pytest.approx(lean, abs=1e-9)


def test_squareness_of_z_is_a_slope_of_helical_gears(helical, device):
    """Of 500 urad. The last layer cuts deepest right, where Z goes down by sin(beta_b) of the way along the flank's
    rolling: e tan(beta_b) on the profile, and with the lead e tan(beta_b)^2 on the helix: f_Hbeta = 137 nm."""
    e, lean = 500e-6, tan(helical.gear.base_helix_angle)
    found, _ = deviations(helical, device, squareness={"b0z_urad": 500.0})
    assert slope(found, "profile", "right") == pytest.approx(-e * lean, abs=1e-7)
    assert slope(found, "helix", "right") == pytest.approx(-e * lean**2, abs=1e-7)


def test_squareness_of_z_leaves_a_step_between_the_layers_of_a_spur_gear(spur, device):
    """Layers at 5 and 10 mm stand to -X: right the lower one cuts deepest, left each leaves its own."""
    e = 500e-6
    found, _ = deviations(spur, device, squareness={"b0z_urad": 500.0})
    z = found.helix["left"].position
    clear = np.abs(z + 5.0) > 0.1
    left, right = (1e-3 * found.helix[side].deviation_um[0, 0] for side in ("left", "right"))
    assert left[clear] == pytest.approx(e * np.where(z > -5.0, 5.0, 10.0)[clear], abs=1e-7)
    assert right == pytest.approx(-e * 10.0, abs=1e-7)


def test_a_pivot_by_either_key_is_the_same(helical):
    machine, values = helical.machine, one_space(helical).blocks.values
    both = errors(pivot_um=(3.0, 0.0, -5.0), axes={"B": {"offset_z_um": -3.0}})
    twins = [errors(pivot_um=(3.0, 0.0, -8.0)), errors(axes={"B": {"offset_x_um": 3.0, "offset_z_um": -8.0}}), both]
    a, b, c = (real.machine(machine).forward(values)[0] for real in twins)
    assert a.tolist() == b.tolist()
    assert c == pytest.approx(a, abs=1e-12)


def test_errors_of_zero_are_the_nominal_machine(helical):
    blocks = one_space(helical).blocks
    for nothing in (errors(), errors(axes={"X": {"bow_length_mm": 3.0}}, thermal={"spindle_minutes": 5.0})):
        assert nothing.machine(blocks.machine) is None
    (cut,) = disturbed_operations(blocks, helical.tools, errors(), 1e-9)
    assert isinstance(cut.sources[0].source, ProgramMotion)


def test_tables_are_in_micrometres_and_say_which_axes_there_are():
    """2 K and 11.5 um/(m K) are a scale of 23 um/m of every slide; the spindle grows against the tool's axis."""
    scene, _ = load_scene("spur-external", ["errors.thermal.scales_k=2", "errors.axes.Z.scale_um_m=-10"])
    values = scene.controller().values(X=1000.0, Z=-500.0)
    assert scene.faulty().forward(values)[0] == pytest.approx(np.array([[1000.023, 0.0, -500.0065]]), abs=1e-9)
    grown, _ = load_scene("spur-external", ["errors.thermal.spindle_um_min=0.5", "errors.axes.B.zero_urad=0"])
    assert grown.faulty().forward(0.0 * values, minutes=4.0)[0] == pytest.approx(
        np.array([[0.0, 0.0, -2e-3]]), abs=1e-12
    )
    for key, told in (
        ("errors.axes.A.zero_urad=1", "errors: no rotary axis A; table-table-bc has B, C"),
        ("errors.axes.W.scale_um_m=1", r"errors\.axes\.W"),
        ("errors.axes.X.scale_um=1", r"errors\.axes\.X\.scale_um: unknown key.*scale_um_m"),
        ("errors.axes.X.backlash_um=-1", r"errors\.axes\.X\.backlash_um"),
    ):
        with pytest.raises(InputError, match=told):
            load_scene("spur-external", [key])


def keys(table, above="errors"):
    """The dotted keys of a table's numbers."""
    for name in type(table).model_fields:
        value = getattr(table, name)
        yield from keys(value, f"{above}.{name}") if isinstance(value, ErrorTable) else [f"{above}.{name}"]


def test_every_key_names_its_unit_and_acts_alone():
    """Alone it is told in the notes, and the machine is another one; but for lengths and phases of other errors."""
    machine, conditions = table_table_bc(), ("bow_length_mm", "reference_mm", "phase_deg", "minutes", "m_k")
    for key in keys(MachineErrorsTable()):
        assert Parameter(key, ()).unit != "1"
        tables = 2.0
        for name in reversed(key.split(".")[1:]):
            tables = {name: (2.0, 2.0, 2.0) if name == "reference_mm" else tables}
        table = MachineErrorsTable.model_validate(tables)
        acts = not key.endswith(conditions)
        assert table.acting() == [f"{key.removeprefix('errors.')} = 2"] * acts
        if ".A." not in key and ".D." not in key:
            assert (table.real(machine) is not None) == acts
