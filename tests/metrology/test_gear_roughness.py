"""Roughness of waves whose Ra, Rq, Rz and filtered size are known."""

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.metrology.roughness import measure_roughness, remove_form, ten_point_height, waviness

X = np.linspace(0.0, 10.0, 10001)


def transmission(wavelength, cutoff=0.8):
    """What ISO 16610-21 lets pass of a wave: exp(-pi (alpha cutoff / wavelength)^2), half at the cutoff."""
    return 2.0 ** -((cutoff / wavelength) ** 2)


@pytest.mark.parametrize("wavelength", [0.2, 0.4, 0.8, 1.6, 3.2])
def test_the_filter_passes_what_the_standard_says(wavelength):
    wave = np.cos(2.0 * np.pi * X / wavelength)
    passed = waviness(wave, X[1] - X[0])[1000:-1000]
    assert passed == pytest.approx(transmission(wavelength) * wave[1000:-1000], abs=2e-5)
    if wavelength == 0.8:
        assert np.ptp(passed) / 2.0 == pytest.approx(0.5, abs=1e-4)


def test_the_filter_leaves_a_constant_up_to_the_ends_alone():
    assert waviness(np.full(500, 3.0), 0.01) == pytest.approx(3.0)
    assert waviness(np.full(20, 3.0), 0.01) == pytest.approx(3.0)  # shorter than the weighting function


def test_a_short_sine_keeps_its_ra_rq_rz():
    found = measure_roughness(X, 1.5 * np.sin(2.0 * np.pi * X / 0.1), degree=1)
    assert found.ra_um == pytest.approx(2.0 * 1.5 / np.pi, rel=1e-3)
    assert found.rq_um == pytest.approx(1.5 / np.sqrt(2.0), rel=1e-3)
    assert found.rz_um == pytest.approx(3.0, rel=1e-3)
    assert found.ten_point_um == pytest.approx(3.0, rel=1e-3)
    assert (found.first, found.last, found.sections, found.status) == (pytest.approx(3.0), pytest.approx(7.0), 5, "")


def test_a_triangle_keeps_its_ra_and_rq():
    triangle = 2.0 * np.abs(2.0 * ((X / 0.05) % 1.0) - 1.0) - 1.0
    found = measure_roughness(X, triangle, degree=1)
    assert found.ra_um == pytest.approx(0.5, rel=2e-3)
    assert found.rq_um == pytest.approx(1.0 / np.sqrt(3.0), rel=2e-3)
    assert found.rz_um == pytest.approx(2.0, rel=1e-2)


def test_a_sine_at_the_cutoff_keeps_half():
    found = measure_roughness(X, np.sin(2.0 * np.pi * X / 0.8), degree=0)
    assert found.rz_um == pytest.approx(1.0, abs=2e-3)
    assert found.ra_um == pytest.approx(1.0 / np.pi, abs=1e-3)


def test_form_is_taken_out_before():
    rough = 0.3 * np.sin(2.0 * np.pi * X / 0.1)
    plain = measure_roughness(X, rough, degree=2)
    curved = measure_roughness(X, rough + 40.0 - 7.0 * X + 3.0 * X**2, degree=2)
    assert curved.ra_um == pytest.approx(plain.ra_um, rel=1e-9)
    assert np.abs(remove_form(X, 40.0 - 7.0 * X, 1)).max() < 1e-10


def test_uneven_samples_are_brought_to_even_ones():
    x = 10.0 * (0.9 * np.linspace(0.0, 1.0, 8001) + 0.1 * np.linspace(0.0, 1.0, 8001) ** 2)
    found = measure_roughness(x, np.sin(2.0 * np.pi * x / 0.25), degree=1)
    share = 1.0 - transmission(0.25)
    assert found.ra_um == pytest.approx(share * 2.0 / np.pi, rel=5e-3)
    assert np.ptp(np.diff(found.position)) < 1e-12


def test_rz_is_a_mean_over_sections_and_the_ten_points_over_all():
    """One scratch of 5 um: a fifth of it enters Rz, all of it is among the ten points' five valleys."""
    scratched = 0.5 * np.sin(2.0 * np.pi * X / 0.1)
    scratched[5000] -= 5.0
    clean, found = (measure_roughness(X, y, degree=1) for y in (0.5 * np.sin(2.0 * np.pi * X / 0.1), scratched))
    assert found.rz_um - clean.rz_um == pytest.approx(4.5 / 5.0, rel=0.02)
    assert found.ten_point_um - clean.ten_point_um == pytest.approx(4.5 / 5.0, rel=0.02)
    assert found.rz_um == pytest.approx(1.0 + 0.9, rel=0.02)


def test_ten_points_by_hand():
    heights = np.array([1, -1, 5, -2, 3, 2, -4, 6, -1, 2, -3, 4, -9, 1, -1], dtype=float)
    assert ten_point_height(heights) == pytest.approx((6 + 5 + 4 + 3 + 2) / 5 + (9 + 4 + 3 + 2 + 1) / 5)
    assert np.isnan(ten_point_height(heights[:8]))
    assert np.isnan(ten_point_height(np.array([])))


@pytest.mark.parametrize(("length", "sections"), [(4.8, 5), (4.79, 4), (2.0, 1), (1.6, 1), (1.5, 0), (0.3, 0)])
def test_a_short_trace_is_said_to_be_short(length, sections):
    x = np.linspace(0.0, length, 1001)
    found = measure_roughness(x, np.sin(2.0 * np.pi * x / 0.05), degree=1)
    assert found.sections == sections
    assert found.last - found.first == pytest.approx(0.8 * sections)
    assert np.isfinite(found.ra_um) == (sections > 0)
    assert (found.status == "") == (sections == 5)
    if sections < 5:
        assert f"is short: {sections} of 5 sections of 0.8 mm evaluated (4.8 mm needed)" in found.status


def test_a_missing_sample_leaves_nothing_evaluated():
    y = np.sin(X)
    y[77] = np.nan
    found = measure_roughness(X, y, degree=1)
    assert found.status == "1 samples missing: nothing evaluated"
    assert np.isnan([found.ra_um, found.rq_um, found.rz_um, found.ten_point_um]).all()


def test_few_peaks_give_no_ten_point_height_but_the_rest():
    found = measure_roughness(X, np.cos(2.0 * np.pi * X / 1.5), degree=1)
    assert found.status == "fewer than 5 peaks and valleys: no ten-point height"
    assert np.isnan(found.ten_point_um)
    assert found.ra_um > 0.0


def test_positions_must_rise():
    with pytest.raises(InputError, match="rising order"):
        measure_roughness(X[::-1], X, degree=1)
