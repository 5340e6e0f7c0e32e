"""Traces with known slope, form and modification come back with those numbers."""

from math import cos, radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.metrology.gear_traces import (
    EvaluationRange,
    GearTraces,
    evaluate,
    helix_range,
    helix_slope_iso_um,
    profile_range,
    transverse_um,
)
from gearsim.surfaces.cylindrical_gear import CylindricalGear

EXTERNAL, INTERNAL = profile_range(3.0, 25.0), profile_range(25.0, 3.0)
HELIX = helix_range(10.0, 5.0)


def test_ranges():
    assert (EXTERNAL.first, EXTERNAL.last) == pytest.approx((3.0, 23.9))
    assert (INTERNAL.first, INTERNAL.last) == pytest.approx((25.0, 4.1))
    assert (HELIX.first, HELIX.last) == (-0.5, -9.5)  # 5 % of b, less than a module
    assert helix_range(100.0, 2.0).first == -2.0  # one module, less than 5 % of b
    thesis = helix_range(10.0, 5.0, window=0.8)
    assert (thesis.first, thesis.last) == pytest.approx((-1.0, -9.0))
    with pytest.raises(InputError, match="must lie within the active flank"):
        EvaluationRange(0.0, -10.0, 0.5, -9.5)
    with pytest.raises(InputError, match="within the active flank, 5 to 5 mm"):
        profile_range(5.0, 5.0)
    with pytest.raises(InputError, match="run the same way"):
        EvaluationRange(0.0, -10.0, -9.5, -0.5)


@pytest.mark.parametrize("span", [EXTERNAL, INTERNAL, HELIX])
@given(st.floats(-30.0, 30.0), st.floats(-30.0, 30.0), st.integers(0, 2**32 - 1))
def test_a_straight_trace_is_all_slope_however_it_is_sampled(span, offset, slope, seed):
    x = span.start + (span.end - span.start) * np.sort(np.r_[0.0, np.random.default_rng(seed).uniform(size=20), 1.0])
    found = evaluate(x, offset + slope * span.share(x), span)
    share = abs(span.last - span.first) / abs(span.end - span.start)
    assert found.slope_um == pytest.approx(slope, abs=1e-10)
    assert found.form_um == pytest.approx(0.0, abs=1e-10)
    assert found.total_um == pytest.approx(abs(slope) * share, abs=1e-10)
    assert found.line_um == pytest.approx(np.array([offset, offset + slope]), abs=1e-10)


@pytest.mark.parametrize("span", [EXTERNAL, INTERNAL, HELIX])
def test_slope_and_waves_come_back_with_their_size(span):
    """Whole cosine waves over the evaluated part carry no slope: the mean line is the slope alone."""
    share = np.linspace(0.0, 1.0, 2001)
    a, b = span.share(span.first), span.share(span.last)
    wave = 1.5 * np.cos(2.0 * np.pi * 6.0 * (share - a) / (b - a))
    found = evaluate(span.start + share * (span.end - span.start), 7.0 * share + wave, span)
    assert found.slope_um == pytest.approx(7.0, abs=1e-4)
    assert found.form_um == pytest.approx(3.0, abs=1e-3)
    crests = 7.0 * (b - a) + 3.0  # a crest and a trough lie within half a wave of the ends
    assert crests - 7.0 * (b - a) / 12.0 - 0.1 < found.total_um <= crests


def test_a_crowning_has_the_form_of_its_parabola():
    """y = -c (2 t - 1)^2 over the evaluated part: mean line level at -c / 3, band from -c to 0."""
    x = np.linspace(0.0, -10.0, 4001)
    t = (x - HELIX.first) / (HELIX.last - HELIX.first)
    found = evaluate(x, -4.0 * (2.0 * t - 1.0) ** 2, HELIX)
    assert found.slope_um == pytest.approx(0.0, abs=1e-6)
    assert found.form_um == pytest.approx(4.0, abs=1e-6)
    assert found.line_um[0] == pytest.approx(-4.0 / 3.0, abs=1e-5)


def test_crowded_samples_do_not_outweigh_the_rest():
    """The mean line of a step belongs to the surface, not to the samples: it must not move with their spacing."""
    even = np.linspace(3.0, 25.0, 20001)
    uneven = 3.0 + 22.0 * np.linspace(0.0, 1.0, 20001) ** 3
    a, b = (evaluate(x, np.where(x > 10.0, 5.0, 0.0), EXTERNAL) for x in (even, uneven))
    assert a.slope_um == pytest.approx(b.slope_um, abs=5e-3)
    plain = np.polyfit(EXTERNAL.share(uneven), np.where(uneven > 10.0, 5.0, 0.0), 1)[0]
    assert abs(plain - a.slope_um) > 0.1


def test_against_a_fit_by_another_way():
    x = np.linspace(25.0, 3.0, 221)
    y = np.sin(x) + 0.3 * np.cos(7.0 * x) + 0.01 * x**2
    found = evaluate(x, y, INTERNAL)
    fine = np.linspace(INTERNAL.first, INTERNAL.last, 200001)
    at = np.interp(fine, x[::-1], y[::-1])
    slope, offset = np.polyfit((fine - 25.0) / (3.0 - 25.0), at, 1)
    assert found.slope_um == pytest.approx(slope, abs=2e-3)
    assert found.line_um[0] == pytest.approx(offset, abs=2e-3)
    assert found.total_um == pytest.approx(np.ptp(at), abs=1e-3)


