from dataclasses import replace
from math import cos, pi, radians, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.geometry import series
from gearsim.geometry.series import Series
from gearsim.machines.generator import CradleGenerator

ZHOU = CradleGenerator(64.3718, radians(-56.78), radians(69.59), 1.0323, sliding_base=-0.2071)
HYPOID = CradleGenerator(
    71.0, radians(61.0), radians(-3.0), 3.2, radians(18.0), radians(-31.0), 14.0, 33.0, -1.2, (0.03, -0.02, 0.01, 0.04)
)
PHI = np.linspace(-0.4, 0.35, 7)


def moved(x, y, z):
    return np.block([[np.eye(3), np.array([[x], [y], [z]])], [np.zeros((1, 3)), np.ones((1, 1))]])


def turned(axis, angle):
    c, s = cos(angle), sin(angle)
    m = np.eye(4)
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    m[i, i], m[i, j], m[j, i], m[j, j] = c, -s, s, c
    return m


def roll(g, phi):
    return g.ratio_of_roll * (phi - sum(k * phi ** (i + 2) for i, k in enumerate(g.modified_roll)))


def chain(g, phi):
    """Zhou's M_bg (A.1) as a product of 4 x 4 matrices, with Litvin and Chen's swivel and tilt."""
    return (
        turned("z", -roll(g, phi))
        @ moved(0, 0, -g.machine_centre_to_back)
        @ turned("y", -(pi / 2 - g.machine_root_angle))
        @ moved(0, g.blank_offset, -g.sliding_base)
        @ turned("z", phi)
        @ moved(g.radial_distance * cos(g.cradle_angle), g.radial_distance * sin(g.cradle_angle), 0)
        @ turned("z", g.cradle_angle + g.swivel + pi / 2)
        @ turned("y", g.tilt)
    )


@pytest.mark.parametrize("g", [ZHOU, HYPOID])
def test_poses_follow_the_chain_of_matrices(g):
    frame = g.frames(PHI, 0)
    for i, phi in enumerate(PHI):
        m = chain(g, phi)
        assert np.allclose(frame.tip.value[i], m[:3, 3], atol=1e-12)
        assert np.allclose(frame.axis.value[i], -m[:3, 2], atol=1e-12)
        assert np.allclose(frame.radial.value[i], m[:3, 0], atol=1e-12)


def published(g, phi):
    """Columns 3 and 4 of M_bg with first and second derivatives: Zhou A.2 to A.4 and 3.3, typed out.

    3.13 and 3.15 print dM for dM/dphi.
    """
    C, D, E, F = (*g.modified_roll, 0.0, 0.0, 0.0, 0.0)[:4]
    m, b = g.ratio_of_roll, roll(g, phi)
    b1 = m * (1 - 2 * C * phi - 3 * D * phi**2 - 4 * E * phi**3 - 5 * F * phi**4)
    b2 = m * (-2 * C - 6 * D * phi - 12 * E * phi**2 - 20 * F * phi**3)
    cb, sb, cg, sg = np.cos(b), np.sin(b), cos(g.machine_root_angle), sin(g.machine_root_angle)
    n1 = g.radial_distance * np.cos(g.cradle_angle + phi)
    n2 = g.radial_distance * np.sin(g.cradle_angle + phi)
    n3 = g.blank_offset * sb + g.sliding_base * cb * cg
    n4 = g.blank_offset * cb - g.sliding_base * sb * cg
    m14 = n1 * cb * sg + n2 * sb + n3
    m24 = -n1 * sb * sg + n2 * cb + n4
    m34 = n1 * cg - g.sliding_base * sg - g.machine_centre_to_back
    axis = [
        [-cb * cg, sb * cg, sg + 0 * phi],
        [sb * cg * b1, cb * cg * b1, 0 * phi],
        [cb * cg * b1**2 + sb * cg * b2, -sb * cg * b1**2 + cb * cg * b2, 0 * phi],
    ]
    tip = [
        [m14, m24, m34],
        [
            n2 * cb * (b1 - sg) + n1 * sb * (1 - sg * b1) + n4 * b1,
            n2 * sb * (sg - b1) + n1 * cb * (1 - sg * b1) - n3 * b1,
            -n2 * cg,
        ],
        [
            m24 * b2 - m14 * b1**2 + 2 * (n1 * cb + n2 * sb * sg) * b1 - m14 + n3,
            -m14 * b2 - m24 * b1**2 + 2 * (-n1 * sb + n2 * cb * sg) * b1 - m24 + n4,
            -n1 * cg,
        ],
    ]
    return np.moveaxis(np.array(tip), 1, -1), np.moveaxis(np.array(axis), 1, -1)


