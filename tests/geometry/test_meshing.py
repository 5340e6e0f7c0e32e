"""The theory of gearing against the closed form (`grazing`), which shares no formula with it, and differences."""

import numpy as np
import pytest

from gearsim.envelope.surface import pose_jet
from gearsim.errors import InputError
from gearsim.geometry import series
from gearsim.geometry.curves import darboux
from gearsim.geometry.grazing import MeridianPoints, PoseJet, grazing_points
from gearsim.geometry.meshing import (
    generated_curvature,
    meshing_angle,
    meshing_angle_newton,
    meshing_coefficients,
    meshing_lever,
    tool_point,
)
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.series import Series, stack, unit
from gearsim.motion.sources import CLMotion, CurveMotion

SECOND = np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])
FIRST = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])


def curve_motion():
    """A tip on a cubic and an axis that swings round: everything accelerates."""

    def curve(w, order):
        x = Series.variable(w, order)
        tip = stack([x * 40.0, x * x * 6.0 + x * 3.0, x * x * x * 4.0 - x * 5.0])
        return PoseSeries(tip, unit(stack([x * 0.4 + 0.1, x * x * 0.3 - 0.2, x * 0.1 + 1.0])))

    return CurveMotion(curve, -0.5, 0.5)


def cl_motion():
    """Straight tip, constant-rate axis."""
    axes = np.array([[0.0, 0.1, 1.0], [0.2, -0.1, 1.0], [0.3, 0.2, 1.0]])
    tips = np.array([[0.0, 0.0, 0.0], [9.0, 1.0, -1.0], [18.0, 3.0, 1.0]])
    return CLMotion(tips, axes / np.linalg.norm(axes, axis=1, keepdims=True))


def arc(s):
    """A barrel's flank: radius 60 about (-52, 12)."""
    angle = -0.1 + s / 60.0
    nr, nz = np.cos(angle), np.sin(angle)
    return MeridianPoints(-52.0 + 60.0 * nr, 12.0 + 60.0 * nz, nr, nz, np.full(s.shape, 1 / 60.0))


def cone(s, side=1.0):
    """A taper of 20 deg, from outside (+1) or as the inner side of a ring (-1)."""
    c, t = np.cos(0.35) * np.ones_like(s), np.sin(0.35) * np.ones_like(s)
    return MeridianPoints(20.0 + side * t * s, c * s, side * c, -t, 0.0 * s)


def sample(rng, motion, n=120):
    piece = rng.integers(0, motion.pieces, n)
    return piece, rng.uniform(0.1, 0.9, n), rng.uniform(2.0, 12.0, n)


CASES = [
    pytest.param(motion, meridian, id=f"{name}, {shape}")
    for name, motion in (("curve", curve_motion()), ("CL", cl_motion()))
    for shape, meridian in (("arc", arc), ("cone", cone), ("inner cone", lambda s: cone(s, -1.0)))
]


def tool_axes(pose):
    x = np.cross(pose.axis, [0.3, 1.0, 0.2])
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    return x, np.cross(pose.axis, x)


def solved(pose, meridian, branch):
    x, y = tool_axes(pose)
    theta = meshing_angle(*meshing_coefficients(pose, meridian, x, y), branch)
    return np.cos(theta)[:, None] * x + np.sin(theta)[:, None] * y


@pytest.mark.parametrize("branch", [1.0, -1.0])
@pytest.mark.parametrize(("motion", "meridian"), CASES)
def test_the_equation_of_meshing_finds_the_grazing_points(rng, motion, meridian, branch):
    piece, t, s = sample(rng, motion)
    pose, branches = pose_jet(motion, piece, t), np.full(t.shape, branch)
    g = grazing_points(pose, meridian(s), branches)
    assert g.exists.sum() > 60
    point, normal = tool_point(pose, meridian(s), solved(pose, meridian(s), branches))
    assert np.allclose(point[g.exists], g.point[g.exists], atol=1e-10)
    assert np.allclose(normal[g.exists], g.normal[g.exists], atol=1e-11)
    assert np.isnan(point[~g.exists]).all()


def test_coefficients_are_normal_times_velocity(rng):
    """At any angle, by differences of a point fixed in a turning tool (whose frame is carried along)."""
    motion = curve_motion()
    piece, t, s = sample(rng, motion)
    pose, meridian, theta = pose_jet(motion, piece, t), cone(s), rng.uniform(-3, 3, s.shape)
    x, y = tool_axes(pose)
    a, b, c = meshing_coefficients(pose, meridian, x, y)
    u = np.cos(theta)[:, None] * x + np.sin(theta)[:, None] * y
    _, normal = tool_point(pose, meridian, u)
    h = 1e-4
    moved = []
    for step in (h, -h):
        there = pose_jet(motion, piece, t + step)
        turn = np.cross(pose.axis, there.axis)  # carry u along by the shortest turn from axis to axis
        cosine = np.sum(pose.axis * there.axis, axis=1, keepdims=True)
        carried = cosine * u + np.cross(turn, u) + turn * np.sum(turn * u, axis=1, keepdims=True) / (1.0 + cosine)
        moved.append(tool_point(there, meridian, carried)[0])
    velocity = (moved[0] - moved[1]) / (2.0 * h)
    assert np.allclose(np.sum(normal * velocity, axis=1), a * np.cos(theta) + b * np.sin(theta) - c, atol=1e-5)


