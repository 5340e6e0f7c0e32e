from math import radians

import numpy as np
import pytest

from gearsim.envelope.surface import pose_jet
from gearsim.errors import InputError
from gearsim.geometry.grazing import grazing_points
from gearsim.motion.sources import CurveMotion
from gearsim.surfaces.worm import GrindingCone, RuledWorm, screw_motion


def turned(v, angle):
    c, s = np.cos(angle), np.sin(angle)
    x, y, z = np.moveaxis(v, -1, 0)
    return np.stack([c * x - s * y, s * x + c * y, z], axis=-1)


SURFACES = [
    RuledWorm(radians(20.0), 0.125),
    RuledWorm(radians(15.0), -1.3, 2.0),
    RuledWorm.involute(radians(20.0), 0.4),
    GrindingCone(radians(30.0)),
]


@pytest.mark.parametrize("surface", SURFACES)
def test_jets_are_the_derivatives_of_the_points(surface, rng):
    """Eighth-order central differences of the points alone."""
    u, theta, h = rng.uniform(1.0, 4.0, 60), rng.uniform(-2.0, 2.0, 60), 0.05
    jet = surface.jet(u, theta)
    weights = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
    steps = h * np.arange(-4, 5)

    def along(name, du, dv):
        return (
            sum(w * getattr(surface.jet(u + s * du, theta + s * dv), name) for w, s in zip(weights, steps, strict=True))
            / h
        )

    for name, by, direction in [
        ("ru", "r", (1, 0)), ("rv", "r", (0, 1)), ("ruu", "ru", (1, 0)), ("ruv", "ru", (0, 1)),
        ("ruv", "rv", (1, 0)), ("rvv", "rv", (0, 1)),
    ]:  # fmt: skip
        assert np.allclose(getattr(jet, name), along(by, *direction), atol=1e-10), name


def test_the_thread_is_a_line_carried_by_a_screw(rng):
    worm = RuledWorm(radians(15.0), -1.3, 2.0)
    u, theta = rng.uniform(1.0, 4.0, 40), rng.uniform(-2.0, 2.0, 40)
    start = worm.jet(u, 0.0).r
    assert np.allclose(np.linalg.norm(start[:, :2], axis=1) ** 2, 4.0 + (u * np.cos(radians(15.0))) ** 2)
    assert np.allclose(worm.jet(u, theta).r, turned(start, theta) + (-1.3 * theta)[:, None] * np.eye(3)[2])


def test_normals_leave_the_thread():
    """A thread with positive pressure angle narrows outward: the normal rises and leans outward (Litvin 75)."""
    jet = RuledWorm(radians(20.0), 0.125).jet(np.array([1.2]), np.array([0.0]))
    assert jet.normal[0, 2] > 0.0
    assert jet.normal[0, 0] > 0.0


def test_only_the_involute_worm_is_developable(rng):
    u, theta = rng.uniform(1.0, 4.0, 40), rng.uniform(-2.0, 2.0, 40)
    assert np.allclose(RuledWorm.involute(radians(20.0), 0.4).jet(u, theta).curvature().gaussian, 0.0, atol=1e-14)
    assert np.all(RuledWorm(radians(20.0), 0.4).jet(u, theta).curvature().gaussian < -1e-4)


def test_involute_worm_is_involute_in_a_transverse_section():
    """In the plane z = 0 the section's normal touches the base circle of radius p cot alpha."""
    worm = RuledWorm.involute(radians(20.0), 0.4)
    base = 0.4 / np.tan(radians(20.0))
    u, theta = worm.parameters_at(np.linspace(1.05, 2.0, 30) * base, 0.0)
    jet = worm.jet(u, theta)
    assert np.allclose(jet.r[:, 2], 0.0, atol=1e-12)
    flat = jet.normal[:, :2] / np.linalg.norm(jet.normal[:, :2], axis=1, keepdims=True)
    assert np.allclose(np.abs(jet.r[:, 0] * flat[:, 1] - jet.r[:, 1] * flat[:, 0]), base)


def test_parameters_at_gives_radius_and_height(rng):
    worm = RuledWorm(radians(15.0), -1.3, 2.0)
    radius, height = rng.uniform(2.5, 6.0, 20), rng.uniform(-3.0, 3.0, 20)
    r = worm.jet(*worm.parameters_at(radius, height)).r
    assert np.allclose(np.hypot(r[:, 0], r[:, 1]), radius)
    assert np.allclose(r[:, 2], height)


def test_cone_normals_leave_the_wheel_and_fit_its_meridian(rng):
    cone = GrindingCone(radians(30.0))
    u = rng.uniform(1.0, 4.0, 20)
    jet, meridian = cone.jet(u, 0.0), cone.meridian(u)
    assert np.allclose(jet.r, np.stack([meridian.r, 0.0 * u, meridian.z], axis=1))
    assert np.allclose(jet.normal, np.stack([meridian.nr, 0.0 * u, meridian.nz], axis=1))
    c = jet.curvature()
    assert np.allclose(c.k1, 0.0, atol=1e-14)
    assert np.allclose(c.k2, -1.0 / (u * np.tan(radians(30.0))))


def test_a_cone_in_screw_motion_generates_a_screw_surface():
    """The ZK worm: its envelope is carried into itself, points, normals and curvatures."""
    cone, screw = GrindingCone(radians(30.0)), 1.5
    tip, axis = np.array([9.0, 0.5, 1.0]), np.array([-0.9, 0.1, 0.4])
    motion = CurveMotion(screw_motion(tip, axis / np.linalg.norm(axis), screw), -0.5, 0.5)
    u, ones = np.linspace(2.0, 4.0, 25), np.ones(25)
    here, there = (
        grazing_points(pose_jet(motion, np.zeros(25, dtype=int), t * ones), cone.meridian(u), ones) for t in (0.5, 0.8)
    )
    assert here.exists.all()
    assert np.allclose(there.point, turned(here.point, 0.3) + 0.3 * screw * np.eye(3)[2])
    assert np.allclose(there.normal, turned(here.normal, 0.3))
    assert np.allclose(there.curvature().gaussian, here.curvature().gaussian)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: RuledWorm(2.0, 1.0), "pressure angle"),
        (lambda: RuledWorm(0.3, 0.0), "screw"),
        (lambda: RuledWorm.involute(0.0, 1.0), "base radius"),
        (lambda: RuledWorm(0.3, 1.0, 2.0).parameters_at(2.0, 0.0), "offset"),
        (lambda: GrindingCone(0.0), "half angle"),
    ],
)
def test_impossible_input_names_the_relation(make, words):
    with pytest.raises(InputError, match=words):
        make()
