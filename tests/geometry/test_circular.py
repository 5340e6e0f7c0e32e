"""Envelopes of tube, canal and revolved surfaces under a screw with a wobble, against brute force."""

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.geometry.circular import CircularSeries, MovingFrame, canal, circular_grazing, revolution, tube
from gearsim.geometry.grazing import MeridianPoints, PoseJet, grazing_points
from gearsim.geometry.jets import SurfaceJet
from gearsim.geometry.series import Series
from tests.helpers import observed_order

SCREW, WOBBLE, PITCH = 1.1, 0.35, 9.0


def rotation(axis, angle):
    """Rodrigues' formula, shape (n, 3, 3)."""
    k = np.cross(np.eye(3), np.asarray(axis, dtype=float)).T
    angle = np.asarray(angle)[:, None, None]
    return np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * (k @ k)


def pose(t):
    """A screw about z after a turn about an oblique axis: origin (n, 3) and rotation (n, 3, 3)."""
    turn = rotation([0.0, 0.0, 1.0], SCREW * t) @ rotation([0.6, 0.8, 0.0], WOBBLE * t)
    arm = np.array([14.0, 3.0, 0.0])
    return rotation([0.0, 0.0, 1.0], SCREW * t) @ arm + PITCH * t[:, None] * [0.0, 0.0, 1.0], turn


def frame(t):
    """The same pose as series: derivatives from the angular velocities, by hand."""
    z, k = (np.cross(np.eye(3), np.array(a)).T for a in ([0.0, 0.0, 1.0], [0.6, 0.8, 0.0]))
    origin, r = pose(t)
    a, b = rotation([0.0, 0.0, 1.0], SCREW * t), rotation([0.6, 0.8, 0.0], WOBBLE * t)
    r1 = SCREW * z @ r + a @ (WOBBLE * k @ b)
    r2 = SCREW**2 * z @ z @ r + 2.0 * SCREW * WOBBLE * z @ a @ k @ b + a @ (WOBBLE**2 * k @ k @ b)
    flat = origin * [1.0, 1.0, 0.0]
    o1 = SCREW * flat @ z.T + np.array([0.0, 0.0, PITCH])
    o2 = SCREW**2 * flat @ z.T @ z.T
    return MovingFrame(Series(np.stack([origin, o1, 0.5 * o2])), Series(np.stack([r, r1, 0.5 * r2])))


def spine(h, order=0):
    """A space curve with curvature and torsion, as a series."""
    x = Series.variable(h, order)
    c = np.stack([(x * 6.0).c, (x * x * 2.0 + x * 0.5).c, (x * x * x * 1.5 - x * x).c], axis=-1)
    return Series(c)


def swelling(h, order=0):
    x = Series.variable(h, order)
    return 2.0 + x * 0.7 - x * x * x * 0.4


SURFACES = {
    "tube": (tube(spine, 1.7), lambda h: np.full(np.shape(h), 1.7)),
    "canal": (canal(spine, swelling), lambda h: swelling(h).value),
}


@pytest.fixture(params=SURFACES)
def surface(request):
    return SURFACES[request.param]


def grid(n=14):
    h, t = (a.ravel() for a in np.meshgrid(np.linspace(-0.85, 0.85, n), np.linspace(0.1, 0.9, n)))
    return np.tile(h, 2), np.tile(t, 2), np.repeat([1.0, -1.0], n * n)


def test_a_grazing_point_is_on_its_circle_and_moves_along_the_surface(surface):
    family, radius = surface
    h, t, branch = grid()
    g = circular_grazing(family, h, frame(t), branch)
    ok = g.exists
    assert ok.mean() > 0.4
    origin, turn = pose(t)
    at = family(h, 1)
    local = np.einsum("nji,nj->ni", turn, g.point - origin)
    out = np.einsum("nji,nj->ni", turn, g.normal)
    assert np.allclose((local - at.centre.value)[ok], (radius(h)[:, None] * out)[ok], atol=1e-12)
    assert np.allclose(np.sum(out * at.normal.value, axis=1)[ok], at.cosine.value[ok], atol=1e-12)
    d = 1e-5
    ends = [np.einsum("nij,nj->ni", r, local) + o for o, r in (pose(t + d), pose(t - d))]
    velocity = (ends[0] - ends[1]) / (2.0 * d)
    assert np.abs(np.sum(velocity * g.normal, axis=1)[ok]).max() < 1e-8
    assert np.all(np.isnan(g.point[~ok]))


