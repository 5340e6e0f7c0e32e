import numpy as np
import pytest

from gearsim.cutters.catalogue import zhou_apt
from gearsim.machines.catalogue import head_head_cb
from gearsim.motion.nc_step import NCStep
from gearsim.programs.cldata import apt_parameters

WAYS = ("theoretical", "cl", "nc_tip", "nc_axes")
TEN = np.radians(10.0)


def make_step(name, pivot_length=200.0):
    """Zhou's worked examples (2015, section 4.1.3, figures 4.5 and 4.6)."""
    cutter, end, turned = {
        "apt": (zhou_apt(45.0, 10.0, 3.0, TEN, TEN), (50.0, 50.0, 10.0), (18.0, 18.0)),
        "flat": (zhou_apt(35.0, 15.0, 0.0, 0.0, 0.0), (60.0, 60.0, 10.0), (18.0, 27.0)),
    }[name]
    rotary = np.radians([(0.0, 0.0), turned])
    return NCStep(cutter, head_head_cb(pivot_length), np.array([(0.0, 0.0, 0.0), end]), rotary)


STEPS = ("apt", "flat")


def poses(step, t):
    return {way: getattr(step, way).pose(np.zeros(len(t), dtype=int), t, 0) for way in WAYS}


@pytest.mark.parametrize("name", STEPS)
def test_all_four_motions_pass_through_both_poses(name):
    step = make_step(name)
    b, c = step.rotary[1]
    end = [np.sin(b) * np.cos(c), np.sin(b) * np.sin(c), np.cos(b)]
    for pose in poses(step, np.array([0.0, 1.0])).values():
        assert np.allclose(pose.tip.value, step.tips, atol=1e-11)
        assert np.allclose(pose.axis.value, [[0, 0, 1], end], atol=1e-13)


@pytest.mark.parametrize("name", STEPS)
def test_only_linear_axes_leave_the_tips_line_by_the_pivots_detour(name):
    """The pivot runs straight, the tip hangs L below it: the difference is L times that of the axis to its chord."""
    t = np.linspace(0.0, 1.0, 11)
    step = make_step(name, 150.0)
    found = poses(step, t)
    for way in ("theoretical", "cl", "nc_tip"):
        assert np.allclose(found[way].tip.value, t[:, None] * step.tips[1], atol=1e-12)
    axis = found["nc_tip"].axis.value
    chord = (1 - t)[:, None] * axis[0] + t[:, None] * axis[-1]
    assert np.allclose(found["nc_axes"].axis.value, axis, atol=1e-13)
    assert np.allclose(found["nc_axes"].tip.value, t[:, None] * step.tips[1] + 150.0 * (chord - axis), atol=1e-10)


def test_the_cutters_are_zhous():
    """{H, R_l, R_t, psi_u, psi_l}: the corner's centre at R_l, tangent to both cones."""
    apt, flat = make_step("apt").cutter, make_step("flat").cutter
    d, r, e, f, lower, upper, height = apt_parameters(apt)
    ten = TEN
    assert (r, e, lower, upper, height) == pytest.approx((3.0, 10.0, 10.0, 10.0, 45.0))
    assert f * np.cos(ten) - e * np.sin(ten) == pytest.approx(3.0)  # from the corner's centre to the lower cone
    meet = np.array([d / 2, d / 2 * np.tan(ten)])
    side = np.array([np.cos(ten), -np.sin(ten)])
    assert (meet - [e, f]) @ side == pytest.approx(3.0)  # and to the upper cone
    assert apt_parameters(flat) == pytest.approx((30.0, 0.0, 15.0, 0.0, 0.0, 0.0, 35.0))
