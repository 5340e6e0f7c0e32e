import re
from math import radians

import numpy as np
import pytest

from gearsim.cutters.catalogue import apt, conical
from gearsim.cutters.profile import Element, Profile
from gearsim.errors import InputError
from tests.cutters.shapes import every_shape
from tests.helpers import conical_distance

CUTTERS = {
    "conical": conical(1.0, 1.5, radians(15.0), 25.0),
    "ball": apt(6.0, 3.0, 0.0, 3.0, 0.0, 0.0, 20.0),
    "flat": apt(8.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0),
    "bull": apt(10.0, 1.0, 4.0, 1.0, 0.0, 0.0, 15.0),
    "lower cone": apt(20.6, 0.0, 0.0, 0.0, radians(10.0), radians(5.0), 30.0),
}
SHAPES = every_shape()


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


def test_edges_of_rings_and_undercut_tools_leave_reentrant_corners_out():
    assert {k: SHAPES[k].edges for k in SHAPES} == {
        "barrel": (0, 1),
        "spindle": (),
        "lollipop": (1,),
        "T-slot": (0, 1, 3),
        "dovetail": (0, 1, 3),
        "double": (0, 3, 4),
        "ring": (2, 3),
        "sharp ring": (0, 1, 2, 3),
    }


def outline(cutter, n=1001):
    """The meridian as a polygon, shape (n, 2); arcs by chords that are off by less than 1e-5 mm."""
    points = [e.at(np.linspace(0.0, e.length, n if e.is_arc else 2)) for e in cutter.elements]
    return np.column_stack([np.concatenate([getattr(p, k) for p in points]) for k in ("r", "z")])


def polygon_distance(polygon, r, z, axis_too):
    """Distance of points to the sides of a polygon, without the closing one along the axis."""
    a, b = polygon[: None if axis_too else -1], np.roll(polygon, -1, axis=0)[: None if axis_too else -1]
    p, way = np.stack([r, z], axis=1)[:, None], b - a
    share = np.sum((p - a) * way, axis=2) / np.maximum(np.sum(way * way, axis=1), 1e-300)
    return np.linalg.norm(p - a - np.clip(share, 0.0, 1.0)[..., None] * way, axis=2).min(axis=1)


def even_odd(polygon, r, z):
    """Whether points lie in a closed polygon, by counting crossings of a line to the right."""
    (a, b), (c, d) = polygon.T, np.roll(polygon, -1, axis=0).T
    inside = np.empty(len(r), dtype=bool)
    for i, (x, y) in enumerate(zip(r, z, strict=True)):
        spans = (b > y) != (d > y)
        at = a[spans] + (y - b[spans]) / (d[spans] - b[spans]) * (c[spans] - a[spans])
        inside[i] = np.count_nonzero(at > x) % 2 == 1
    return inside


@pytest.mark.parametrize("name", SHAPES)
def test_signed_distance_of_every_shape_is_that_of_a_dense_outline(name, rng):
    cutter = SHAPES[name]
    low_r, high_r, low_z, high_z = cutter.box
    r, z = rng.uniform(max(low_r - 3.0, 0.0), high_r + 3.0, 1500), rng.uniform(low_z - 3.0, high_z + 3.0, 1500)
    polygon = outline(cutter)
    f, nr, nz = cutter.distance_gradient(r, z)
    brute = polygon_distance(polygon, r, z, cutter.is_ring)
    assert np.allclose(np.abs(f), brute, atol=1e-5)
    clear = brute > 1e-4
    assert np.array_equal((f < 0.0)[clear], even_odd(polygon, r, z)[clear])
    h = 1e-6
    dr = (cutter.signed_distance(r + h, z) - cutter.signed_distance(r - h, z)) / (2 * h)
    dz = (cutter.signed_distance(r, z + h) - cutter.signed_distance(r, z - h)) / (2 * h)
    smooth = np.hypot(nr - dr, nz - dz) < 1e-5
    assert np.mean(smooth) > 0.99  # the rest sits on the medial axis
    assert np.allclose(np.hypot(nr, nz), 1.0)


