from math import cos, radians, sin

import numpy as np
import pytest

from gearsim.cutters.catalogue import conical
from gearsim.errors import InputError
from gearsim.surfaces.patch import SIDES
from gearsim.surfaces.ruled_bevel import STRAIGHT
from gearsim.toolpaths.flank import FlankPath
from tests.conftest import make_tooth

PHI = np.linspace(-0.2, 0.2, 9)


@pytest.fixture(params=SIDES)
def path(request, tooth, fitting_cutter):
    return FlankPath(tooth, request.param, fitting_cutter, 8.0)


def section(path, phi, points):
    """(r, z) of points in the tool's meridian at the poses, and the tool's radial direction there."""
    pose = path.poses(phi, 0)
    q = points - pose.tip.value
    z = np.sum(q * pose.axis.value, axis=1)
    w = q - z[:, None] * pose.axis.value
    r = np.linalg.norm(w, axis=1)
    return r, z, w / r[:, None]


def contact(path):
    blank, spine = path.tooth.blank, path.tooth.spine(PHI, 0)
    h = 0.5 * (blank.whole_depth_at(spine.cone.value) + blank.clearance)
    return path.tooth.flank(path.side).jet(PHI, h)


def test_the_cutter_touches_the_tooth_at_the_contact_path(path):
    """Condition 1 of Zhou 4.2.2: point and normal coincide, at mid working depth."""
    jet = contact(path)
    r, z, u = section(path, PHI, jet.r)
    assert np.allclose(path.cutter.signed_distance(r, z), 0.0, atol=1e-12)
    _, nr, nz = path.cutter.distance_gradient(r, z)
    normal = nr[:, None] * u + nz[:, None] * path.poses(PHI, 0).axis.value
    assert np.allclose(normal, -jet.normal, atol=1e-12)


def test_the_axis_lies_in_the_plane_of_normal_and_rule(path):
    """Condition 2, and the taper between axis and rule."""
    jet, axis = contact(path), path.poses(PHI, 0).axis.value
    rule = jet.rv / np.linalg.norm(jet.rv, axis=1, keepdims=True)
    assert np.allclose(np.sum(axis * np.cross(jet.normal, rule), axis=1), 0.0, atol=1e-12)
    assert np.allclose(np.sum(axis * rule, axis=1), cos(radians(15.0)))
    assert np.allclose(np.sum(axis * jet.normal, axis=1), sin(radians(15.0)))


def test_the_flanks_begin_at_one_point(path):
    """Condition 3: the fillets' ends of tooth and cutter coincide."""
    start = path.tooth.flank(path.side).jet(PHI, np.full(9, path.tooth.fillet_height))
    r, z, _ = section(path, PHI, start.r)
    element = path.cutter.elements[path.cutter.flank]
    assert np.allclose(r, element.start[0], atol=1e-12)
    assert np.allclose(z, element.start[1], atol=1e-12)


def test_the_axis_stays_a_unit_vector_with_all_derivatives(path):
    axis = path.poses(PHI, 3).axis
    from gearsim.geometry import series

    length2 = series.dot(axis, axis)
    assert np.allclose(length2.c[0], 1.0)
    assert np.allclose(length2.c[1:], 0.0, atol=1e-10)


def test_the_path_runs_from_before_the_toe_to_behind_the_heel(path):
    blank, motion = path.tooth.blank, path.motion
    ends = path.tooth.spine(np.array([motion.start, motion.end]), 0).cone.value
    assert np.allclose(ends, [blank.toe - 8.0, blank.cone_distance + 8.0])


def test_cl_points_lie_on_the_path_with_equal_steps(path):
    cl = path.cl_motion(17)
    toe, heel = path.tooth.phi_at(np.array([path.tooth.blank.toe, path.tooth.blank.cone_distance]))
    on_face = path.poses(np.linspace(toe, heel, 17), 0).tip.value
    first = int(np.argmin(np.linalg.norm(cl.tips - on_face[0], axis=1)))
    assert np.allclose(cl.tips[first : first + 17], on_face, atol=1e-12)
    assert first >= 1
    assert len(cl.tips) > first + 17
    with pytest.raises(InputError, match="at least 2 points over the face, got 1"):
        path.cl_motion(1)


def test_only_a_cutter_that_destroys_the_next_tooth_is_refused(tooth, published_cutter):
    for side in SIDES:
        FlankPath(tooth, side, published_cutter, 8.0).check_passage()
        with pytest.raises(InputError, match="cannot pass between the tip edges: at cone distance"):
            FlankPath(tooth, side, conical(2.2, 1.5, radians(15.0), 25.0), 8.0).check_passage()


def test_a_straight_bevel_is_flank_milled_exactly(published_cutter):
    """Its flank is a plane: with every pose the cutter's straight side lies in it, all along."""
    tooth = make_tooth(spiral_angle=0.0, lengthwise_radius=STRAIGHT, tapered=True)
    for side in ("convex", "concave"):
        path = FlankPath(tooth, side, published_cutter, 2.0)
        flank = tooth.flank(side).jet(np.zeros(1), np.array([4.0]))
        pose = path.poses(np.linspace(path.motion.start, path.motion.end, 7), 0)
        start = published_cutter.elements[published_cutter.flank].at(np.array([0.0, 5.0]))
        axis = pose.axis.value
        out = flank.normal - np.sum(flank.normal * axis, axis=1)[:, None] * axis
        out /= -np.linalg.norm(out, axis=1)[:, None]
        for r, z in zip(start.r, start.z, strict=True):
            off = (pose.tip.value + z * axis + r * out - flank.r) @ flank.normal[0]
            assert np.abs(off).max() < 1e-12
