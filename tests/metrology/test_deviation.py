import numpy as np

from gearsim.geometry.rays import RayBundle
from gearsim.metrology.deviation import Crossing, measure
from tests.simulation.test_intervals import as_set


def rays(n, inward=1.0, outward=2.0):
    z = np.zeros((n, 3))
    return RayBundle(z, np.tile([0.0, 0.0, 1.0], (n, 1)), np.full(n, -inward), np.full(n, outward))


def test_every_case_of_a_ray():
    cuts = [
        [(0.3, 9.0)],  # material left
        [(-0.2, 9.0)],  # overcut
        [],  # nothing cut
        [(3.0, 9.0)],  # cut starts past the window
        [(-5.0, 9.0)],  # cut through the window
        [(-0.9, -0.4), (0.5, 9.0)],  # a cut behind that does not reach the origin
        [(-0.2, 0.5), (1.0, 9.0)],  # a chip left farther out
        [(0.0, 9.0)],  # exactly on the surface
    ]
    d = measure(rays(8), as_set(cuts))
    M, U, T = Crossing.MEASURED, Crossing.UNCUT, Crossing.THROUGH
    assert d.crossing.tolist() == [M, M, U, U, T, M, M, M]
    assert np.allclose(d.value, [0.3, -0.2, np.nan, np.nan, np.nan, 0.5, -0.2, 0.0], equal_nan=True)
    assert d.multiple.tolist() == [False, False, False, False, False, False, True, False]
    assert d.segment[2:5].tolist() == [-1, -1, -1]


def test_a_bound_is_never_a_number_in_the_summary():
    s = measure(rays(3), as_set([[(0.001, 9.0)], [], [(-5.0, 9.0)]])).summary_um()
    assert (s["min"], s["max"], s["mean"], s["rms"]) == (1.0, 1.0, 1.0, 1.0)
    assert (s["samples"], s["uncut"], s["through"]) == (3, 1, 1)
    empty = measure(rays(1), as_set([[]])).summary_um()
    assert empty["mean"] is None


def test_a_patch_of_five_micrometres_comes_back_as_five():
    """Extra material of +5 um on a part of the rays, nothing on the rest, exactly."""
    patch = np.arange(40) % 7 == 0
    cuts = [[(5e-3 if p else 0.0, 9.0)] for p in patch]
    um = 1e3 * measure(rays(40), as_set(cuts)).value
    assert np.allclose(um, np.where(patch, 5.0, 0.0), atol=1e-12)
