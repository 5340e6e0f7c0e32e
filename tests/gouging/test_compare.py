"""The comparison of tensors against Euler's formula at many directions; cases; invariance; degenerate contacts."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearsim.cutters.contact import end_mill_contact
from gearsim.geometry.jets import SurfaceJet
from gearsim.gouging.compare import Decision, compare, compare_contact
from gearsim.gouging.khan.cases import CASES, case_numbers
from gearsim.gouging.surface import surface_contacts
from gearsim.gouging.tensors import Tensor, principal_tensor

ALPHA = np.linspace(0.0, np.pi, 3601)
curvatures = st.floats(-0.5, 0.5)
angles = st.floats(0.0, np.pi)


def euler(high, low, alpha0, alpha=ALPHA):
    return high * np.cos(alpha - alpha0) ** 2 + low * np.sin(alpha - alpha0) ** 2


@given(curvatures, curvatures, curvatures, curvatures, angles)
def test_least_value_and_directions_are_those_of_eulers_formula(k1, k2, s1, s2, alpha0):
    f = compare(principal_tensor(max(k1, k2), min(k1, k2)), principal_tensor(max(s1, s2), min(s1, s2), alpha0))
    values = euler(max(k1, k2), min(k1, k2), 0.0) - euler(max(s1, s2), min(s1, s2), alpha0)
    assert np.allclose(f.at(ALPHA), values, atol=1e-13)
    assert f.least <= values.min() + 1e-13
    assert values.min() - f.least <= 2.0 * f.amplitude * (ALPHA[1] / 2.0) ** 2 + 1e-13
    if f.decision == Decision.GOUGES:
        start, end = f.interval
        inside = np.abs((ALPHA - f.worst + 0.5 * np.pi) % np.pi - 0.5 * np.pi) <= f.half_width + 1e-12
        clear = np.abs(values) > 1e-6
        assert np.array_equal(inside[clear], values[clear] < 0.0)
        assert end - start == pytest.approx(2.0 * f.half_width)
    else:
        assert np.isnan(f.interval[0])
        assert f.half_width == 0.0


def test_interval_ends_are_zeros_of_f():
    f = compare(principal_tensor(0.25, 0.0246), principal_tensor(0.0575, 0.0109, 1.3))
    assert np.allclose(f.at(np.array(f.interval)), 0.0, atol=1e-15)
    assert f.at(f.worst) == pytest.approx(float(f.least))


@given(curvatures, curvatures, curvatures, curvatures, angles)
def test_the_cases_say_what_the_directions_say(k1, k2, s1, s2, alpha0):
    t1, t2, p1, p2 = max(k1, k2), min(k1, k2), max(s1, s2), min(s1, s2)
    case = int(case_numbers(t1, t2, p1, p2))
    values = euler(t1, t2, 0.0) - euler(p1, p2, alpha0)
    if case in (1, 2):
        assert values.min() >= -1e-12
    elif case == 3:
        assert values.max() <= 1e-12
    elif case != 6 and min(abs(a - b) for a in (t1, t2) for b in (p1, p2)) > 1e-3:
        assert compare(principal_tensor(t1, t2), principal_tensor(p1, p2, alpha0)).decision == Decision.GOUGES


def test_every_interleaving_has_its_case_and_the_seventh_gouges():
    four = np.array([[4, 3, 2, 1], [2, 1, 4, 3], [3, 2, 4, 1], [4, 1, 3, 2], [4, 2, 3, 1], [3, 1, 4, 2]]) / 40.0
    assert list(case_numbers(*four.T)) == [2, 3, 4, 5, 6, 7]
    assert case_numbers(0.2, 0.1, -0.1, -0.2) == 1
    assert set(CASES) == set(range(1, 8))
    for alpha0 in np.radians([0.0, 30.0, 45.0, 90.0]):
        f = compare(principal_tensor(0.075, 0.025), principal_tensor(0.1, 0.05, alpha0))
        assert f.decision == Decision.GOUGES


def test_equal_radii_are_a_tie_and_planes_are_free():
    bowl = principal_tensor(0.1, 0.1, 0.7)
    theta = np.radians([0.0, 30.0, 89.0])
    assert np.all(compare_contact(end_mill_contact(10.0, 10.0, theta), bowl).decision == Decision.TIE)
    assert compare_contact(end_mill_contact(10.0 + 1e-5, 10.0 + 1e-5, 0.5), bowl).decision == Decision.GOUGES
    plane = principal_tensor(0.0, 0.0)
    assert np.all(compare_contact(end_mill_contact(10.0, [10.0, 2.0, 0.0], 0.5), plane).decision == Decision.FREE)
    assert compare_contact(end_mill_contact(10.0, 2.0, 0.0), plane).decision == Decision.TIE  # the disc lies on it
    assert compare_contact(end_mill_contact(10.0, 2.0, 0.5 * np.pi), plane).decision == Decision.TIE  # the shank


def test_at_umbilics_all_directions_gouge_or_none():
    contact = end_mill_contact(10.0, 10.0, 0.4)
    gouging = compare_contact(contact, principal_tensor(0.2, 0.2, 1.0))
    assert gouging.half_width == pytest.approx(0.5 * np.pi)
    assert compare_contact(contact, principal_tensor(0.05, 0.05, 1.0)).half_width == 0.0


def test_a_flat_end_mill_is_compared_along_its_rim():
    """Its circle against the level section of a sphere of 20 mm, where the axis leans 30 deg from the normal."""
    theta, sphere = np.radians(30.0), principal_tensor(0.05, 0.05)
    for radius, decision in ((9.999, Decision.FREE), (10.0, Decision.TIE), (10.001, Decision.GOUGES)):
        assert compare_contact(end_mill_contact(radius, 0.0, theta), sphere).decision == decision
    assert compare_contact(end_mill_contact(12.0, 0.0, theta), sphere).worst == pytest.approx(0.5 * np.pi)


def test_depth_is_half_the_difference_times_the_square_of_the_step():
    """A ball of 12 mm in a bowl of 10 mm: sagittas of the two circles."""
    f = compare_contact(end_mill_contact(12.0, 12.0, 0.3), principal_tensor(0.1, 0.1))
    step = 0.1
    exact = (10.0 - np.sqrt(100.0 - step**2)) - (12.0 - np.sqrt(144.0 - step**2))
    assert f.depth(step) == pytest.approx(exact, rel=1e-3)


@given(st.floats(0.0, 2.0 * np.pi), st.floats(0.0, 2.0 * np.pi), st.floats(-1.0, 1.0), st.floats(0.5, 2.0))
def test_turning_everything_or_the_parameters_changes_nothing(spin, turn, shear, stretch):
    """A patch with tensor diag and mixed part, tilted under the axis; rotations of space and of (u, v)."""
    a = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]) @ np.array(
        [[1.0, shear], [0.0, stretch]]
    )
    form = np.array([[0.03, 0.02], [0.02, -0.05]])

    def contacts(rotation, by):
        tangents = np.array([[1.0, 0.0, 0.4], [0.0, 1.0, -0.2]])
        normal = np.cross(*tangents) / np.linalg.norm(np.cross(*tangents))
        first, second = by.T @ tangents, by.T @ form @ by
        r = [x @ rotation.T for x in (first[0], first[1], second[0, 0] * normal, second[0, 1] * normal,
                                      second[1, 1] * normal)]  # fmt: skip
        jet = SurfaceJet(np.zeros((1, 3)), *(x[None] for x in r))
        return surface_contacts(jet, rotation @ np.array([0.0, 0.0, 1.0]))

    c, s = np.cos(spin), np.sin(spin)
    rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    plain, turned = contacts(np.eye(3), np.eye(2)), contacts(rotation, a)
    assert np.allclose(plain.theta, turned.theta)
    for x, y in zip((plain.part.a, plain.part.b, plain.part.c), (turned.part.a, turned.part.b, turned.part.c),
                    strict=True):  # fmt: skip
        assert np.allclose(x, y, atol=1e-12)


@given(curvatures, curvatures, angles)
def test_principal_values_come_back(k1, k2, alpha0):
    tensor = principal_tensor(max(k1, k2), min(k1, k2), alpha0)
    high, low, angle = tensor.principal()
    assert high == pytest.approx(max(k1, k2), abs=1e-15)
    assert low == pytest.approx(min(k1, k2), abs=1e-15)
    again = principal_tensor(high, low, angle)
    assert np.allclose([again.a, again.b, again.c], [tensor.a, tensor.b, tensor.c], atol=1e-14)


def test_tensors_are_indexed_like_arrays():
    tensor = Tensor(np.arange(3.0), np.arange(3.0), np.arange(3.0))
    assert np.array_equal(tensor[1:].c, [1.0, 2.0])
