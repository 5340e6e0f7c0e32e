"""Every error of a machine's axes against what a hand finds for one pose, in closed form or by 4 x 4 matrices."""

from math import cos, exp, pi, sin

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.geometry.series import Series
from gearsim.machines.catalogue import MACHINES, head_b_table_c, star, table_table_bc
from gearsim.machines.errors import Growth, MachineErrors, RealMachine, RotaryErrors, SlideErrors, Squareness
from tests.machines.matrices import about, shift

PIVOT = (3.0, -2.0, -90.0)
MACHINE = table_table_bc(PIVOT)
X, Y, Z = 310.0, -120.0, 85.0
UM, URAD = 1e-3, 1e-6


def pose(errors, machine=MACHINE, **values):
    """Tip and axis of one pose, X, Y, Z unless others are given."""
    tip, axis = errors.real(machine).forward(machine.values(**(values or {"X": X, "Y": Y, "Z": Z})))
    return tip[0], axis[0]


def slide(name, **errors):
    return MachineErrors(slides={name: SlideErrors(**errors)})


def turn_of(name, which, size):
    vector = tuple(size if i == which else 0.0 for i in range(3))
    return slide(name, turn=vector)


@pytest.mark.parametrize(("name", "place", "at"), [("X", 0, X), ("Y", 1, Y), ("Z", 2, Z)])
def test_a_scale_moves_the_tool_along_its_axis_by_its_part_of_the_way(name, place, at):
    """E_XX, E_YY, E_ZZ, linear: 7 um/m over 310 mm are 2.17 um."""
    expected = np.array([X, Y, Z])
    expected[place] += 7e-6 * at
    tip, axis = pose(slide(name, scale=7e-6))
    assert tip == pytest.approx(expected, abs=1e-12)
    assert axis.tolist() == [0.0, 0.0, 1.0]


@pytest.mark.parametrize(("name", "at"), [("X", X), ("Y", Y), ("Z", Z)])
@pytest.mark.parametrize("place", range(3))
def test_a_bow_is_a_parabola_whose_middle_stands_off_any_chord_of_its_length(name, at, place):
    """E_YX, E_ZX, E_XY, E_ZY, E_XZ, E_YZ, and E_XX, E_YY, E_ZZ: nothing at zero, a sagitta of the bow anywhere."""
    bow, length = 4.0 * UM, 200.0
    errors = slide(name, bow=tuple(bow * (i == place) for i in range(3)), bow_length=length)
    expected = np.array([X, Y, Z])
    expected[place] -= 4.0 * bow * at**2 / length**2
    assert pose(errors)[0] == pytest.approx(expected, abs=1e-12)
    a, middle, b = (pose(errors, **{name: at + d})[0][place] for d in (-100.0, 0.0, 100.0))
    assert middle - (a + b) / 2.0 == pytest.approx(bow, abs=1e-12)


# Tips and axes by hand: X carries Y and Z, Y carries Z; turned is what the carriage carries, seen from its zero.
BY_HAND = {
    ("X", 0): lambda c, s: ((X, Y * c - Z * s, Y * s + Z * c), (0.0, -s, c)),
    ("X", 1): lambda c, s: ((X + Z * s, Y, Z * c), (s, 0.0, c)),
    ("X", 2): lambda c, s: ((X - Y * s, Y * c, Z), (0.0, 0.0, 1.0)),
    ("Y", 0): lambda c, s: ((X, Y - Z * s, Z * c), (0.0, -s, c)),
    ("Y", 1): lambda c, s: ((X + Z * s, Y, Z * c), (s, 0.0, c)),
    ("Y", 2): lambda c, s: ((X, Y, Z), (0.0, 0.0, 1.0)),
    ("Z", 0): lambda c, s: ((X, Y, Z), (0.0, -s, c)),
    ("Z", 1): lambda c, s: ((X, Y, Z), (s, 0.0, c)),
    ("Z", 2): lambda c, s: ((X, Y, Z), (0.0, 0.0, 1.0)),
}


@pytest.mark.parametrize(("name", "which"), BY_HAND)
@pytest.mark.parametrize("size", [20.0 * URAD / 1e3, 1e-3])
def test_a_carriage_turns_what_it_carries_about_its_zero(name, which, size):
    """E_AX, E_BX, E_CX, ... of 20 urad/m, and of 1 rad/m: exact at any size."""
    angle = size * {"X": X, "Y": Y, "Z": Z}[name]
    tip, axis = BY_HAND[name, which](cos(angle), sin(angle))
    found, pointing = pose(turn_of(name, which, size))
    assert found == pytest.approx(tip, abs=1e-11)
    assert pointing == pytest.approx(axis, abs=1e-14)


