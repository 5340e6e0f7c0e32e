from pathlib import Path

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.motion.program import cutting
from gearsim.motion.sources import MovedMotion
from gearsim.processes.flank_milling import plan
from gearsim.processes.flank_program import machine_program
from gearsim.processes.frames import CLAMPED
from gearsim.programs.cldata import RAPID, parse_cl
from gearsim.programs.gcode import read_program
from gearsim.scene import load_scene


@pytest.fixture(scope="module")
def scene():
    return load_scene("spiral-bevel-flank", ("toolpath.points=33",))[0]


@pytest.fixture(scope="module")
def job(scene):
    return plan(scene, Path())


def feed_motion(scene, text):
    """The program's feeds as the machine runs them, in the gear frame."""
    blocks = read_program(text, scene.program.controlled()).blocks
    return MovedMotion(cutting(blocks), CLAMPED.inverse()), blocks


def test_the_machine_runs_the_cl_data(scene, job):
    """Tip to the printed decimals, axis to them and to what turning two rotary axes linearly costs."""
    motion, _ = feed_motion(scene, job.files["program.nc"])
    cl = job.variant("program").motions()
    assert len(cl) == sum(p.name != RAPID for p in parse_cl(job.files["toolpath.cl"]).paths)
    assert motion.pieces == sum(source.pieces for source in cl)
    t = np.array([0.0, 0.4, 1.0])
    first = 0
    for source in cl:
        piece = np.repeat(np.arange(source.pieces), 3)
        ours, theirs = (s.pose(piece + i, np.tile(t, source.pieces), 0) for s, i in ((motion, first), (source, 0)))
        assert np.abs(ours.tip.value - theirs.tip.value).max() < 0.6e-4
        assert np.abs(ours.axis.value - theirs.axis.value).max() < 2e-5
        first += source.pieces


def test_the_teeth_look_up_and_the_feed_is_kept(scene, job):
    motion, blocks = feed_motion(scene, job.files["program.nc"])
    assert (motion.pose(np.arange(motion.pieces), np.zeros(motion.pieces), 0).axis.value[:, 2] < 0.0).all()
    assert (blocks.machine.forward(blocks.values)[1][:, 2] > 0.5).all()
    seconds = blocks.seconds[~blocks.rapid]
    ends = (motion.pose(np.arange(motion.pieces), np.full(motion.pieces, t), 0) for t in (0.0, 1.0))
    (tip, axis), (to, top) = ((p.tip.value, p.axis.value) for p in ends)
    for up in (0.0, job.variant("program").cutter.height):
        speed = 60.0 * np.linalg.norm(to + up * top - tip - up * axis, axis=1) / seconds
        assert speed.max() < scene.toolpath.feed_mm_min * 1.001


def test_the_header_tells_gear_machine_and_cutter(job):
    head = job.files["program.nc"].split("G21")[0]
    assert head.isascii()
    assert "O0001 (SPIRAL-BEVEL-FLANK)" in head
    assert "(GEAR ON ITS BACK: X, -Y, -Z OF THE GEAR FRAME, ORIGIN AT THE PITCH APEX)" in head
    assert "(MACHINE TABLE-TABLE-BC, AXES X Y Z B C)" in head
    assert "4 FLUTES" in head


def test_a_scene_without_the_table_writes_none_and_cl_data_needs_a_feed(scene, job):
    assert "program.nc" not in plan(scene.model_copy(update={"program": None}), Path()).files
    cl = parse_cl("FROM/0,0,0\nGOTO/1,0,0\n")
    with pytest.raises(InputError, match="no FEDRAT"):
        machine_program(scene, scene.program, cl, [job.variant("program").cutter])
    assert parse_cl("FEDRAT/300\nGOTO/0,0,0\nFEDRAT/200\nGOTO/1,0,0\nFEDRAT/250\n").feed == 200.0


def test_values_that_no_control_takes_are_refused_with_the_scene():
    with pytest.raises(InputError, match="work_offset"):
        load_scene("spiral-bevel-flank", ("program.work_offset='G53'",))
