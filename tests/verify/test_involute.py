from math import radians

import pytest

from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear
from gearsim.surfaces.involute import InvoluteFlank
from gearsim.verify import verify_form
from gearsim.verify.involute import flank_form


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("helix_deg", [0.0, 10.0, -10.0])
@pytest.mark.parametrize("teeth", [15, -30])
def test_an_end_mill_in_tangential_motion_leaves_the_flank(teeth, helix_deg, side):
    """Groover's test gears and tool, tables 5.1 and 5.3 to 5.6: an exact involute, by brute force."""
    gear = CylindricalGear.from_transverse(teeth, 5.0, radians(20.0), radians(helix_deg), 10.0)
    report = verify_form(flank_form(InvoluteFlank(gear, side, 2), 1.5875), 25, 1)
    assert report.verdict == "pass"
    assert report.missing == report.trimmed == 0
    assert report.checks["distance"].worst < 1e-12
    assert all(check.checked == 25 for check in report.checks.values())
