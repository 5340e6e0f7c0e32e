"""Khan 9.6: a contact on the border of two patches, from his tables 9-3 and 9-4 (the patches are not printed).

All printed directions are taken as given; angles come out counter-clockwise about n. His arccos mirrored them all
(errata): the decisions stand, the directions are mirrored. Which side patch 1 lies on is the mirror of his (9.2).
"""

from __future__ import annotations

from math import asin, degrees, pi

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.contact import end_mill_contact
from gearsim.gouging.borders import SectorResult, border_sectors, compare_sectors, tool_sectors
from gearsim.gouging.compare import Decision
from gearsim.gouging.khan.worked import WorkedRow, arcs_of, arcs_row, number_row, word_row
from gearsim.gouging.tensors import Tensor, principal_tensor

UPHILL = (0.662, -0.245, 0.708)
ACROSS = (0.346, 0.938, 0.0)
BORDER = (-0.728, 0.0, -0.685)
PATCHES = {
    "patch 1": ((0.0454, -0.0122), (-0.723, 0.027, -0.690)),
    "patch 2": ((0.0444, -0.1158), (-0.732, 0.025, -0.681)),
}
MILLS = (("9.6.1", 25.0, 12.0, ("0.083", "0.033")), ("9.6.2", 35.0, 25.0, ("0.04", "0.026")))
PRINTED_ANGLES = {"patch 1": "167", "patch 2": "165", "border": "165"}
PRINTED_ARCS = {
    "patch 1": ((0.0, 4.0), (141.0, 165.0), (345.0, 360.0)),
    "patch 2": ((165.0, 177.0), (336.0, 345.0)),
}
_MIRRORED = "mirrored by the arccos of (6.16)"


def direction_angle(vector: tuple[float, float, float]) -> float:
    """The angle [rad] of a tangent vector from T_t,max, counter-clockwise about n."""
    return float(np.arctan2(np.dot(vector, ACROSS), np.dot(vector, UPHILL)))


def theta0() -> float:
    """The contact's angle [rad], from T_t,max = cos(theta0) x + sin(theta0) a."""
    return asin(UPHILL[2])


def patch_tensors() -> dict[str, Tensor]:
    """The patches' tensors in the basis (T_t,max, T_t,min)."""
    return {name: principal_tensor(*k, direction_angle(t)) for name, (k, t) in PATCHES.items()}


def border_results(shank: float, corner: float) -> list[SectorResult]:
    """The comparison of a bull-nose mill with the two patches in their sectors."""
    tensors = patch_tensors()
    start = direction_angle(BORDER) % (2.0 * pi)
    contact = end_mill_contact(shank, corner, theta0())
    parts = border_sectors(list(tensors.values()), [start, start + pi], list(tensors))
    return compare_sectors(tool_sectors(contact), parts)


def gouging_arcs(results: list[SectorResult], patch: str) -> NDArray:
    """Gouging directions [deg] of one patch in its sector, shape (n, 2)."""
    return arcs_of(np.array([arc for r in results if r.part == patch for arc in r.gouging]))


def border_rows() -> list[WorkedRow]:
    """Tables 9-3, 9-4 and the two checks of 9.6, printed and ours."""
    rows = []
    for name, (_, vector) in PATCHES.items():
        angle = degrees(direction_angle(vector)) % 180.0
        remark = f"counter-clockwise it is {angle:.1f} deg: {_MIRRORED}"
        rows.append(number_row("9.6", f"alpha0 of {name} [deg]", PRINTED_ANGLES[name], angle, remark))
    border = degrees(direction_angle(BORDER)) % 360.0
    remark = f"counter-clockwise it is {border:.1f} deg: {_MIRRORED}"
    rows.append(number_row("9.6", "direction of the border B1 [deg]", PRINTED_ANGLES["border"], border, remark))
    for section, shank, corner, printed in MILLS:
        contact, results = end_mill_contact(shank, corner, theta0()), border_results(shank, corner)
        for name, digits, k in zip(("k_max", "k_min"), printed, (1.0 / corner, float(contact.around)), strict=True):
            rows.append(number_row(section, f"mill R = {shank:g}, r = {corner:g}: {name} [1/mm]", digits, k))
        decision = "gouges" if any(r.decision is Decision.GOUGES for r in results) else "free"
        expected = "free" if section == "9.6.1" else "gouges"
        rows.append(word_row(section, f"mill R = {shank:g}, r = {corner:g}: decision", expected, decision))
    for name, arcs in PRINTED_ARCS.items():
        ours = gouging_arcs(results, name)
        rows.append(arcs_row("9.6.2", f"gouging directions in {name} [deg]", np.array(arcs), ours, _MIRRORED))
        mirrored = np.array(sorted((360.0 - b, 360.0 - a) for a, b in ours))
        quantity, remark = (
            f"the same, mirrored back, in {name} [deg]",
            "one end lies 1.0 to 1.4 deg off, the rest agree",
        )
        rows.append(arcs_row("9.6.2", quantity, np.array(arcs), mirrored, remark))
    return rows
