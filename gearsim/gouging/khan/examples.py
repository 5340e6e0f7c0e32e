"""The worked examples of Khan's chapters 6 and 9 that need numbers only: printed beside ours.

Each is data; `gouging_rows` computes ours and the verdict. Inputs that print leaves out are those fixed in the errata
(6.2: theta0, alpha0). Angles alpha0 are right ones, counter-clockwise about n from T_t,max to T_s,max, mod 180 deg.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import radians, sqrt

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.contact import end_mill_contact
from gearsim.gouging.compare import Comparison, Decision, compare
from gearsim.gouging.khan.cases import case_numbers
from gearsim.gouging.khan.worked import WorkedRow, arcs_of, arcs_row, number_row, word_row
from gearsim.gouging.sizes import largest_shank
from gearsim.gouging.tensors import Tensor, principal_tensor

Arcs = tuple[tuple[float, float], ...]
_ALL: Arcs = ((0.0, 360.0),)


@dataclass(frozen=True)
class GougingExample:
    """Part against tool at one contact: principal curvatures [1/mm], alpha0 [deg], and what is printed.

    ``tool`` has k_max, k_min, or with ``mill`` = (R, r, theta0 in deg) what is printed for them. ``offset`` [deg] is
    the direction of T_t,max in the plot the arcs were read from: figures 6.3 to 6.8 start at T_s,max.
    """

    name: str
    section: str
    part: tuple[float, float]
    alpha0: float
    tool: tuple[str, str]
    mill: tuple[float, float, float] | None = None
    offset: float = 0.0
    case: int = 0
    gouges: bool = False
    arcs: Arcs | None = None
    remarks: tuple[tuple[str, str], ...] = ()

    def tool_curvatures(self) -> tuple[float, float]:
        """k_max and k_min of the tool [1/mm]: of the mill where there is one, not the rounded ones."""
        if self.mill is None:
            return float(self.tool[0]), float(self.tool[1])
        contact = end_mill_contact(self.mill[0], self.mill[1], radians(self.mill[2]))
        return 1.0 / self.mill[1], float(contact.around)

    def comparison(self) -> Comparison:
        high, low = self.tool_curvatures()
        tool = Tensor(np.array(high), np.array(0.0), np.array(low))
        return compare(tool, principal_tensor(*self.part, radians(self.alpha0)))

    def gouging_arcs(self) -> NDArray:
        """Gouging directions [deg] as in the plot, shape (n, 2)."""
        f = self.comparison()
        if f.decision != Decision.GOUGES:
            return np.empty((0, 2))
        if f.half_width >= 0.5 * np.pi - 1e-12:
            return np.array(_ALL)
        low, high = (float(x) + radians(self.offset) for x in f.interval)
        return arcs_of(np.array([(low, high), (low + np.pi, high + np.pi)]))


def _figure(name: str, section: str, tool: tuple[str, str], part: tuple[float, float], phase: float, case: int,
            arcs: Arcs, remark: str = "") -> GougingExample:  # fmt: skip
    remarks = (("arcs", remark),) if remark else ()
    return GougingExample(f"{name}, phase {phase:g} deg", section, part, -phase % 180.0, tool, offset=phase, case=case,
                          gouges=bool(arcs), arcs=arcs, remarks=remarks)  # fmt: skip


_SIDES: Arcs = ((0.0, 45.0), (135.0, 225.0), (315.0, 360.0))
_PARABOLA = 0.05 * sqrt(2.0)
_COARSE = "sin 45 deg/(5 + 15 sin 45 deg) is 0.0453, which no rounding makes 0.046"

GOUGING_EXAMPLES: tuple[GougingExample, ...] = (
    *(_figure("figure 6.3", "6.1.1", ("0.1", "0.0261"), (-0.01, -0.1), p, 1, ()) for p in (0.0, 45.0, 90.0)),
    *(_figure("figure 6.4", "6.1.2", ("0.1", "0.06"), (0.05, -0.03), p, 2, ()) for p in (0.0, 45.0, 90.0)),
    *(_figure("figure 6.5", "6.1.3", ("0.04", "0.0"), (0.1, 0.05), p, 3, _ALL) for p in (0.0, 45.0, 90.0)),
    _figure("figure 6.6", "6.1.4", ("0.08", "0.03"), (0.1, 0.01), 0.0, 4, _SIDES),
    _figure("figure 6.6", "6.1.4", ("0.08", "0.03"), (0.1, 0.01), 45.0, 4, ((0, 31), (121, 211), (301, 360))),
    _figure("figure 6.6", "6.1.4", ("0.08", "0.03"), (0.1, 0.01), 90.0, 4, _SIDES),
    _figure("figure 6.7", "6.1.5", ("0.1", "0.03"), (0.08, 0.05), 0.0, 5, ((45, 135), (225, 315))),
    _figure("figure 6.7", "6.1.5", ("0.1", "0.03"), (0.08, 0.05), 45.0, 5, ((0, 12), (101, 191), (281, 360))),
    _figure("figure 6.7", "6.1.5", ("0.1", "0.03"), (0.08, 0.05), 90.0, 5, _SIDES),
    _figure("figure 6.8", "6.1.6", ("0.1", "0.05"), (0.08, 0.02), 0.0, 6, ()),
    _figure("figure 6.8", "6.1.6", ("0.1", "0.05"), (0.08, 0.02), 45.0, 6, ((0, 5), (135, 185), (315, 360))),
    _figure("figure 6.8", "6.1.6", ("0.1", "0.05"), (0.08, 0.02), 90.0, 6, ((0, 31), (148.1, 211), (328.1, 360)),
            "f is even: ends like 31 and 328.1, or 148.1 and 211, must mirror each other"),
    GougingExample("bull-nose mill on a NURBS part", "6.2", (0.0575, 0.0109), 73.108, ("0.25", "0.0246"),
                   (12.0, 4.0, 12.608), case=6, gouges=True, arcs=((68, 107), (248, 287)),
                   remarks=(("arcs", "theta0 and alpha0 are fitted (errata)"),)),
    GougingExample("horizontal cylinder", "9.1.1", (0.05, 0.0), 0.0, ("0.07", "0.046"), (20.0, 15.0, 45.0), case=6,
                   arcs=(), remarks=(("k_min", _COARSE),)),
    GougingExample("horizontal free form", "9.1.2", (_PARABOLA, 0.0), 0.0, ("0.066", "0.046"), (20.0, 15.0, 45.0),
                   case=4, gouges=True, arcs=((0, 16), (163, 197), (344, 360)),
                   remarks=(("k_min", _COARSE), ("arcs", "the text says greater, it means less"))),
    GougingExample("vertical cylinder", "9.3.1", (0.05, 0.0), 90.0, ("0.066", "0.05"), (20.0, 15.0, 90.0), case=2,
                   arcs=(), remarks=(("decision", "as a tie: R is the cylinder's radius"),)),
    GougingExample("vertical free form", "9.3.2", (_PARABOLA, 0.0), 90.0, ("0.066", "0.05"), (20.0, 15.0, 90.0),
                   case=4, gouges=True,
                   remarks=(("decision", "theta0 is 90 deg, not 0; the shank gouges too"),)),
    GougingExample("horizontal cylinder, larger mill", "9.4", (0.05, 0.0), 0.0, ("0.1", "0.02"), (30.0, 10.0, 45.0),
                   case=6),
    GougingExample("vertical cylinder, larger mill", "9.4", (0.05, 0.0), 90.0, ("0.1", "0.033"), (30.0, 10.0, 90.0),
                   case=6, gouges=True),
)  # fmt: skip


def gouging_rows(examples: tuple[GougingExample, ...] = GOUGING_EXAMPLES) -> list[WorkedRow]:
    """Curvatures, case, decision and directions of each example, printed and ours."""
    rows = [row for example in examples for row in _rows(example)]
    return [*rows, *_more_rows()]


def _more_rows() -> Iterator[WorkedRow]:
    """The width printed for the second zone of 6.2, and a flat end mill in a bowl by (6.24)."""
    verification = next(e for e in GOUGING_EXAMPLES if e.section == "6.2")
    width = 2.0 * np.degrees(float(verification.comparison().half_width))
    yield number_row("6.2", "width of the first zone [deg]", "39", width)
    yield number_row("6.2", "width of the second zone [deg]", "43", width, "both zones are alike, and 287 - 248 is 39")
    bowl, eta = 20.0, radians(30.0)
    largest = float(largest_shank(0.0, eta, principal_tensor(1.0 / bowl, 1.0 / bowl)))
    remark = "(6.24) needs sin(eta): the level section of a sphere has the radius 20 sin(30 deg)"
    yield number_row("6.3", "flat end mill's largest R in a bowl of 20 mm, eta = 30 deg [mm]", "17.3", largest, remark)


def _rows(example: GougingExample) -> Iterator[WorkedRow]:
    remarks, f = dict(example.remarks), example.comparison()
    high, low = example.tool_curvatures()
    if example.mill is not None:
        pairs = zip(("k_max", "k_min"), example.tool, (high, low), strict=True)
        for name, printed, ours in pairs:
            quantity = f"{example.name}: {name} of the tool [1/mm]"
            yield number_row(example.section, quantity, printed, ours, remarks.get(name, ""))
    number = str(int(case_numbers(high, low, *example.part)))
    yield word_row(example.section, f"{example.name}: case", str(example.case), number, remarks.get("case", ""))
    decided, found = "gouges" if example.gouges else "free", Decision(int(f.decision)).name.lower()
    row = word_row(example.section, f"{example.name}: decision", decided, found, remarks.get("decision", ""))
    yield row._replace(agrees=True, verdict=f"reproduces; {remarks['decision']}") if found == "tie" else row
    if example.arcs is not None:
        arcs = np.array(example.arcs, dtype=float).reshape(-1, 2)
        quantity = f"{example.name}: gouging directions [deg]"
        yield arcs_row(example.section, quantity, arcs, example.gouging_arcs(), remarks.get("arcs", ""))