def test_newton_agrees_with_the_closed_form_and_says_when_it_fails(rng):
    motion = curve_motion()
    piece, t, s = sample(rng, motion)
    pose = pose_jet(motion, piece, t)
    coefficients = meshing_coefficients(pose, cone(s), *tool_axes(pose))
    exact = meshing_angle(*coefficients, np.ones(t.shape))
    found = meshing_angle_newton(*coefficients, start=float(np.mean(exact)))
    assert np.allclose(found, exact, atol=1e-12)
    with pytest.raises(InputError, match="start nearer"):
        meshing_angle_newton(np.ones(1), np.zeros(1), np.full(1, 2.0), start=1.0)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_lever_of_a_generatrix_is_linear_in_the_equation_of_meshing(rng, side):
    """Litvin 11: solve for s on a given generatrix; the point found grazes."""
    motion = curve_motion()
    piece, t, s = sample(rng, motion)
    pose, m = pose_jet(motion, piece, t), cone(s, side)
    u = solved(pose, m, np.ones(t.shape))
    lever = meshing_lever(pose, side * np.cos(0.35), -np.sin(0.35), u)
    assert np.allclose(lever, m.z * m.nr - m.r * m.nz, atol=1e-9)


@pytest.mark.parametrize("branch", [1.0, -1.0])
@pytest.mark.parametrize(("motion", "meridian"), CASES)
def test_generated_curvature_equals_the_envelope_s(rng, motion, meridian, branch):
    """Two systems of linear equations against the closed form's derivatives: K, H, k1, k2 and directions."""
    piece, t, s = sample(rng, motion)
    pose, branches = pose_jet(motion, piece, t), np.full(t.shape, branch)
    g = grazing_points(pose, meridian(s), branches)
    ok = g.exists
    ours, theirs = g.curvature(), generated_curvature(pose, meridian(s), solved(pose, meridian(s), branches))
    scale = np.maximum(np.abs(ours.k1), np.abs(ours.k2))
    ok &= scale < 1e3
    assert ok.sum() > 60
    for name in ("mean", "k1", "k2"):
        assert np.max((np.abs(getattr(ours, name) - getattr(theirs, name)) / scale)[ok]) < 1e-9, name
    assert np.max((np.abs(ours.gaussian - theirs.gaussian) / scale**2)[ok]) < 1e-9
    turn = np.linalg.norm(np.cross(ours.direction1, theirs.direction1), axis=1)
    assert np.max((turn * ours.spread / scale)[ok]) < 1e-8


@pytest.mark.parametrize(("motion", "meridian"), CASES)
def test_envelope_curvature_agrees_with_second_differences_of_points(rng, motion, meridian):
    """Closed-form points alone, eighth-order differences, away from edges of regression."""
    piece, t, s = sample(rng, motion)
    at = lambda dt, ds: grazing_points(pose_jet(motion, piece, t + dt), meridian(s + ds), np.ones(t.shape))
    g = at(0.0, 0.0)
    h = {"t": 0.01, "s": 0.2}
    steps = np.arange(-4, 5)

    def along(dt, ds, weights, order):
        return sum(w * at(k * dt * h["t"], k * ds * h["s"]).point for k, w in zip(steps, weights, strict=True))

    lines = {"t": along(1, 0, SECOND, 2), "s": along(0, 1, SECOND, 2), "both": along(1, 1, SECOND, 2)}
    rt, rs = along(1, 0, FIRST, 1), along(0, 1, FIRST, 1)
    normal = np.cross(rs, rt)
    normal *= -np.sign(np.sum(normal * g.normal, axis=1, keepdims=True))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    tt, ss, both = (np.sum(normal * lines[k], axis=1) for k in ("t", "s", "both"))
    second = np.array([[ss, 0.5 * (both - ss - tt)], [0.5 * (both - ss - tt), tt]])
    first = np.array([[np.sum(a * b, axis=1) for a in (rs, rt)] for b in (rs, rt)])
    shape = np.linalg.solve(np.moveaxis(first, -1, 0), np.moveaxis(second, -1, 0))
    # away from edges of regression: the surface is neither sharper than 1/1.5 mm nor its chart degenerate
    c = g.curvature()
    scale = np.maximum(np.abs(c.k1), np.abs(c.k2))
    slant = np.linalg.norm(np.cross(rs, rt), axis=1) / np.linalg.norm(rs, axis=1) / np.linalg.norm(rt, axis=1)
    ok = g.exists & np.isfinite(shape).all(axis=(1, 2)) & (scale < 1 / 1.5) & (slant > 0.2)
    ok[ok] &= np.linalg.norm(rt[ok], axis=1) / h["t"] > 1.0
    assert ok.sum() > 40
    k = np.sort(np.linalg.eigvals(shape[ok]).real, axis=1)
    worst = max(np.max(np.abs(k[:, 1] - c.k1[ok]) / scale[ok]), np.max(np.abs(k[:, 0] - c.k2[ok]) / scale[ok]))
    assert worst < 1e-8


