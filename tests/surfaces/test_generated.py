"""Generated sheets: their derivatives, existence and undercut, on motions whose envelopes are known by hand."""

from dataclasses import replace

import numpy as np
import pytest

from gearsim.cutters.profile import Element
from gearsim.errors import InputError
from gearsim.geometry.pose import FrameSeries
from gearsim.geometry.series import Series, exp, stack
from gearsim.surfaces.rolled import RolledSurface
from tests.helpers import observed_order
from tests.surfaces.test_face_milled import ROLL, SETTINGS, make_face_milled


def circling(radius):
    """An upright tool whose axis runs round a circle about the origin, and which does not turn itself."""

    def poses(phi, order):
        turn = exp(Series.variable(phi, order) * 1j)
        nil = Series(np.zeros_like(turn.c.real))
        tip = stack([turn.real * radius, turn.imag * radius, nil])
        return FrameSeries(tip, stack([nil, nil, nil + 1.0]), stack([nil + 1.0, nil, nil]))

    return poses


def wall(radius, inside=False):
    """A cylindrical wall of a tool, or of a ring's bore."""
    low, high = (radius, 0.0), (radius, 5.0)
    return Element(high, low) if inside else Element(low, high)


U, V = np.array([0.0, 0.7, 2.0]), np.array([1.0, 2.0, 3.0])


@pytest.mark.parametrize(("path", "tool"), [(5.0, 2.0), (2.0, 5.0)])
@pytest.mark.parametrize("inside", [False, True])
def test_a_cylinder_on_a_circle_generates_two_cylinders(path, tool, inside):
    """Radii path + tool and |path - tool|; a solid tool's inner one is undercut where the tool is the larger.

    The distance of a point at radius a on the ray through the tool's axis is sqrt(a^2 + p^2 - 2 a p cos t) less
    the tool's radius, its second derivative by t there a p / |a - p| (the bore's is the opposite).
    """
    seen = {}
    for branch in (1.0, -1.0):
        sheet = RolledSurface(circling(path), circling(path), wall(tool, inside), branch)
        jet, phi = sheet.jet(U, V), sheet.pose_parameter(U, V)
        ray = np.sum(jet.r * np.column_stack([np.cos(phi), np.sin(phi), 0.0 * phi]), axis=1)
        seen[round(float(ray[0]), 9)] = jet
        assert np.allclose(ray, ray[0])
        assert np.allclose(jet.closing, (-1.0 if inside else 1.0) * ray * path / np.abs(ray - path))
        assert np.all(jet.undercut == (jet.closing < 0.0))
        kappa = np.max(np.abs([jet.curvature().k1, jet.curvature().k2]), axis=0)
        assert np.allclose(kappa, 1.0 / np.abs(ray))
    assert set(seen) == {path + tool, path - tool}


def test_there_is_no_envelope_where_the_tool_moves_too_steeply():
    """Straight up along its axis a cone sweeps no envelope; the jet says so with nan."""

    def poses(phi, order):
        t = Series.variable(phi, order)
        nil = Series(np.zeros_like(t.c))
        return FrameSeries(stack([t * 0.1, nil, t]), stack([nil, nil, nil + 1.0]), stack([nil + 1.0, nil, nil]))

    jet = RolledSurface(poses, poses, Element((1.0, 0.0), (2.0, 3.0)), 1.0).jet(U, V)
    assert not jet.exists.any()
    assert not jet.undercut.any()
    assert np.isnan(jet.r).all()


@pytest.fixture(scope="module", params=["generated", "modified roll", "formate"])
def patches(request):
    generator = replace(SETTINGS, modified_roll=ROLL) if request.param == "modified roll" else SETTINGS
    return make_face_milled(generator, request.param != "formate").patches


