from math import cos, pi, radians, sin, tan

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from gearsim.cutters.catalogue import apt, conical
from gearsim.errors import InputError


def test_conical_cutter_has_the_heights_and_radii_of_the_source():
    """Zhou 4.19 at table 4.1: h of the flank's first effective centre and its effective radius.

    |o_c q_f| = R1 tan a + R2 and rho = R1 sec a + R2 (the general machinery knows neither).
    """
    r1, r2, a = 1.0, 1.5, radians(15.0)
    cutter = conical(r1, r2, a, 25.0)
    p = cutter.elements[cutter.flank].at(np.array(0.0))
    rho = p.r / p.nr
    assert rho == pytest.approx(r1 / cos(a) + r2, abs=1e-12)
    assert p.z - rho * p.nz == pytest.approx(r1 * tan(a) + r2, abs=1e-12)


def test_the_corner_of_the_source_follows_the_repaired_formula():
    """Zhou 4.21 with its erratum: h(b) = R1 cot b + R2, rho(b) = R1 csc b + R2, b the normal's angle to -l."""
    r1, r2, a = 1.0, 1.5, radians(15.0)
    corner = conical(r1, r2, a, 25.0).elements[1]
    s = np.linspace(0.05, corner.length, 9)
    p = corner.at(s)
    b = np.arccos(-p.nz)
    rho = p.r / p.nr
    assert np.allclose(rho, r1 / np.sin(b) + r2, atol=1e-12)
    assert np.allclose(p.z - rho * p.nz, r1 / np.tan(b) + r2, atol=1e-12)
    printed = r1 / np.tan(b) + r2 * (1.0 - sin(a) + np.cos(b))
    assert np.abs(p.z - rho * p.nz - printed).max() > 0.9


@given(st.floats(0.0, 3.0), st.floats(0.0, 2.0), st.floats(-10.0, 40.0))
def test_every_admissible_family_keeps_rho_against_h(bottom, fillet, taper):
    """rho' = -cos(alpha) h' along the profile: the test of a family of effective spheres (errata)."""
    assume(bottom > 0.05 and fillet > 0.05 and bottom + fillet * 0.5 + 24.0 * tan(radians(taper)) > 0.1)
    cutter = conical(bottom, fillet, radians(taper), 25.0)
    for e in cutter.elements:
        if e.is_flat:
            continue
        s = np.linspace(0.2, 0.8, 5) * e.length
        d = 1e-5 * e.length
        rho = [p.r / p.nr for p in (e.at(s - d), e.at(s + d))]
        h = [p.z - p.r / p.nr * p.nz for p in (e.at(s - d), e.at(s + d))]
        assert np.allclose(rho[1] - rho[0], -e.at(s).nz * (h[1] - h[0]), atol=1e-9)


@pytest.mark.parametrize(
    ("parameters", "relation"),
    [
        ((-6.0, 1.0, 2.0, 1.0, 0.0, 0.0, 20.0), "diameter d"),
        ((6.0, -1.0, 2.0, 1.0, 0.0, 0.0, 20.0), "corner radius r"),
        ((6.0, 1.0, 2.0, 1.0, 0.0, 0.0, 0.5), "height h"),
        ((6.0, 1.0, 2.0, 1.4, 0.0, 0.0, 20.0), "f = 1.4 mm, 1 would be|f = 1.4 mm, 1 mm would be"),
        ((7.0, 1.0, 2.0, 1.0, 0.0, 0.0, 20.0), "d = 7 mm, 6 mm would be"),
        ((6.0, 1.0, 2.0, 1.0, 0.3 * pi, 0.3 * pi, 20.0), "alpha \\+ beta"),
        ((6.0, 0.0, 0.0, 0.0, 0.0, -0.4, 20.0), "meets the axis"),
    ],
)
def test_impossible_parameters_name_the_relation_that_fails(parameters, relation):
    with pytest.raises(InputError, match=relation):
        apt(*parameters)