@pytest.mark.parametrize("name", ["point", "normal"])
def test_derivatives_converge_with_fourth_order(surface, name):
    """Central differences of fourth order, so that round-off stays far below."""
    family, _ = surface
    h, t, branch = grid()
    exact = circular_grazing(family, h, frame(t), branch)
    steps = [0.02, 0.01, 0.005]
    for by in ("s", "t"):
        errors = []
        for d in steps:
            f = [
                getattr(circular_grazing(family, h + (by == "s") * k * d, frame(t + (by == "t") * k * d), branch), name)
                for k in (-2, -1, 1, 2)
            ]
            difference = (f[0] - 8.0 * f[1] + 8.0 * f[2] - f[3]) / (12.0 * d)
            errors.append(np.nanmedian(np.linalg.norm(difference - getattr(exact, f"{name}_{by}"), axis=1)))
        assert errors[-1] < 1e-6
        assert observed_order(errors, steps) == pytest.approx(4.0, abs=0.2)


def test_the_printed_derivative_by_h_misses_the_turning_of_the_circles(surface):
    """n.T = cos alpha gives n_h.T = (cos alpha)' - n.T'; without dT/dh (Zhou 2.43) it would be (cos alpha)'."""
    family, _ = surface
    h, t, branch = grid()
    g, at, turn = circular_grazing(family, h, frame(t), branch), family(h, 1), pose(t)[1]
    normal, normal_h = (np.einsum("nji,nj->ni", turn, v) for v in (g.normal, g.normal_s))
    printed = at.cosine.c[1]
    right = printed - np.sum(normal * at.normal.c[1], axis=1)
    ours = np.sum(normal_h * at.normal.value, axis=1)
    assert np.nanmax(np.abs(ours - right)) < 1e-12
    assert np.nanmax(np.abs(ours - printed)) > 0.1


def test_curvature_agrees_with_second_differences_of_the_points(surface):
    """The second fundamental form from points and normals alone, wherever the envelope is regular."""
    family, _ = surface
    h, t, branch = grid()
    d = 2e-3

    def point(dh, dt):
        return circular_grazing(family, h + dh, frame(t + dt), branch).point

    g = circular_grazing(family, h, frame(t), branch)
    hh = (point(d, 0) - 2 * g.point + point(-d, 0)) / d**2
    tt = (point(0, d) - 2 * g.point + point(0, -d)) / d**2
    ht = (point(d, d) - point(d, -d) - point(-d, d) + point(-d, -d)) / (4 * d**2)
    c, brute = g.curvature(), SurfaceJet(g.point, g.point_s, g.point_t, hh, ht, tt)
    outward = np.sign(np.sum(brute.normal * -g.normal, axis=1))
    regular = g.exists & np.isfinite(ht[:, 0]) & (np.abs(c.k1) < 1.5) & (np.abs(c.k2) < 1.5)
    assert regular.sum() > 60
    mean = outward * brute.curvature().mean
    assert np.median(np.abs(mean - c.mean)[regular]) < 1e-4
    assert np.quantile(np.abs(mean - c.mean)[regular], 0.9) < 1e-2


def least_distance(radius, points, t):
    """Least |p - q(h, t)| - rho(h) over h in [-1, 1] and t in [0, 1]: grids that close in on the least value."""

    def distance(h, t):
        origin, turn = pose(t.ravel())
        q = (np.einsum("nij,nj->ni", turn, spine(h.ravel()).value) + origin).reshape(*h.shape, 3)
        return np.linalg.norm(points[:, None] - q, axis=-1) - radius(h)

    n = len(points)
    h, t = (a.ravel() for a in np.meshgrid(np.linspace(-1, 1, 61), np.linspace(0, 1, 61)))
    f = distance(np.tile(h, (1, 1)), np.tile(t, (1, 1)))
    best, width = np.argmin(f, axis=1), np.array([2.0, 1.0]) / 60
    bh, bt = h[best], t[best]
    offset = np.stack([a.ravel() for a in np.meshgrid(np.linspace(-1, 1, 7), np.linspace(-1, 1, 7))])
    for _ in range(22):
        gh = np.clip(bh[:, None] + width[0] * offset[0], -1.0, 1.0)
        gt = np.clip(bt[:, None] + width[1] * offset[1], 0.0, 1.0)
        f = distance(gh, gt)
        k = np.argmin(f, axis=1)
        bh, bt, width = gh[np.arange(n), k], gt[np.arange(n), k], 0.5 * width
    return f[np.arange(n), k]