def test_along_the_line_of_contact_both_surfaces_bend_and_twist_alike(rng):
    """Litvin, section 4: normal curvature and surface torsion of tool and generated surface are equal there."""
    motion = curve_motion()
    piece, t, s = sample(rng, motion)
    pose, m = pose_jet(motion, piece, t), cone(s)
    g = grazing_points(pose, m, np.ones(t.shape))
    ok = g.exists
    made = g.curvature()
    contact, normal = g.point_s, -g.normal  # at one pose: the line of contact; normal out of the gear
    radial = solved(pose, m, np.ones(t.shape))
    along = m.nr[:, None] * pose.axis - m.nz[:, None] * radial
    around = np.cross(pose.axis, radial)
    ds, dq = np.sum(contact * along, axis=1), np.sum(contact * around, axis=1)
    tool_rate = (dq * m.nr / m.r)[:, None] * around  # the cone's own dn
    tool = darboux(contact, 0.0 * contact, normal, -tool_rate)
    assert np.allclose((ds**2 + dq**2)[ok], np.sum(contact**2, axis=1)[ok])
    assert np.allclose(made.normal_curvature(contact)[ok], tool.normal_curvature[ok], atol=1e-10)
    assert np.allclose(made.geodesic_torsion(contact, normal)[ok], tool.geodesic_torsion[ok], atol=1e-10)


def test_a_cylinder_of_envelope_has_the_path_s_curvature():
    """Truth of geometry: a cylinder moved round a circle, axis parallel to the circle's, envelopes cylinders."""
    angle = np.linspace(0.0, 1.0, 5)
    c, s_, nil = np.cos(angle), np.sin(angle), np.zeros(5)
    out, around = np.stack([c, s_, nil], axis=1), np.stack([-s_, c, nil], axis=1)
    axis = np.tile([0.0, 0.0, 1.0], (5, 1))
    pose = PoseJet(10.0 * out, axis, 10.0 * around, 0.0 * axis, -10.0 * out, 0.0 * axis)
    one = np.ones(5)
    meridian = MeridianPoints(3.0 * one, nil, one, nil, nil)
    outer, inner = (generated_curvature(pose, meridian, sign * out) for sign in (1.0, -1.0))
    # outside: a groove of radius 13 whose material lies beyond, inside: a post of radius 7
    assert np.allclose([outer.k1, outer.k2], [[1 / 13.0] * 5, [0.0] * 5])
    assert np.allclose([inner.k1, inner.k2], [[0.0] * 5, [-1 / 7.0] * 5])


def test_a_cone_swinging_about_its_apex_generates_a_coaxial_cone():
    """Truth of geometry: its apex rests, its axis turns about z; K = 0, |k| = 1/(distance tan angle)."""
    beta, half, u = 1.0, 0.3, np.array([2.0, 5.0])

    def curve(w, order):
        x = Series.variable(w, order)
        turn = series.exp(x * 1j) * np.sin(beta)
        axis = stack([turn.real, turn.imag, x * 0.0 + np.cos(beta)])
        return PoseSeries(axis * 0.0, axis)

    pose = pose_jet(CurveMotion(curve, 0.0, 1.0), np.zeros(2, dtype=int), np.array([0.2, 0.7]))
    one = np.ones(2)
    m = MeridianPoints(u * np.sin(half), u * np.cos(half), one * np.cos(half), -one * np.sin(half), 0.0 * u)
    # contact on the generatrices in the plane of z and the tool's axis: farther from z and nearer to it
    z = np.array([0.0, 0.0, 1.0])
    up = z - pose.axis * pose.axis[:, 2:]
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    for radial, angle, sign in ((up, beta - half, -1.0), (-up, beta + half, 1.0)):
        c = generated_curvature(pose, m, radial)
        k = np.stack([c.k1, c.k2])
        assert np.allclose(c.gaussian, 0.0, atol=1e-14)
        assert np.allclose(np.sum(k, axis=0), sign * 1.0 / (u * np.tan(angle)))
