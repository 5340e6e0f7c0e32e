"""Gears cut from their programs: what exact numbers give, and what each cause alone costs, against closed forms."""

from dataclasses import replace
from math import cos, radians, sin

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.metrology.gear_iso import GearProbing
from gearsim.metrology.gear_probing import probing
from gearsim.metrology.inspection import perform
from gearsim.processes.gear_budget import disturbed_operations, first_space
from gearsim.processes.run import plan
from gearsim.programs.post_options import PostOptions
from gearsim.simulation.disturbance import Disturbance
from gearsim.simulation.operation import Variant
from gearsim.simulation.workshop import Workshop
from gearsim.surfaces.cylindrical_gear import SIDES, flank_sign
from gearsim.toolpaths.cylindrical.posting import as_printed, planned, posted, with_tip_control
from tests.processes.gears import gear_scene

SCENES = ("spur-external", "helical-external", "spur-internal", "helical-internal")
NONE = Disturbance()


class Work:
    """A gear scene planned, but for its budget, and what its tests ask of it."""

    def __init__(self, name, *overrides):
        scene = gear_scene(*overrides, of=name)
        self.job = plan(scene)
        self.probing = next(i for i in self.job.inspections if isinstance(i, GearProbing))
        self.probed, self.gear = self.probing.probed, scene.gear()
        self.machine, self.finishing = scene.controller(), scene.finishing()
        self.tools = {t.number: t.build() for t in scene.tools}
        self.text = self.job.files["program.nc"]


def gear_job(name, *overrides):
    return Work(name, *overrides)


@pytest.fixture(scope="module", params=SCENES)
def job(request):
    return gear_job(request.param)


def one_space(job):
    return first_space(planned(job.gear, job.machine, (job.finishing,), False)[0], job.gear.count)


def traces(job, device, blocks, real=NONE):
    """Normal deviations [mm] of all trace samples, by side."""
    cut = Variant("program", "", disturbed_operations(blocks, job.tools, real, 1e-11))
    steps = job.probing.steps(job.job.under({"program": cut}))
    (measured,) = perform(steps, Workshop(device, 1e-10, 64)).measurements
    found = measured.found
    c = 1e-3 * cos(job.gear.base_helix_angle)
    return found, {
        s: c * np.concatenate([t[s].deviation_um.ravel() for t in (found.profile, found.helix)]) for s in SIDES
    }


def test_exact_numbers_on_linear_axes_give_the_exact_involute(job, device):
    _, mm = traces(job, device, one_space(job).blocks)
    for side in SIDES:
        assert np.abs(mm[side]).max() < 1e-9  # 1 pm: the claim is 1 nm


def test_what_decimals_cost_is_bounded_by_half_units(job, device):
    """A flank moves by the tip's rounding and by the table's times the reach; B's as lean over the facewidth."""
    decimals = 3
    blocks = posted((one_space(job),), job.machine, decimals).blocks
    _, mm = traces(job, device, blocks)
    half = 0.5 * 10.0**-decimals
    tool = job.finishing.cutting.radius
    reach = max(job.gear.tip_radius, job.gear.root_radius) + tool
    bound = half * np.sqrt(3.0) + radians(half) * (reach + abs(job.machine.work[0].point[2]) + job.gear.facewidth)
    for side in SIDES:
        worst = np.nanmax(np.abs(mm[side]))
        assert 1e-5 < worst < bound


def test_a_larger_tool_cuts_every_flank_deeper_by_as_much(job, device):
    for real in (Disturbance(tool_radius=2e-3), Disturbance(tool_runout=2e-3), Disturbance(tool_runout=-2e-3)):
        _, mm = traces(job, device, one_space(job).blocks, real)
        for side in SIDES:
            assert mm[side] == pytest.approx(-2e-3, abs=1e-9)