def test_brute_force_over_the_whole_motion(surface):
    """No n.v: the spheres' least distance is zero at a claimed point that no other pose cuts, +-1 um beside it."""
    family, radius = surface
    h, t, branch = grid(10)
    g = circular_grazing(family, h, frame(t), branch)
    ok = np.flatnonzero(g.exists)
    at = least_distance(radius, g.point[ok], t[ok])
    assert at.max() < 1e-9
    standing = ok[at > -1e-9]
    assert len(standing) > 25
    for step in (1e-3, -1e-3):
        beside = least_distance(radius, g.point[standing] + step * g.normal[standing], t[standing])
        assert np.allclose(beside, step, atol=1e-5)


def arc(s):
    angle = -0.8 + s / 2.0
    nr, nz = np.cos(angle), np.sin(angle)
    return MeridianPoints(3.0 + 2.0 * nr, 2.0 + 2.0 * nz, nr, nz, np.full(np.shape(s), 0.5))


def cone(s):
    one = np.ones(np.shape(s))
    return MeridianPoints(2.0 + 0.3 * s, s * np.sqrt(1 - 0.09), np.sqrt(1 - 0.09) * one, -0.3 * one, 0.0 * s)


def bore(s):
    """A ring-shaped tool's inside: the normal points to the axis, the effective radius is negative."""
    p = cone(s)
    return MeridianPoints(p.r, p.z, -p.nr, -p.nz, p.curvature)


@pytest.mark.parametrize("meridian", [arc, cone, bore])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_revolved_surface_gives_exactly_what_the_meridian_gives(meridian, sign):
    s, t = (a.ravel() for a in np.meshgrid(np.linspace(0.1, 2.9, 12), np.linspace(0.0, 1.0, 12)))
    branch = np.full(len(s), sign)
    f = frame(t)
    ours = circular_grazing(revolution(meridian), s, f, branch)
    jets = [x for o, r in zip(f.origin.derivatives(), f.rotation.derivatives(), strict=True) for x in (o, r[..., 2])]
    theirs = grazing_points(PoseJet(*jets), meridian(s), branch)
    assert theirs.exists.any()
    assert np.array_equal(ours.exists, theirs.exists)
    for name in ("point", "normal", "point_s", "point_t", "normal_s", "normal_t"):
        a, b = getattr(ours, name)[ours.exists], getattr(theirs, name)[ours.exists]
        size = np.maximum(1.0, np.abs(b).max(axis=1, keepdims=True))
        assert np.abs((a - b) / size).max() < 1e-10, name


def test_a_tube_that_moves_along_its_circles_normal_or_not_at_all_has_no_grazing_point():
    n = 5
    h, still = np.linspace(-0.5, 0.5, n), np.zeros((n, 3))
    turn = Series(np.stack([np.tile(np.eye(3), (n, 1, 1))] + 2 * [np.zeros((n, 3, 3))]))
    straight = tube(lambda h, order: Series(np.stack([Series.variable(h, order).c] * 3, axis=-1)), 1.0)
    for velocity, expected in (((2.0, 2.0, 2.0), False), ((0.0, 0.0, 0.0), False), ((1.0, 0.0, 0.0), True)):
        f = MovingFrame(Series(np.stack([still, np.tile(velocity, (n, 1)), still])), turn)
        with np.errstate(all="raise"):
            g = circular_grazing(straight, h, f, np.ones(n))
        assert np.all(g.exists == expected)
        assert np.all(np.isnan(g.point[~g.exists]))


def test_what_is_no_specific_circular_surface_is_refused_with_the_relation():
    h, t = np.linspace(-0.5, 0.5, 4), np.linspace(0.0, 1.0, 4)

    def changed(**fields):
        return lambda h, order: SURFACES["canal"][0](h, order)._replace(**fields)

    good = SURFACES["canal"][0](h, 1)
    tilted = CircularSeries(*good)._replace(normal=Series(np.roll(good.normal.c, 1, axis=-1)))
    for family, relation in (
        (changed(cosine=good.cosine + 0.01), r"rho' = -cos\(alpha\) q'.T fails at h = -0.5"),
        (changed(radius=good.radius * 1.01), "rho'"),
        (lambda h, order: tilted, "q' x T = 0"),
        (changed(normal=good.normal * 2.0), r"\|T\| = 1"),
        (changed(cosine=good.cosine * 0.0 + 1.0), "cos alpha"),
        (canal(spine, lambda h, order: Series.variable(h, order) * 50.0 + 99.0), r"\|rho'\| < \|q'\|"),
        (revolution(lambda s: MeridianPoints(s + 1.0, 0 * s, 0 * s, 0 * s - 1.0, 0 * s)), "effective radius"),
    ):
        with pytest.raises(InputError, match=relation):
            circular_grazing(family, h, frame(t), np.ones(4))
    with pytest.raises(InputError, match="must be positive"):
        tube(spine, 0.0)