@pytest.mark.parametrize("name", SHAPES)
def test_box_and_radii_enclose_the_outline_tightly(name):
    cutter = SHAPES[name]
    polygon = outline(cutter)
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    assert np.allclose(cutter.box, [low[0], high[0], low[1], high[1]], atol=1e-6)
    assert (cutter.min_radius, cutter.max_radius, cutter.height) == (cutter.box[0], cutter.box[1], cutter.box[3])
    assert cutter.reach >= np.hypot(*polygon.T).max() - 1e-12
    for z in np.linspace(0.01, 0.99, 9) * cutter.height:
        outside = np.linspace(cutter.radius_at(z), 30.0, 50)
        assert np.all(cutter.signed_distance(outside, z)[1:] > 0.0)
        assert cutter.signed_distance(outside, z)[0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("name", ["lollipop", "T-slot", "dovetail", "double"])
def test_parts_are_convex_overlap_and_unite_to_the_tool(name, rng):
    cutter = SHAPES[name]
    assert not cutter.is_convex
    assert not cutter.is_ring
    assert all(part.is_convex for part in cutter.parts)
    r, z = rng.uniform(0.0, 12.0, 4000), rng.uniform(-2.0, cutter.height + 2.0, 4000)
    whole = cutter.signed_distance(r, z)
    parts = np.array([part.signed_distance(r, z) for part in cutter.parts])
    outside = whole > 0.0
    assert np.allclose(parts.min(axis=0)[outside], whole[outside], atol=1e-12)
    assert np.all(parts.min(axis=0)[~outside] <= 1e-12)
    for below, above in zip(cutter.parts, cutter.parts[1:], strict=False):
        assert below.box[3] - above.box[2] > 0.5  # mm of common height


def test_convex_tools_and_rings_are_their_own_part():
    for name in ("barrel", "spindle", "ring", "sharp ring"):
        assert SHAPES[name].parts == (SHAPES[name],)
    assert SHAPES["barrel"].is_convex
    assert [SHAPES[k].is_ring for k in ("barrel", "ring", "sharp ring")] == [False, True, True]


def ring_with(*points):
    return tuple(Element(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True))


BAD = {
    "the profile has a gap": (Element((0.0, 0.0), (2.0, 0.0)), Element((2.5, 0.0), (2.5, 9.0))),
    "must close (a ring) or run from axis to axis": (Element((0.0, 0.0), (2.0, 0.0)), Element((2.0, 0.0), (2.0, 9.0))),
    "the profile is empty": (),
    "is empty": (Element((0.0, 0.0), (0.0, 0.0)),),
    "runs the wrong way round": ring_with((5.0, 0.0), (5.0, 4.0), (8.0, 4.0), (8.0, 0.0)),
    "crosses itself": ring_with((5.0, 0.0), (9.0, 4.0), (9.0, 0.0), (5.0, 5.0)),
    "a ring is not convex": ring_with((5.0, 0.0), (8.0, 0.0), (6.0, 2.0), (8.0, 4.0), (5.0, 4.0)),
    "r < 0 lies beyond the axis": ring_with((5.0, 0.0), (8.0, 0.0), (8.0, 4.0), (-1.0, 4.0)),
    "a concave arc is not supported": (
        Element((0.0, 0.0), (6.0, 0.0)),
        Element((6.0, 0.0), (3.0, 3.0), (6.0, 3.0), 3.0),
        Element((3.0, 3.0), (3.0, 9.0)),
        Element((3.0, 9.0), (0.0, 9.0)),
    ),
    "an end lies 1 mm off the arc": (
        Element((0.0, 0.0), (3.0, 3.0), (0.0, 3.0), 4.0),
        Element((3.0, 3.0), (3.0, 9.0)),
        Element((3.0, 9.0), (0.0, 9.0)),
    ),
    "falls towards the tip": (
        Element((0.0, 1.0), (3.0, 0.0)),
        Element((3.0, 0.0), (3.0, 9.0)),
        Element((3.0, 9.0), (0.0, 9.0)),
    ),
}  # fmt: skip


@pytest.mark.parametrize("message", BAD)
def test_what_no_cutter_can_be_is_refused_with_the_reason(message):
    with pytest.raises(InputError, match=re.escape(message)):
        Profile("broken", BAD[message])


def test_no_section_beyond_the_ends():
    with pytest.raises(InputError, match="no section"):
        CUTTERS["ball"].radius_at(99.0)


def test_nearest_points_lie_on_the_profile_at_the_distance_told(rng):
    cutter = conical(1.0, 1.5, radians(15.0), 25.0)
    r, z = rng.uniform(0.0, 12.0, 500), rng.uniform(-4.0, 30.0, 500)
    element, s = cutter.nearest(r, z)
    at = cutter.at(element, s)
    assert np.allclose(np.hypot(at.r - r, at.z - z), np.abs(cutter.signed_distance(r, z)), atol=1e-12)
    lengths = np.array([e.length for e in cutter.elements])[element]
    assert np.all((s >= 0.0) & (s <= lengths))
