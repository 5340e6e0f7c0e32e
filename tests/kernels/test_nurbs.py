"""The kernel's NURBS against NumPy's."""

import numpy as np
import pytest
import warp as wp

from gearsim.errors import InputError
from gearsim.geometry.nurbs import clamped_knots
from gearsim.gouging.evaluate import evaluate
from gearsim.surfaces.nurbs import NurbsSurface
from tests.surfaces.nurbs_shapes import sphere, wavy

wp.init()
DEVICES = ["cpu", *(["cuda:0"] if wp.is_cuda_available() else [])]
FIELDS = ("r", "ru", "rv", "ruu", "ruv", "rvv", "normal")
SHAPES = {
    "line by cubic": wavy(np.random.default_rng(0), 1, 3, (4, 9)),
    "cubic by quadratic": wavy(np.random.default_rng(1)),
    "quintic by degree 15": wavy(np.random.default_rng(2), 5, 15, (9, 17)),
    "sphere": sphere(7.0),
}


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("name", SHAPES)
def test_the_kernel_is_the_twin_of_numpy(name, device):
    surface = SHAPES[name]
    u, v = surface.locate(*np.random.default_rng(3).uniform(size=(2, 20000)))
    for x, basis in zip((u, v), surface.along, strict=True):
        x[: len(basis.knots)] = np.clip(basis.knots, *basis.domain)
    u[-1], v[-2] = np.nan, 1e9
    wanted, found = surface.jet(u, v), evaluate(surface, u, v, device)
    for field in FIELDS:
        a, b = getattr(found, field), getattr(wanted, field)
        assert np.isnan(b).sum() == 6
        np.testing.assert_allclose(a, b, rtol=0.0, atol=1e-12 * np.nanmax(np.abs(b)))
    for a, b in zip(found.curvature().k1, wanted.curvature().k1, strict=True):
        assert a == pytest.approx(b, rel=1e-9, abs=1e-9, nan_ok=True)


def test_what_the_kernel_cannot_do_is_refused():
    surface = wavy(np.random.default_rng(4), 16, 1, (17, 2))
    with pytest.raises(InputError, match="beyond the kernel's 15"):
        evaluate(surface, [0.5], [0.5])
    with pytest.raises(InputError, match="no device 'abacus'"):
        evaluate(sphere(1.0), [0.5], [0.5], "abacus")


def test_no_points_and_one_thread():
    surface = NurbsSurface(
        1, 1, clamped_knots(2, 1), clamped_knots(2, 1), [[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0]]]
    )
    assert evaluate(surface, [], []).r.shape == (0, 3)
    np.testing.assert_array_equal(evaluate(surface, [0.5], [0.25], threads=1).r, [[0.5, 0.25, 0.0]])