def test_a_pivot_off_turns_and_lifts_the_gear_by_the_tilt(job, device):
    """With the axis of B off by d the gear stands off by (R(B) - 1) d: a shift along the tool plane's normal."""
    d, tilt = 1e-2, job.gear.base_helix_angle
    _, mm = traces(job, device, one_space(job).blocks, Disturbance(pivot=(0.0, 0.0, d)))
    for side in SIDES:
        spread = mm[side] - mm[side].mean()
        assert np.abs(spread).max() < 1e-9  # no slope and no form: seen from the tilted gear it is one shift
        assert abs(mm[side].mean()) == pytest.approx(abs(d * sin(tilt)), rel=1e-6, abs=1e-10)
    assert mm["left"].mean() == pytest.approx(-mm["right"].mean(), abs=1e-10)


def test_an_eccentric_gear_has_the_runout_and_the_slopes_of_a_shifted_one(device):
    """From a gear e along x the cut stands -e off: -e n_x = -e f s sin(theta), to (e cos theta)² / 2 rho."""
    job = gear_job("spur-external")
    e = 5e-3
    found, _ = traces(job, device, one_space(job).blocks, Disturbance(eccentricity=e))
    for side in SIDES:
        f, roll = flank_sign(side), probing(job.gear, side, job.probed.reached[side], 15).roll
        theta = f * roll + f * job.gear.space_half_angle
        expected = -1e3 * e * f * np.sin(theta[2:])
        measured = found.profile[side].deviation_um[0, 1, 2:]
        assert measured == pytest.approx(expected, abs=1e-2)


def test_all_spaces_of_an_eccentric_gear_show_runout_and_pitch(device):
    job = gear_job("spur-external", "metrology.spaces=0")
    e = 5e-3
    found, _ = traces(
        job, device, planned(job.gear, job.machine, (job.finishing,), False)[0].blocks, Disturbance(eccentricity=e)
    )
    angles = job.gear.pitch_angle * np.arange(job.gear.count)
    assert found.runout.total == pytest.approx(1e3 * np.ptp(e * np.cos(angles)), rel=2e-3)
    amplitude = 1e3 * e / cos(job.gear.transverse_pressure_angle)
    assert max(p.total for p in found.pitch.values()) == pytest.approx(2.0 * amplitude, rel=0.02)


def test_chords_of_the_tip_cost_their_sagitta(device):
    """Under tool-centre-point control the tip runs straight: the deepest chord's sagitta, second order in the step."""
    job = gear_job("spur-internal")
    worst = []
    for step in (1.0, 0.5, 0.25):
        operation = planned(job.gear, job.machine, (replace(job.finishing, involute_step=step),), False)[0]
        blocks = with_tip_control(first_space(operation, job.gear.count)).blocks
        _, mm = traces(job, device, blocks)
        worst.append(max(np.abs(v).max() for v in mm.values()))
    orders = np.log2(np.array(worst[:-1]) / worst[1:])
    assert np.all(orders > 1.5)
    assert worst[0] > 5e-3


def test_the_program_says_what_was_planned(job):
    """Read back, the blocks are those of the planner to half a unit of the printed decimals, times included."""
    program = posted((one_space(job),), job.machine, 4)
    own = one_space(job).blocks
    feeds = program.blocks.values[~program.blocks.rapid]
    assert np.abs(feeds - own.values[~own.rapid])[:, :3].max() < 0.51e-4
    assert np.degrees(np.abs(feeds - own.values[~own.rapid])[:, 3:]).max() < 0.51e-4
    told = np.nansum(program.blocks.seconds[~program.blocks.rapid])
    assert told == pytest.approx(np.nansum(own.seconds), rel=1e-4)


def test_the_tip_of_the_tool_keeps_its_feed(job):
    """Speed of the tip on the gear, by differences along every feed block read back, against the feed asked for."""
    printed = as_printed(one_space(job), PostOptions(), job.finishing.cutting.feed)
    blocks = posted((printed,), job.machine, 4).blocks
    fed = np.flatnonzero(~blocks.rapid)
    before, after = blocks.before[fed], blocks.values[fed]
    fastest = np.zeros(len(fed))
    h = 1e-6
    for t in (0.0, 0.3, 0.7, 1.0 - h):
        a, b = (job.machine.forward(before + s * (after - before))[0] for s in (t, t + h))
        fastest = np.maximum(fastest, np.linalg.norm(b - a, axis=1) / (h * blocks.seconds[fed]))
    assert 60.0 * fastest.max() <= job.finishing.cutting.feed * (1.0 + 1e-6)
    assert 60.0 * fastest.max() > 0.99 * job.finishing.cutting.feed


