"""The mean profile ends where the flank does: a gear of other heights than the printed one has no point beyond."""

import numpy as np
import pytest

from gearsim.metrology.mean_profile import ProfileInspection
from gearsim.output.markdown import um
from gearsim.processes.run import plan, run
from gearsim.scene import load_scene

SMALL = ("metrology.rows=3", "metrology.columns=5", "metrology.convergence=[]", "simulation.dexel_pitch_mm=1.5")


def edges(job, side):
    """Heights of the flank's lower and upper edge above the contact path [mm], in its mean profile, by bisection."""
    (asked,) = (i for i in job.inspections if isinstance(i, ProfileInspection) and i.surface == side)
    patch, blank = job.part.patch(side), job.part.patch(side).blank
    found = []
    for inside, outside in ((0.0, -20.0), (0.0, 20.0)):
        for _ in range(60):
            middle = 0.5 * (inside + outside)
            u, v, _ = patch.mean_profile(asked.contact_height, np.array([middle]))
            cone, above = blank.cone_height(patch.jet(u, v).r)
            on = v[0] >= patch.start and above[0] <= blank.addendum_at(cone[0])
            inside, outside = (middle, outside) if on else (inside, middle)
        found.append(inside)
    return found


@pytest.mark.parametrize("scene", ["spiral-bevel-flank"])
def test_heights_beyond_the_flank_s_edges_have_no_deviation(scene):
    loaded, folder = load_scene(scene, SMALL)
    lower, upper = edges(plan(loaded, folder), "convex")
    assert lower < -3.0 < 3.0 < upper  # the printed points lie on the printed gear
    offsets = [lower - 1e-4, lower + 1e-4, 0.0, upper - 1e-4, upper + 1e-4, 50.0]
    loaded = loaded.model_copy(update={
        "reference": None, "metrology": loaded.metrology.model_copy(update={"profile_offsets_mm": tuple(offsets)})
    })  # fmt: skip
    result = run(loaded, folder=folder)
    found = result.measurements["convex", "theory", "mean profile"]
    for values in (found.normal_um, found.in_plane_um):
        assert np.isfinite(list(values.values())).tolist() == [False, True, True, True, False, False]


def test_what_has_no_deviation_is_a_dash():
    assert um(float("nan")) == um(None) == "–"
    assert um(0.0) == "0"
