"""The root as a surface: on the outline, its derivatives by differences, its normals out of the material."""

from math import radians

import numpy as np
import pytest

from gearsim.surfaces.cylindrical_gear import CylindricalGear
from gearsim.surfaces.finished_gear import FinishedGear
from gearsim.surfaces.gear_outline import GearOutline
from gearsim.surfaces.gear_root import GearRoot
from gearsim.surfaces.part import Tolerance

CASES = [(15, 0.0, 1.9), (15, 0.2, 1.9), (15, 0.0, 0.0), (50, 0.3, 1.0), (-30, 0.17, 1.5)]


@pytest.fixture(params=CASES, ids=str)
def root(request):
    teeth, helix, fillet = request.param
    return GearRoot(GearOutline(CylindricalGear.from_transverse(teeth, 5.0, radians(20.0), helix, 10.0), fillet))


def samples(root):
    """Off the joints of the pieces, on both sides of the middle."""
    height = np.array([0.013, 0.11, 0.21, 0.33, 0.52, 0.68, 0.83, 0.93, 0.987])
    return root.locate(np.linspace(0.1, 0.9, 9), height)


def test_it_lies_on_the_outline_and_its_normals_lead_out(root):
    jet = root.jet(*samples(root))
    whole = FinishedGear(root.outline, 0.0, *[Tolerance.both(1.0)] * 3)
    for off in (-1e-3, 0.0, 1e-3):
        distance, face = whole.by_face(jet.r + off * jet.normal)
        assert distance == pytest.approx(np.full(9, off), abs=1e-12 if off == 0.0 else 1e-6)
        assert (face == 2).all()
    assert np.linalg.norm(jet.normal, axis=-1) == pytest.approx(np.ones(9))


def test_derivatives_are_those_of_differences(root):
    u, v = samples(root)
    jet, h = root.jet(u, v), 1e-5
    right, left, up, down = root.jet(u + h, v), root.jet(u - h, v), root.jet(u, v + h), root.jet(u, v - h)
    for found, expected in (
        (jet.ru, (right.r - left.r) / (2 * h)), (jet.rv, (up.r - down.r) / (2 * h)),
        (jet.ruu, (right.ru - left.ru) / (2 * h)), (jet.ruv, (up.ru - down.ru) / (2 * h)),
        (jet.rvv, (up.rv - down.rv) / (2 * h)),
    ):  # fmt: skip
        assert found == pytest.approx(expected, abs=1e-8)
    for tangent in (jet.ru, jet.rv):
        assert np.einsum("ij,ij->i", jet.normal, tangent) == pytest.approx(np.zeros(9), abs=1e-12)
