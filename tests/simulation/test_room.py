"""Jobs that need more memory than there is are refused with their size."""

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.geometry.rigid import Rigid
from gearsim.processes.run import estimate
from gearsim.scene import load_scene
from gearsim.simulation import room
from gearsim.simulation.dexels import DexelBox

STILL = Rigid(np.eye(3), np.zeros(3))


def box(pitch):
    return DexelBox(STILL, np.zeros(3), np.array([10.0, 20.0, 40.0]), pitch)


def test_a_box_takes_what_the_memory_holds_and_no_ray_more(monkeypatch):
    rays = (10 * 20 + 20 * 40 + 40 * 10) * 100  # at a pitch of 0.1 mm
    monkeypatch.setattr(room, "memory_bytes", lambda: float(room.RAY_BYTES * rays))
    assert box(0.1).counts.tolist() == [100, 200, 400]
    with pytest.raises(
        InputError, match=r"dexel pitch 0\.05 mm makes 5\.6e\+05 rays, .* raise simulation\.dexel_pitch_mm"
    ):
        box(0.05)


def test_a_pitch_that_would_overflow_is_refused():
    for pitch in (1e-9, 1e-300):
        with pytest.raises(InputError, match=r"is too fine: the box is 40 mm long; wanted is at least 0\.002 mm"):
            box(pitch)


def test_a_scene_that_does_not_fit_is_refused_before_it_is_cut(monkeypatch):
    monkeypatch.setattr(room, "memory_bytes", lambda: 1e6)
    scene, folder = load_scene("gouge-vertical-cylinder")
    with pytest.raises(InputError, match=r"scene gouge-vertical-cylinder makes .* this machine has 0\.001 GB: lower"):
        estimate(scene, folder)


def test_a_limit_of_the_process_counts():
    assert 0.0 < room.memory_bytes() <= float("inf")
