"""Sectors of compound surfaces and of one-sided tools, against f sampled over the sectors."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearsim.cutters.contact import end_mill_contact
from gearsim.gouging.borders import border_sectors, compare_sectors, gouging_between, least_between, tool_sectors
from gearsim.gouging.compare import Decision, compare, compare_contact
from gearsim.gouging.tensors import principal_tensor


@given(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2), st.floats(0.0, 3.14), st.floats(-7.0, 7.0), st.floats(0.05, 6.28))
def test_least_and_directions_in_a_sector(high, low, alpha0, start, width):
    f = compare(principal_tensor(0.1, 0.03), principal_tensor(max(high, low), min(high, low), alpha0))
    alpha = np.linspace(start, start + width, 2001)
    values = f.at(alpha)
    least = least_between(f, start, start + width)
    assert least <= values.min() + 1e-12
    assert values.min() - least <= 2.0 * f.amplitude * (width / 4000.0) ** 2 + 1e-12
    arcs = gouging_between(f, start, start + width)
    assert all(start <= a <= b <= start + width for a, b in arcs)
    if f.decision == Decision.GOUGES:
        inside = np.any([(alpha >= a) & (alpha <= b) for a, b in arcs], axis=0) if arcs else np.zeros(len(alpha), bool)
        clear = np.abs(values) > 1e-5
        assert np.array_equal(inside[clear], values[clear] < 0.0)


def test_on_a_smooth_border_both_full_circles_decide():
    """Each sector is pi wide, the period of f: the least values are those without sectors."""
    patches = [principal_tensor(0.045, -0.012, 0.2), principal_tensor(0.044, -0.116, 0.3)]
    contact = end_mill_contact(35.0, 25.0, np.radians(45.0))
    results = compare_sectors(tool_sectors(contact), border_sectors(patches, [3.4, 3.4 + np.pi]))
    whole = [compare_contact(contact, patch).least for patch in patches]
    for k, name in enumerate(("patch 1", "patch 2")):
        assert min(r.least for r in results if r.part == name) == pytest.approx(float(whole[k]))


def test_at_a_corner_a_patch_gouges_only_within_its_sector():
    """Three patches; the concave one is narrow: f is least outside of it."""
    flat, steep = principal_tensor(-0.1, -0.1), principal_tensor(0.3, -0.2, 0.0)
    contact = end_mill_contact(10.0, 5.0, 0.8)
    worst = float(compare_contact(contact, steep).worst)
    across, along = worst + 0.5 * np.pi, worst
    beside = border_sectors([steep, flat, flat], [across - 0.3, across + 0.3, across + 2.0])
    within = border_sectors([steep, flat, flat], [along - 0.3, along + 0.3, along + 2.0])
    assert all(r.decision is Decision.FREE for r in compare_sectors(tool_sectors(contact), beside))
    assert any(r.decision is Decision.GOUGES for r in compare_sectors(tool_sectors(contact), within))


def test_sectors_fill_the_circle_and_no_more():
    sectors = border_sectors([principal_tensor(0.1, 0.0)] * 3, [5.0, 1.0, 2.5])
    sides = tool_sectors(end_mill_contact(10.0, 2.0, 0.0))
    assert sum(s.end - s.start for s in sectors) == pytest.approx(2.0 * np.pi)
    assert sum(r.end - r.start for r in compare_sectors(sides, sectors)) == pytest.approx(2.0 * np.pi)


def test_a_bottom_disc_gouges_a_trough_on_its_own_side_only():
    """A trough across the meridian: the corner (1/r) clears it, the disc (0) on the other side does not."""
    contact = end_mill_contact(10.0, 2.0, 0.0)
    results = compare_sectors(tool_sectors(contact), border_sectors([principal_tensor(0.05, 0.0)], [0.0]))
    assert {r.tool: r.decision for r in results if r.least < -1e-9} == {"downhill": Decision.GOUGES}
    assert compare_contact(contact, principal_tensor(0.05, 0.0)).decision == Decision.GOUGES
    arcs = [a for r in results for a in r.gouging]
    assert sum(b - a for a, b in arcs) == pytest.approx(np.pi)
