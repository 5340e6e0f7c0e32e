"""Root passes: the ball touches the intended root along every pass, ridges stay below what is allowed."""

from math import radians

import numpy as np
import pytest

from gearsim.cutters.catalogue import ball, bull, tapered_ball
from gearsim.errors import InputError
from gearsim.scene import load_scene
from gearsim.toolpaths.root import RootPlan
from tests.conftest import make_tooth

RIDGE = 0.004
ROOT_MILL = tapered_ball(1.78, radians(12.0), 25.0)
"""Its ball nearly fills the narrowest fillet."""


def teeth():
    scene, _ = load_scene("spiral-bevel-flank-conventional")
    return {"ruled": (make_tooth(), ROOT_MILL), "generated": (scene.tooth(), tapered_ball(2.8, radians(10.0), 25.0))}


@pytest.fixture(scope="module", params=["ruled", "generated"])
def plan(request):
    tooth, cutter = teeth()[request.param]
    return RootPlan(tooth, cutter, RIDGE, 3.0)


def test_the_ball_touches_the_root_along_every_pass(plan):
    """At the pass's own point: distance 0, the ball's normal the surface's, the contact on the ball itself."""
    length = np.linspace(0.0, 1.0, 5)
    for path in plan.paths[::4]:
        tip, axis = path.poses(length)
        jet = path.surface.jet(*path.surface.locate(length, np.full(5, path.height)))
        off = jet.r - tip
        z = np.sum(off * axis, axis=1)
        r = np.linalg.norm(off - z[:, None] * axis, axis=1)
        assert np.allclose(plan.cutter.signed_distance(r, z), 0.0, atol=1e-12)
        assert np.allclose(tip + plan.ball * axis - jet.r, plan.ball * jet.normal, atol=1e-12)
        assert (z <= plan.cutter.elements[0].end[1] + 1e-12).all()


def test_ridges_between_passes_stay_below_what_is_allowed(plan):
    """Brute force: the least distance of root points from the ball's centres on all passes."""
    length = np.linspace(-0.02, 1.02, 1041)
    centres = np.array([tip + plan.ball * axis for tip, axis in (p.poses(length) for p in plan.paths)])
    highest = []
    for surface in {p.surface.name: p.surface for p in plan.paths}.values():
        at = [g.ravel() for g in np.meshgrid([0.03, 0.5, 0.97], np.linspace(0.0, 1.0, 81))]
        points = surface.jet(*surface.locate(*at)).r
        near = [int(np.argmin(np.abs(length - x))) for x in at[0]]
        left = [
            np.linalg.norm(centres[:, max(0, k - 30) : k + 31] - p, axis=2).min() - plan.ball
            for p, k in zip(points, near, strict=True)
        ]
        assert min(left) > -1e-7
        highest.append(max(left))
    assert 0.7 * RIDGE < max(highest) <= RIDGE


def test_passes_lead_from_the_concave_wall_to_the_convex_one(plan):
    names = list(dict.fromkeys(p.surface.name for p in plan.paths))
    assert names == ["concave fillet", "bottom", "convex fillet"]
    middle = np.array([p.poses(np.array([0.5]))[0][0] for p in plan.paths])
    way = middle[-1] - middle[0]
    assert (np.diff(middle @ way) > 0.0).all()
    motion = plan.paths[0].cl_motion(9)
    assert len(motion.tips) == 9 + 2 * int(np.ceil(3.0 / (27.5 / 8)))


def test_fewer_passes_leave_higher_ridges():
    surface = RootPlan(make_tooth(), ROOT_MILL, 1.0, 3.0)._surfaces[0]
    passes = [RootPlan(make_tooth(), ROOT_MILL, ridge, 3.0)._density(*surface).sum() for ridge in (0.004, 0.016)]
    assert passes[0] == pytest.approx(2.0 * passes[1])


@pytest.mark.parametrize(
    ("cutter", "ridge", "told"),
    [
        (bull(1.6, 0.3, 25.0), RIDGE, "need a ball-ended cutter, 'bull-nose end mill' has none"),
        (ball(2.0, 25.0), RIDGE, r"ball of 1 mm does not fit the concave fillet, which bends with a radius of 0\.98"),
        (tapered_ball(1.6, radians(30.0), 25.0), RIDGE, "root cutter cuts .* um into the intended"),
        (ball(0.01, 25.0), 1e-7, "passes over the concave fillet; expected 1000 and fewer"),
    ],
)
def test_what_cannot_cut_the_root_is_refused(cutter, ridge, told):
    with pytest.raises(InputError, match=told):
        _ = RootPlan(make_tooth(), cutter, ridge, 3.0).paths