def test_what_lies_outside_the_evaluated_part_does_not_count():
    x = np.linspace(0.0, -10.0, 101)
    y = np.where((x > -0.45) | (x < -9.55), 50.0, 0.0)
    found = evaluate(x, y, HELIX)
    assert (found.slope_um, found.form_um, found.total_um) == (0.0, 0.0, 0.0)
    y[[0, 3, -1]] = np.nan
    assert evaluate(x, y, HELIX).complete


def test_a_missing_sample_makes_a_trace_incomplete_never_narrower():
    x = np.linspace(0.0, -10.0, 101)
    y = np.zeros((2, 3, 101))
    y[1, 2, 50] = np.nan
    found = evaluate(x, y, HELIX)
    assert found.complete.tolist() == [[True] * 3, [True, True, False]]
    assert np.isnan([found.slope_um[1, 2], found.form_um[1, 2], found.total_um[1, 2]]).all()
    assert np.all(found.total_um[found.complete] == 0.0)
    short = evaluate(x[10:], y[0, 0, 10:], HELIX)  # begins inside the evaluated part
    assert not short.complete
    limit = np.linspace(0.0, -10.0, 42)
    needed = np.where(limit > -0.49, np.nan, 0.0)  # the value at -0.5 needs both its neighbours
    assert not evaluate(limit, needed, HELIX).complete


def test_many_traces_at_once_are_each_alone():
    x = np.linspace(3.0, 25.0, 45)
    y = np.random.default_rng(1).normal(size=(4, 3, 45))
    together = evaluate(x, y, EXTERNAL)
    for i, j in np.ndindex(4, 3):
        alone = evaluate(x, y[i, j], EXTERNAL)
        assert alone.slope_um == pytest.approx(together.slope_um[i, j])
        assert alone.form_um == pytest.approx(together.form_um[i, j])


def test_the_designed_modification_is_taken_out():
    x = np.linspace(3.0, 25.0, 441)
    relief = -8.0 * np.clip((x - 18.0) / 7.0, 0.0, None) ** 2
    made = relief + 2.0 * EXTERNAL.share(x)
    traces = GearTraces("profile", "left", (0,), (-5.0,), x, made[None, None], EXTERNAL, relief)
    found = traces.evaluated()
    assert found.slope_um == pytest.approx(np.array([[2.0]]))
    assert found.form_um == pytest.approx(np.array([[0.0]]), abs=1e-12)
    with pytest.raises(InputError, match=r"shape \(1, 1, 441\), expected \(2, 1, 441\)"):
        GearTraces("profile", "left", (0, 1), (-5.0,), x, made[None, None], EXTERNAL)


def test_impossible_traces_are_refused():
    with pytest.raises(InputError, match="one way"):
        evaluate(np.array([0.0, -2.0, -1.0, -9.8]), np.zeros(4), HELIX)
    with pytest.raises(InputError, match="at least 3 samples"):
        evaluate(np.array([0.0, -5.0, -10.0]), np.zeros(3), HELIX)


@pytest.mark.parametrize("teeth", [15, -30])
@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("helix_deg", [0.0, 10.0, -10.0])
def test_the_sign_of_the_helix_slope_by_turning_sections(teeth, side, helix_deg):
    """A flank with more right-hand twist, as points: its normal deviation gives the standard's sign."""
    gear = CylindricalGear.from_transverse(teeth, 5.0, radians(20.0), radians(helix_deg), 10.0)
    f, s, beta_b = (1 if side == "right" else -1), gear.sign, gear.base_helix_angle
    xi, z, more = 0.4, np.linspace(0.0, -10.0, 11), 1e-6

    def flank(twist):
        theta = f * xi + s * f * gear.space_half_angle + twist * z
        x = gear.base_radius * (np.cos(theta) + f * xi * np.sin(theta))
        y = gear.base_radius * (np.sin(theta) - f * xi * np.cos(theta))
        n = f * s * np.array([np.sin(theta) * cos(beta_b), -np.cos(theta) * cos(beta_b), 0 * z + np.sin(beta_b)])
        return np.array([x, y, z]), n

    (points, normal), (moved, _) = flank(gear.twist), flank(gear.twist + more)
    deviation = transverse_um(np.sum((moved - points) * normal, axis=0), beta_b)
    slope = evaluate(z, deviation, HELIX).slope_um
    assert abs(slope) == pytest.approx(1e3 * gear.base_radius * more * 10.0, rel=1e-5)
    larger = helix_deg >= 0.0  # right-hand twist makes a left-hand helix smaller
    assert np.sign(helix_slope_iso_um(slope, gear, side)) == (1.0 if larger else -1.0)


def test_transverse_is_larger_than_normal():
    assert transverse_um([0.001], radians(10.0)) == pytest.approx([1.0 / cos(radians(10.0))])