def test_a_reference_moves_the_point_about_which_the_carriage_turns():
    """300 mm over the tip a tilt of Z by 1 mrad/m x 85 mm takes the tip along by 25.5 um (Abbe)."""
    errors = slide("Z", turn=(0.0, 1e-6, 0.0), reference=(0.0, 0.0, 300.0))
    tip, _ = pose(errors)
    angle = 1e-6 * Z
    assert tip == pytest.approx((X - 300.0 * sin(angle), Y, Z + 300.0 * (1.0 - cos(angle))), abs=1e-12)


def test_squarenesses_turn_the_ways_of_y_and_z_and_nothing_else():
    """C0Y, B0Z, A0Z of 1 mrad: the ways' ends, the tool's axis standing as it was."""
    e = 1e-3
    for errors, tip in (
        (Squareness(c0y=e), (X - Y * sin(e), Y * cos(e), Z)),
        (Squareness(b0z=e), (X + Z * sin(e), Y, Z * cos(e))),
        (Squareness(a0z=e), (X, Y - Z * sin(e), Z * cos(e))),
    ):
        found, axis = pose(MachineErrors(squareness=errors))
        assert found == pytest.approx(tip, abs=1e-12)
        assert axis.tolist() == [0.0, 0.0, 1.0]


def test_all_component_errors_together_are_a_product_of_matrices():
    """The bed carries X, X carries Y, Y carries Z: motion, then shift and turn of each carriage, by 4 x 4 matrices."""
    e = {
        "X": (0, X, 1e-5, (1e-3, 2e-3, -3e-3)),
        "Y": (1, Y, -2e-5, (5e-3, 1e-3, 1e-3)),
        "Z": (2, Z, 3e-5, (0, 4e-3, 0)),
    }
    m = np.eye(4)
    for i, at, size, bow in e.values():
        way, off = np.zeros(3), -4.0 * np.array(bow) * at**2 / 500.0**2
        way[i] = at * (1.0 + 1e-4)
        m = m @ shift(*(way + off)) @ about("xyz"[(i + 1) % 3], size * at, (0.0, 0.0, 0.0))
    slides = {
        name: SlideErrors(1e-4, bow, turn=tuple(size * (k == (i + 1) % 3) for k in range(3)))
        for name, (i, _, size, bow) in e.items()
    }
    tip, axis = pose(MachineErrors(slides=slides))
    assert tip == pytest.approx(m[:3, 3], abs=1e-11)
    assert axis == pytest.approx(m[:3, 2], abs=1e-14)


B = 0.7


def rotary(name="B", **errors):
    return MachineErrors(rotaries={name: RotaryErrors(**errors)})


def test_a_pivot_that_lies_off_shifts_the_tool_by_what_turning_leaves_of_it():
    """(1 - Ry(B)) d, and nothing at B = 0."""
    d = np.array([5e-3, 2e-3, -8e-3])
    errors, place = rotary(offset=tuple(d)), {"X": X, "Y": Y, "Z": Z}
    nominal = MACHINE.forward(MACHINE.values(**place, B=B))[0][0]
    left = d - [cos(B) * d[0] + sin(B) * d[2], d[1], cos(B) * d[2] - sin(B) * d[0]]
    assert pose(errors, **place, B=B)[0] - nominal == pytest.approx(left, abs=1e-12)
    assert pose(errors, **place)[0] == pytest.approx((X, Y, Z), abs=1e-12)


def test_a_rotary_axis_that_leans_turns_about_the_leaning_line():
    """A_0B and C_0B at B = 90 deg: v goes to n (n v) + n x v, seen from the pivot; at 0 nothing is moved."""
    t = 2e-3
    for tilt, n in (((t, 0.0, 0.0), (0.0, cos(t), sin(t))), ((0.0, 0.0, t), (-sin(t), cos(t), 0.0))):
        n, v = np.array(n), np.array([X, Y, Z]) - PIVOT
        tip, axis = pose(rotary(tilt=tilt), X=X, Y=Y, Z=Z, B=pi / 2)
        assert tip == pytest.approx(PIVOT + n * (n @ v) + np.cross(n, v), abs=1e-11)
        assert axis == pytest.approx(n * n[2] + np.cross(n, [0.0, 0.0, 1.0]), abs=1e-14)
        assert pose(rotary(tilt=tilt))[0] == pytest.approx((X, Y, Z), abs=1e-12)


@pytest.mark.parametrize(
    ("errors", "angle"),
    [
        ({"zero": 1e-3}, B + 1e-3),
        ({"scale": 1e-3}, B * 1.001),
        ({"swing": 1e-3, "swing_phase": 0.4}, B + 1e-3 * sin(B + 0.4)),
        ({"zero": 1e-3, "scale": 2e-3, "swing": 3e-3}, 1e-3 + 1.002 * B + 3e-3 * sin(B)),
    ],
)
def test_a_rotary_axis_turns_too_far(errors, angle):
    v = np.array([X, Y, Z]) - PIVOT
    turned = [cos(angle) * v[0] + sin(angle) * v[2], v[1], cos(angle) * v[2] - sin(angle) * v[0]]
    tip, axis = pose(rotary(**errors), X=X, Y=Y, Z=Z, B=B)
    assert tip == pytest.approx(PIVOT + np.array(turned), abs=1e-11)
    assert axis == pytest.approx((sin(angle), 0.0, cos(angle)), abs=1e-14)


