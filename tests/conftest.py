"""Fixtures shared by the rooms' tests: devices, the worked example, small helpers."""

from __future__ import annotations

import os
from math import radians

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # tests keep all cores busy: its threads would wait for each other

import numpy as np
import pytest
import warp as wp

from gearsim.cutters.catalogue import conical
from gearsim.simulation.removal import prepare
from gearsim.surfaces.blank import BevelBlank, outer_cone_distance, pitch_angle
from gearsim.surfaces.ruled_bevel import RuledBevelTooth


def _devices():
    """``cpu`` always, every CUDA device where present, otherwise one skipped parameter with the reason."""
    prepare("cpu")
    cuda = [str(d) for d in wp.get_cuda_devices()]
    skipped = pytest.param("cuda:0", marks=pytest.mark.skip(reason="no CUDA device on this machine"))
    return ["cpu", *(cuda or [skipped])]


@pytest.fixture(params=_devices())
def device(request):
    return request.param


@pytest.fixture
def rng():
    return np.random.default_rng(20150803)


def make_tooth(hand="left", **changes):
    """Zhou's gear (tables 3.3 and 3.7) as a slot; ``changes`` replace fields of the tooth."""
    pitch = pitch_angle(33, 9, radians(90.0))
    blank = BevelBlank(
        33, pitch, outer_cone_distance(4.8338, 33, pitch), 27.5, 1.76, 7.67, radians(76.1167), radians(69.5833),
        0.8732, 8.0,
    )  # fmt: skip
    values = {
        "blank": blank,
        "spiral_angle": radians(32.0),
        "hand": hand,
        "lengthwise_radius": 63.5,
        "bottom_half_width": 1.0,
        "fillet_radius": 1.5,
        "pressure_angle": radians(22.0),
    }
    return RuledBevelTooth(**{**values, **changes})


@pytest.fixture(scope="session")
def tooth():
    return make_tooth()


@pytest.fixture(scope="session")
def published_cutter():
    """Zhou's table 4.1."""
    return conical(1.0, 1.5, radians(15.0), 25.0)


@pytest.fixture(scope="session")
def fitting_cutter():
    """The cutter of the scene spiral-bevel-flank."""
    return conical(1.04, 0.8, radians(15.0), 25.0)


def random_rotation(rng):
    """A random proper rotation matrix."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    q[:, 0] *= np.linalg.det(q)
    return q