def test_a_program_of_the_users_own_is_cut_instead(tmp_path):
    job = gear_job("spur-external")
    (tmp_path / "own.nc").write_text(job.text, encoding="ascii")
    scene = gear_scene("program.file=own.nc")
    own = plan(scene, tmp_path).variant("program").operations
    for ours, theirs in zip(own, job.job.variant("program").operations, strict=True):
        assert np.array_equal(ours.table.tip, theirs.table.tip)
    (tmp_path / "own.nc").write_text(job.text.replace("T1 M06", "T7 M06").replace("G43 H1", "G43 H7"), encoding="ascii")
    with pytest.raises(
        InputError, match=r"own\.nc, line 14, column 1, T7: tool T7 is not among the tools there are: T1"
    ):
        plan(scene, tmp_path)
    (tmp_path / "own.nc").write_text(job.text.replace("M08", "M08 G41"), encoding="ascii")
    with pytest.raises(InputError, match=r"own\.nc, line 17, column 5, G41"):
        plan(scene, tmp_path)
    (tmp_path / "own.nc").unlink()
    with pytest.raises(InputError, match=r"own\.nc"):
        plan(scene, tmp_path)


def test_a_tool_too_thick_is_refused():
    scene = gear_scene()
    thick = scene.tools[0].model_copy(update={"diameter_mm": 16.0})
    with pytest.raises(InputError, match="tool of 16 mm"):
        plan(scene.model_copy(update={"tools": (thick,)}))


@pytest.mark.parametrize("name", ["spur-external", "helical-internal"])
def test_a_crowned_helix_is_cut_to_the_sagitta_of_the_levels(name, device):
    """Flutes lie on tangents of the crowning: from a level h below, 4 a (h / b)² stays at the top, never less."""
    amount, step = 5e-3, 0.5
    job = gear_job(name, "surface.modification.helix_crowning_um=5", f"toolpath.finishing.axial_step_mm={step}")
    found, _ = traces(job, device, one_space(job).blocks)
    left = 1e3 * 4.0 * amount * (step / job.gear.facewidth) ** 2 / cos(job.gear.base_helix_angle)
    for kind in (found.profile, found.helix):
        for side in SIDES:
            um = kind[side].from_design_um
            assert um.min() > -2e-3
            assert um.max() < left + 2e-3
    assert max(found.helix[side].from_design_um.max() for side in SIDES) > 0.5 * left


def test_a_relief_between_points_of_the_path_is_met_better_by_finer_steps(device):
    worst = []
    for step in (1.0, 0.5, 0.25):
        job = gear_job(
            "spur-external",
            f"toolpath.finishing.involute_step_mm={step}",
            "surface.modification.tip_relief.amount_um=10",
            "surface.modification.tip_relief.start_deg=20",
            "surface.modification.tip_relief.shape=parabolic",
        )
        found, _ = traces(job, device, one_space(job).blocks)
        worst.append(max(np.abs(found.profile[side].from_design_um).max() for side in SIDES))
    assert worst[0] < 0.7
    assert np.all(np.log2(np.array(worst[:-1]) / worst[1:]) > 1.3)


def test_a_linear_relief_is_exact_on_both_sides_of_its_kink(device):
    relief = ("amount_um=10", "start_deg=20", "shape=linear")
    job = gear_job("spur-external", *(f"surface.modification.tip_relief.{key}" for key in relief))
    found, _ = traces(job, device, one_space(job).blocks)
    for side in SIDES:
        off = np.abs(found.profile[side].from_design_um)
        assert np.median(off) < 1e-4
        assert off.max() < 0.02


def test_a_gear_beyond_the_standard_is_refused_before_it_is_cut():
    with pytest.raises(InputError, match="no tolerances for number of teeth"):
        gear_job("spur-external", "surface.teeth=3")
