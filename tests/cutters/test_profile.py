from math import radians

import numpy as np
import pytest

from gearsim.cutters.catalogue import apt, conical
from gearsim.cutters.profile import Element, Profile
from gearsim.errors import InputError
from tests.helpers import conical_distance

CUTTERS = {
    "conical": conical(1.0, 1.5, radians(15.0), 25.0),
    "ball": apt(6.0, 3.0, 0.0, 3.0, 0.0, 0.0, 20.0),
    "flat": apt(8.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0),
    "bull": apt(10.0, 1.0, 4.0, 1.0, 0.0, 0.0, 15.0),
    "lower cone": apt(20.6, 0.0, 0.0, 0.0, radians(10.0), radians(5.0), 30.0),
}


@pytest.fixture(params=CUTTERS)
def cutter(request):
    return CUTTERS[request.param]


def test_the_chain_is_closed_and_its_normals_are_unit_and_outward(cutter):
    for e in cutter.elements:
        s = np.linspace(0.0, e.length, 7)
        p, q = e.at(s), e.at(s + 1e-6)
        assert np.allclose(p.nr**2 + p.nz**2, 1.0)
        assert np.allclose((q.r - p.r) / 1e-6, -p.nz, atol=1e-5)
        assert np.allclose((q.z - p.z) / 1e-6, p.nr, atol=1e-5)
        assert np.allclose((q.nr - p.nr) / 1e-6, -p.curvature * p.nz, atol=1e-5)
        middle = slice(1, -1)
        outside = cutter.signed_distance((p.r + 1e-3 * p.nr)[middle], (p.z + 1e-3 * p.nz)[middle])
        assert np.allclose(outside, 1e-3, atol=1e-9)
        assert np.all(cutter.signed_distance((p.r - 1e-3 * p.nr)[middle], (p.z - 1e-3 * p.nz)[middle]) < 0.0)
    assert cutter.elements[0].start == (0.0, 0.0)
    assert cutter.elements[-1].end == (0.0, cutter.height)


def test_signed_distance_is_that_of_the_nearest_boundary_point(cutter, rng):
    r, z = rng.uniform(0.0, 15.0, 300), rng.uniform(-4.0, 34.0, 300)
    boundary = [e.at(np.linspace(0.0, e.length, 20001)) for e in cutter.elements]
    br, bz = np.concatenate([p.r for p in boundary]), np.concatenate([p.z for p in boundary])
    brute = np.array([np.hypot(br - a, bz - b).min() for a, b in zip(r, z, strict=True)])
    assert np.allclose(np.abs(cutter.signed_distance(r, z)), brute, atol=2e-3)


def test_signed_distance_of_the_conical_cutter_has_its_closed_form(rng):
    r, z = rng.uniform(0.0, 12.0, 20000), rng.uniform(-3.0, 24.0, 20000)
    ours = CUTTERS["conical"].signed_distance(r, z)
    theirs = conical_distance(r, z, 1.0, 1.5, radians(15.0), 25.0)
    near = np.abs(theirs) < 0.5
    assert np.allclose(ours[near], theirs[near], atol=1e-12)


def test_signed_distance_is_1_lipschitz_and_convex_along_lines(cutter, rng):
    """A true signed distance of a convex set has both properties; a mere implicit function has not."""
    a, b = (np.column_stack([rng.uniform(0, 14, 400), rng.uniform(-4, 32, 400)]) for _ in range(2))
    fa, fb = (cutter.signed_distance(*p.T) for p in (a, b))
    assert np.all(np.abs(fa - fb) <= np.linalg.norm(a - b, axis=1) + 1e-12)
    for t in (0.25, 0.5, 0.75):
        assert np.all(cutter.signed_distance(*(a + t * (b - a)).T) <= (1 - t) * fa + t * fb + 1e-12)


def test_gradient_is_the_derivative_of_the_distance(cutter, rng):
    r, z, h = rng.uniform(0.1, 14.0, 2000), rng.uniform(-4.0, 32.0, 2000), 1e-6
    f, nr, nz = cutter.distance_gradient(r, z)
    dr = (cutter.signed_distance(r + h, z) - cutter.signed_distance(r - h, z)) / (2 * h)
    dz = (cutter.signed_distance(r, z + h) - cutter.signed_distance(r, z - h)) / (2 * h)
    smooth = f > 1e-3
    assert np.allclose(nr[smooth], dr[smooth], atol=1e-6)
    assert np.allclose(nz[smooth], dz[smooth], atol=1e-6)


def test_edges_are_where_the_normal_jumps():
    assert [len(CUTTERS[k].edges) for k in ("conical", "ball", "flat", "bull")] == [1, 1, 2, 1]


def test_a_chain_with_a_gap_or_a_dent_is_refused():
    line = Element((0.0, 0.0), (2.0, 0.0))
    with pytest.raises(InputError, match="gap"):
        Profile("broken", (line, Element((2.5, 0.0), (2.5, 9.0))))
    with pytest.raises(InputError, match="not convex"):
        Profile("dented", (line, Element((2.0, 0.0), (1.0, 4.0)), Element((1.0, 4.0), (3.0, 8.0))))
    with pytest.raises(InputError, match="no section"):
        CUTTERS["ball"].radius_at(99.0)
