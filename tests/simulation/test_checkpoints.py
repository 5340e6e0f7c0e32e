"""Runs that are killed go on from the operation that was done last, and end with the same bits."""

from dataclasses import replace

import numpy as np
import pytest

from gearsim.cutters.end_mills import ball, flat
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.solid import Block
from gearsim.motion.sources import CLMotion
from gearsim.simulation import checkpoints, sequence
from gearsim.simulation.checkpoints import Checkpoints
from gearsim.simulation.operation import operation
from gearsim.simulation.sequence import Machining, machine, whole_box
from gearsim.simulation.stock import blank_stock
from gearsim.simulation.workshop import Workshop

BLOCK = Block(np.zeros(3), np.array([30.0, 20.0, 10.0]))


def line(name, cutter, *tips, rapid=False):
    motion = CLMotion(np.array(tips, dtype=float), np.tile([0.0, 0.0, 1.0], (len(tips), 1)))
    return operation(name, cutter, [motion], 1e-9, rapid=[rapid])


WORK = (
    line("slot", flat(4.0, 30.0), (-5, 6, 5), (35, 6, 5)),
    line("rapid", flat(4.0, 30.0), (-5, 12, 6), (35, 12, 6), rapid=True),
    line("groove", ball(3.0, 30.0), (15, -5, 4), (15, 25, 4)),
)
ASKED = Machining(BLOCK, whole_box(BLOCK, 0.8), WORK)


def bits(machined):
    names = ("first", "lo", "hi", "lo_segment", "hi_segment")
    columns = [getattr(k, n) for k in machined.stock.left for n in names]
    touches = [w.touch and (w.touch.row, w.touch.place.tolist(), w.touch.depth) for w in machined.work]
    told = [(w.volume.tolist(), w.left, touch) for w, touch in zip(machined.work, touches, strict=True)]
    return [c.tolist() for c in columns], told, machined.blank_volumes


class Killed(Exception):
    """As kill -9 ends a process: nothing is tidied up."""


@pytest.mark.parametrize("done", [0, 1, 2])
def test_a_killed_run_loses_the_operation_under_way_alone(done, tmp_path, monkeypatch):
    whole = bits(machine(ASKED, Workshop("cpu")))
    assert whole[1][1][2] is not None
    begun = []

    def until(stock, operations, workshop):
        begun.extend(o.name for o in operations)
        if [o.name for o in operations] == [WORK[done].name]:
            raise Killed
        return real(stock, operations, workshop)

    real = sequence.cut_stock
    monkeypatch.setattr(sequence, "cut_stock", until)
    with pytest.raises(Killed):
        machine(ASKED, Workshop("cpu", checkpoints=tmp_path))
    monkeypatch.setattr(sequence, "cut_stock", lambda *a: begun.extend(o.name for o in a[1]) or real(*a))
    begun.clear()
    again = machine(ASKED, Workshop("cpu", checkpoints=tmp_path))
    assert begun == [o.name for o in WORK[done:]]
    assert bits(again) == whole


@pytest.mark.parametrize("file", ["look", "stock"])
def test_a_kill_while_an_operation_s_files_are_written_leaves_those_of_the_one_before(file, tmp_path, monkeypatch):
    def until(stock, path, job):
        if path.name.startswith(file) and len(stock.done) == 3:
            raise Killed
        real(stock, path, job)

    real = checkpoints.save_stock
    monkeypatch.setattr(checkpoints, "save_stock", until)
    with pytest.raises(Killed):
        machine(ASKED, Workshop("cpu", checkpoints=tmp_path))
    blank = blank_stock(ASKED.box, BLOCK)
    kept = Checkpoints(tmp_path, blank, Workshop("cpu").tolerance, WORK).last()
    assert [d.name for d in kept.stock.done] == ["slot", "rapid"]


def test_what_another_job_kept_is_not_taken(tmp_path):
    machine(ASKED, Workshop("cpu", checkpoints=tmp_path))
    other = Machining(BLOCK, ASKED.box, (WORK[2], *WORK[1:]))
    assert bits(machine(other, Workshop("cpu", checkpoints=tmp_path))) == bits(machine(other, Workshop("cpu")))


def test_files_that_were_cut_off_are_not_taken(tmp_path):
    whole = bits(machine(ASKED, Workshop("cpu", checkpoints=tmp_path)))
    for file in sorted(tmp_path.iterdir()):
        kept = file.read_bytes()
        file.write_bytes(kept[: len(kept) // 2])
        assert bits(machine(ASKED, Workshop("cpu", checkpoints=tmp_path))) == whole


def test_the_same_work_on_a_blank_turned_about_is_another_job(tmp_path):
    """Its rays' ends are the same numbers; only the frame tells them apart."""
    machine(ASKED, Workshop("cpu", checkpoints=tmp_path))
    frames = [Rigid(np.diag([sign, sign, 1.0]), np.zeros(3)) for sign in (1.0, -1.0)]
    blank = blank_stock(ASKED.box, BLOCK)
    jobs = [Checkpoints(tmp_path, replace(blank, box=replace(ASKED.box, frame=f)), 1e-9, WORK) for f in frames]
    assert [job.last() is not None for job in jobs] == [True, False]