def test_derivatives_converge_with_second_order(patches):
    steps = np.array([8e-3, 4e-3, 2e-3])
    for patch in patches:
        u, v = patch.locate(np.array([0.3, 0.8]), np.array([0.4, 0.6]))
        exact = patch.jet(u, v)
        errors = {k: [] for k in ("ru", "rv", "normal_u", "normal_v")}
        for h in steps:
            for k, (a, b) in {"u": (h, 0.0), "v": (0.0, 10.0 * h)}.items():
                ahead, back = patch.jet(u + a, v + b), patch.jet(u - a, v - b)
                for name, value in ((f"r{k}", "r"), (f"normal_{k}", "normal")):
                    difference = (getattr(ahead, value) - getattr(back, value)) / (2.0 * (a + b))
                    errors[name].append(np.abs(difference - getattr(exact, name)).max())
        for k, e in errors.items():
            if max(e) > 1e-7:
                assert observed_order(e, steps) == pytest.approx(2.0, abs=0.15), (patch.name, k)


def second_differences(patch, u, v, h, k):
    """n.r_uu, n.r_uv, n.r_vv from positions alone, with Richardson's extrapolation; fourth order."""

    def at(h, k):
        p = lambda a, b: patch.jet(u + a * h, v + b * k).r
        middle = p(0, 0)
        return np.array([
            (p(1, 0) - 2 * middle + p(-1, 0)) / h**2,
            (p(1, 1) - p(1, -1) - p(-1, 1) + p(-1, -1)) / (4 * h * k),
            (p(0, 1) - 2 * middle + p(0, -1)) / k**2,
        ])  # fmt: skip

    n = patch.jet(u, v).normal
    return np.einsum("kij,ij->ki", (4.0 * at(0.5 * h, 0.5 * k) - at(h, k)) / 3.0, n)


def test_the_second_form_is_that_of_second_differences(patches):
    """Curvature to 1e-6 of the largest, from positions alone; tangents as known."""
    for patch in patches:
        u, v = patch.locate(np.array([0.2, 0.5, 0.9]), np.array([0.5, 0.4, 0.8]))
        jet = patch.jet(u, v)
        scale = np.array(
            [_dot(jet.ru, jet.ru), np.sqrt(_dot(jet.ru, jet.ru) * _dot(jet.rv, jet.rv)), _dot(jet.rv, jet.rv)]
        )
        gap = np.abs(second_differences(patch, u, v, 2e-3, 2e-2) - np.array(jet.second_form())) / scale
        largest = np.abs([jet.curvature().k1, jet.curvature().k2]).max()
        assert gap.max() < 1e-6 * max(largest, 1e-3), patch.name


def test_closing_is_the_second_derivative_of_the_distance(patches):
    """Of a fixed point to the head as it moves on, by differences of the profile's distance."""
    for patch in patches:
        tooth = patch.tooth
        if not tooth.generated:
            continue
        u, v = patch.locate(np.array([0.1, 0.5, 0.9]), np.array([0.3, 0.5, 0.7]))
        jet, h = patch.jet(u, v), 4e-4

        phi = patch.pose_parameter(u, v)

        def distance(phi, points=jet.r, tooth=tooth):
            tip, axis = (s.value for s in tooth.poses(phi, 0))
            z = _dot(points - tip, axis)
            r = np.linalg.norm(points - tip - z[:, None] * axis, axis=1)
            return tooth.head.signed_distance(r, z)

        second = (distance(phi + h) - 2.0 * distance(phi) + distance(phi - h)) / h**2
        assert np.allclose(distance(phi), 0.0, atol=1e-11)
        assert np.allclose(second, jet.closing, rtol=2e-3), patch.name


def test_curves_run_along_straight_elements_only():
    fillet, still = make_face_milled().fillet("convex"), Series(np.zeros((2, 1)))
    with pytest.raises(InputError, match="only straight elements lie along rules"):
        fillet.sheet.curve(still, still)


def _dot(a, b):
    return np.einsum("ij,ij->i", a, b)
