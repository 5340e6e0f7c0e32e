"""A synthetic gear with known slope, form and pitch errors comes back with those numbers."""

from math import radians

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.metrology.gear_traces import evaluate, helix_range, profile_range, transverse_um
from gearsim.metrology.iso1328 import PARAMETERS, achieved_class
from gearsim.surfaces.cylindrical_gear import CylindricalGear
from gearsim.surfaces.flank_modification import FlankModification
from gearsim.surfaces.involute import InvoluteFlank
from tests.metrology.gears import SLOPE, STEP, WAVE, gear_of, inspection


@pytest.mark.parametrize("teeth", [15, -30])
@pytest.mark.parametrize("helix_deg", [0.0, 10.0, -10.0])
@pytest.mark.parametrize("size", [1.0, 1e-3, 5.0])
def test_the_table_tells_what_was_put_in(teeth, helix_deg, size):
    found = inspection(gear_of(teeth, helix_deg), size)
    rows = {row.parameter: row for row in found.rows()}
    assert tuple(rows) == PARAMETERS
    for letter in ("alpha", "beta"):
        assert rows[f"f_H{letter}"].value_um == pytest.approx({s: size * v for s, v in SLOPE.items()}, rel=1e-3)
        assert rows[f"f_f{letter}"].value_um == pytest.approx(dict.fromkeys(SLOPE, 2.0 * WAVE * size), rel=2e-3)
    for name in ("f_p", "F_p"):
        assert rows[name].value_um == pytest.approx(dict.fromkeys(SLOPE, STEP * size), rel=1e-9)
    for name, row in rows.items():
        worst = max(abs(v) for v in row.value_um.values())
        assert row.achieved == achieved_class(found.size, name, worst)
        assert row.within == (row.achieved is not None and row.achieved <= 6)
        assert row.incomplete == 0
    # both flanks turn alike: the tooth's place changes, not the width of the space
    assert np.abs(found.runout.radial_um).max() < 1e-9


def test_a_trace_that_misses_samples_fails_its_parameters_and_is_counted():
    rows = {row.parameter: row for row in inspection(gear_of(), 1e-3, missing=True).rows()}
    for name in ("f_Halpha", "f_falpha", "F_alpha"):
        assert (rows[name].incomplete, rows[name].achieved, rows[name].within) == (2, None, False)
        assert np.isfinite(rows[name].value_um["left"])  # of the other traces
    assert rows["F_beta"].within


@pytest.mark.parametrize("teeth", [15, -30])
@pytest.mark.parametrize("side", ["left", "right"])
def test_designed_slopes_of_a_flank_are_measured_on_its_points(teeth, side):
    """Points of a modified flank against the plain one: 8 um to the tip, -5 um to the bottom face, along the normal."""
    gear = gear_of(teeth)
    modified = InvoluteFlank(gear, side, 0, FlankModification(profile_slope=0.008, helix_slope=-0.005))
    plain = InvoluteFlank(gear, side, 0)
    profile = profile_range(gear.base_radius * gear.root_roll, gear.base_radius * gear.tip_roll)
    helix = helix_range(10.0, 5.0)
    roll = np.linspace(gear.root_roll, gear.tip_roll, 101)
    z = np.linspace(0.0, -10.0, 101)
    for u, v, position, span, expected in (
        (roll, np.zeros(101), gear.base_radius * roll, profile, 8.0),
        (np.full(101, 0.3), z, z, helix, -5.0),
    ):
        at, moved = plain.jet(u, v), modified.jet(u, v)
        normal = np.sum((moved.r - at.r) * at.normal, axis=1)
        found = evaluate(position, transverse_um(normal, gear.base_helix_angle), span)
        assert found.slope_um == pytest.approx(expected / np.cos(gear.base_helix_angle), rel=1e-6)
        assert found.form_um == pytest.approx(0.0, abs=1e-6)


def test_a_gear_beyond_the_scope_has_no_table():
    thin = CylindricalGear(15, 5.0, radians(20.0), facewidth=3.0)
    with pytest.raises(InputError, match="face width b = 3 mm"):
        _ = inspection(thin).tolerances_um
