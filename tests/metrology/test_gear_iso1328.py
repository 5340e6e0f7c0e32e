from itertools import pairwise
from math import radians

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.metrology.iso1328 import (
    CLASSES,
    PARAMETERS,
    GearSize,
    achieved_class,
    rounded_um,
    tolerances_um,
    unrounded_um,
)

WORKED = GearSize(teeth=40, module=3.0, reference_diameter=120.0, face_width=30.0)
IN_SCOPE = dict(teeth=15, module=5.0, reference_diameter=75.0, face_width=10.0, helix_angle=0.0)

sizes = st.builds(
    GearSize, st.integers(5, 1000), st.floats(0.5, 70.0), st.floats(5.0, 15000.0), st.floats(4.0, 1200.0),
    st.floats(radians(-45.0), radians(45.0)),
)  # fmt: skip


def test_worked_value_class_6():
    printed = (8.9378, 28.8004, 7.5236, 9.4045, 12.0437, 9.1425, 10.227, 13.7178)
    assert tuple(unrounded_um(WORKED, 6)) == PARAMETERS
    assert list(unrounded_um(WORKED, 6).values()) == pytest.approx(printed, abs=6e-5)
    assert list(tolerances_um(WORKED, 6).values()) == [9.0, 29.0, 7.5, 9.5, 12.0, 9.0, 10.0, 14.0]


@pytest.mark.parametrize(
    ("value", "rounded"),
    [
        (12.49, 12.0), (10.4, 10.0), (7.3, 7.5), (7.2, 7.0), (4.96, 5.0), (4.94, 4.9),
        (10.5, 11.0), (12.5, 13.0), (7.25, 7.5), (6.75, 7.0), (4.95, 5.0), (0.25, 0.3), (1.15, 1.2),  # halves go up
        (5.0, 5.0), (10.0, 10.0), (9.76, 10.0), (10.001, 10.0), (5.2, 5.0), (0.04, 0.0),
    ],
)  # fmt: skip
def test_rounding(value, rounded):
    assert rounded_um(value) == rounded


@given(st.floats(0.0, 100.0), st.floats(0.0, 100.0))
def test_rounding_keeps_the_order(a, b):
    assert (rounded_um(a) <= rounded_um(b)) or a > b


@given(sizes)
def test_tolerances_grow_with_the_class_by_root_two(size):
    for name in PARAMETERS:
        values = [unrounded_um(size, c)[name] for c in CLASSES]
        assert all(b / a == pytest.approx(2.0**0.5) for a, b in pairwise(values))
        rounded = [tolerances_um(size, c)[name] for c in CLASSES]
        assert rounded == sorted(rounded)
        assert rounded[0] > 0.0


@given(sizes, st.sampled_from(PARAMETERS), st.floats(0.0, 3000.0))
def test_achieved_class_is_the_smallest_that_admits_the_value(size, name, value):
    found = achieved_class(size, name, -value)
    assert found == achieved_class(size, name, value)
    admitted = [c for c in CLASSES if value <= tolerances_um(size, c)[name]]
    assert found == (admitted[0] if admitted else None)


def test_achieved_class_at_its_edges():
    assert achieved_class(WORKED, "f_p", 0.0) == 1
    assert achieved_class(WORKED, "F_alpha", 12.0) == 6  # the rounded tolerance, not 12.0437
    assert achieved_class(WORKED, "F_alpha", 12.04) == 7
    assert achieved_class(WORKED, "F_alpha", 12.0437 * 2.0**2.5 + 1.0) is None
    assert achieved_class(WORKED, "F_alpha", float("nan")) is None


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("teeth", 4, r"number of teeth \|z\| = 4: its scope is 5 to 1000"),
        ("teeth", -1001, "= 1001"),
        ("reference_diameter", 4.9, "d = 4.9 mm: its scope is 5 to 15000 mm"),
        ("reference_diameter", 15001.0, "15001"),
        ("module", 0.49, "m_n = 0.49 mm: its scope is 0.5 to 70 mm"),
        ("module", 71.0, "71"),
        ("face_width", 3.9, "b = 3.9 mm: its scope is 4 to 1200 mm"),
        ("face_width", float("nan"), "nan"),
        ("helix_angle", radians(-46.0), "46 deg: its scope is 0 to 45 deg"),
    ],
)
def test_outside_the_scope_it_refuses(name, value, message):
    GearSize(**IN_SCOPE)
    with pytest.raises(InputError, match=message):
        GearSize(**IN_SCOPE | {name: value})


def test_the_scope_includes_its_limits():
    GearSize(5, 0.5, 5.0, 4.0, radians(45.0))
    GearSize(-1000, 70.0, 15000.0, 1200.0, radians(-45.0))


@pytest.mark.parametrize("gear_class", [0, 12, -5])
def test_a_class_that_does_not_exist_is_refused(gear_class):
    with pytest.raises(InputError, match="classes 1 to 11"):
        tolerances_um(WORKED, gear_class)