def test_what_is_lost_is_added_to_where_the_axes_stand():
    errors = MachineErrors(slides={"X": SlideErrors(backlash=0.02)}, rotaries={"C": RotaryErrors(backlash=1e-4)})
    real = errors.real(MACHINE)
    assert real.backlash.tolist() == [0.02, 0.0, 0.0, 0.0, 1e-4]
    lost = MACHINE.values(X=0.02, C=1e-4)
    tip, _ = real.forward(MACHINE.values(X=X, Y=Y, C=pi / 2), lost)
    x, y, turned = X + 0.02, Y, pi / 2 + 1e-4
    assert tip[0] == pytest.approx((cos(turned) * x - sin(turned) * y, sin(turned) * x + cos(turned) * y, 0), abs=1e-11)


def test_a_spindle_grows_along_the_tool_wherever_it_points():
    """10 um (1 - exp(-15/30)) and 0.2 um/min x 15 min, against the tool's axis (sin B, 0, cos B)."""
    machine, growth = head_b_table_c(200.0), Growth(10.0 * UM, 30.0, 0.2 * UM)
    values = machine.values(X=X, Y=Y, Z=Z, B=B)
    real = MachineErrors(growth=growth).real(machine)
    grown = 10.0 * UM * (1.0 - exp(-0.5)) + 3.0 * UM
    there = machine.forward(values)[0][0]
    assert there - real.forward(values, minutes=15.0)[0][0] == pytest.approx(
        grown * np.array([sin(B), 0.0, cos(B)]), abs=1e-12
    )
    assert real.forward(values)[0][0] == pytest.approx(there, abs=1e-12)


def test_errors_of_carriages_beyond_rotary_axes_turn_with_these():
    """The Star's Z hangs on B: its lean turns with B; the gear's frame has -z and x of the machine's for x and z."""
    e, machine, place = 1e-3, star(), {"X": 5.0, "Y": 40.0, "Z": 70.0}
    for b in (0.0, B):
        nominal = machine.forward(machine.values(**place, B=b))[0][0]
        off = pose(MachineErrors(squareness=Squareness(b0z=e)), machine, **place, B=b)[0] - nominal
        x, z = 70.0 * sin(e), 70.0 * (cos(e) - 1.0)
        turned = (cos(b) * x + sin(b) * z, cos(b) * z - sin(b) * x)
        assert off == pytest.approx((-turned[1], 0.0, turned[0]), abs=1e-11)


def test_no_error_is_no_machine_and_foreign_axes_are_refused():
    assert MachineErrors().real(MACHINE) is None
    assert slide("X", bow_length=3.0, reference=(1.0, 2.0, 3.0)).real(MACHINE) is None
    assert rotary("A").real(MACHINE) is None
    with pytest.raises(InputError, match="no rotary axis A; table-table-bc has B, C"):
        rotary("A", zero=1e-6).real(MACHINE)
    with pytest.raises(InputError, match="no linear axis U; table-table-bc has X, Y, Z"):
        slide("U", scale=1e-6).real(MACHINE)
    with pytest.raises(InputError, match="squareness: no axis Y; cradle has"):
        MachineErrors(squareness=Squareness(c0y=1e-6)).real(MACHINES["cradle"]())


def test_poses_are_series_of_the_real_machine(rng):
    """Taylor polynomials of order 3 in time meet the poses at h to h^4, every kind of error acting."""
    errors = MachineErrors(
        {"X": SlideErrors(1e-2, (0.1, 0.2, 0.3), 100.0, (1e-4, 2e-4, 3e-4), (1.0, 2.0, 3.0), 0.1)},
        {"B": RotaryErrors((1.0, 2.0, 3.0), (0.1, 0.2, 0.3), 0.1, 0.1, 0.1, 0.5, 0.1)},
        Squareness(0.1, 0.2, 0.3),
        Growth(1.0, 2.0, 0.5),
    )
    real, (start, way) = RealMachine(MACHINE, errors), rng.normal(size=(2, 4, 5))
    values = [Series(np.stack([start[:, i], way[:, i], *np.zeros((2, 4))])) for i in range(5)]
    time = Series(np.stack([np.ones(4), np.full(4, 0.3), *np.zeros((2, 4))]))
    tip = real.frame_series(values, values, time).tip.c
    off = []
    for h in (0.02, 0.01):
        at = [Series((v.c[0] + h * v.c[1])[None]) for v in (*values, time)]
        there = real.frame_series(at[:5], at[:5], at[5]).tip.value
        off.append(np.abs(sum(h**k * tip[k] for k in range(4)) - there).max())
    assert 14.0 < off[0] / off[1] < 18.0