@pytest.mark.parametrize("changes", [{}, {"modified_roll": (0.05, -0.1, 0.2, 0.3), "blank_offset": 0.7}])
def test_derivatives_are_those_of_appendix_a(changes):
    """With modified roll as well: A.3 and A.4 hold as printed."""
    g = replace(ZHOU, machine_centre_to_back=0.4, **changes)
    tip, axis = published(g, PHI)
    ours = g.poses(PHI, 2)
    assert np.allclose(np.array(ours.tip.derivatives()), tip, atol=1e-11)
    assert np.allclose(np.array(ours.axis.derivatives()), -axis, atol=1e-12)


def test_all_derivatives_agree_with_the_taylor_expansion():
    """A series of order 9 evaluated 0.05 rad further on is the motion there."""
    here, there = HYPOID.frames(PHI, 9), HYPOID.frames(PHI + 0.05, 0)
    for a, b in zip(here, there, strict=True):
        assert np.allclose(np.einsum("k,kij->ij", 0.05 ** np.arange(10), a.c), b.value, atol=1e-9)


@given(
    st.floats(-1.2, 1.2), st.floats(-1.5, 1.5), st.floats(-3, 3), st.floats(-40, 40), st.floats(-4, 4),
    st.floats(-0.3, 0.3),
)  # fmt: skip
@settings(max_examples=50, deadline=None)
def test_the_frame_stays_orthonormal_and_mirrors(tilt, root, swivel, offset, ratio, roll2):
    g = CradleGenerator(80.0, 0.9, root, ratio, tilt, swivel, 3.0, offset, 2.0, (roll2, 0.1, -0.05))
    f = g.frames(PHI, 3)
    for a, b, value in ((f.axis, f.axis, 1.0), (f.radial, f.radial, 1.0), (f.axis, f.radial, 0.0)):
        c = series.dot(a, b).c
        assert np.allclose(c[0], value, atol=1e-13)
        assert np.allclose(c[1:], 0.0, atol=1e-9)
    image = g.other_hand().frames(-PHI, 0)
    for a, b in zip(f, image, strict=True):
        assert np.allclose(a.value * [1, -1, 1], b.value, atol=1e-11)


def test_the_tip_plane_of_an_untilted_head_touches_the_root_cone():
    """Through the point x of the machine the plane contains the cone's ruling, its normal the cone's."""
    g = ZHOU
    pose = g.poses(np.zeros(1), 0)
    ruling = np.array([sin(g.machine_root_angle), 0.0, cos(g.machine_root_angle)])
    apex = np.array([0.0, 0.0, -0.2071 / -sin(g.machine_root_angle)])
    for along in (0.0, 50.0, 80.0):
        assert (apex + along * ruling - pose.tip.value[0]) @ pose.axis.value[0] == pytest.approx(0.0, abs=1e-12)


def test_the_plunge_runs_along_the_axis_to_the_generators_rest_pose():
    pose = HYPOID.plunge(np.array([0.0, 3.0]), 2)
    rest = HYPOID.poses(np.zeros(2), 0)
    assert np.allclose(pose.tip.value - rest.tip.value, [[0.0], [3.0]] * rest.axis.value)
    assert np.allclose(pose.tip.derivative().value, rest.axis.value)
    assert np.allclose(pose.axis.value, rest.axis.value)
    assert not pose.axis.c[1:].any()
    assert not pose.tip.c[2:].any()


def test_modified_roll_is_the_polynomial():
    phi = Series.variable(PHI, 2)
    assert np.allclose(HYPOID.work_angle(phi).value, roll(HYPOID, PHI))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"radial_distance": -1.0}, "radial distance -1 mm must not be negative"),
        ({"machine_root_angle": 69.59}, "machine root angle 3987.2. deg must lie"),
        ({"tilt": 2.0}, "tilt 114.592 deg must lie between"),
    ],
)
def test_impossible_settings_are_refused(changes, message):
    with pytest.raises(InputError, match=message):
        replace(ZHOU, **changes)
