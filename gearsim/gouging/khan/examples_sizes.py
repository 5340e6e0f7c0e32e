"""Tool sizes of Khan's chapters 7, 9.2 and 9.5: printed, his algorithm as we run it, and the true optimum.

The surfaces of chapter 9 are known in closed form: the cylinder of radius 20 mm, and the parabola (20 (1 - t)², 20 t²)
of the free form, extruded; seen lying ("horizontal": theta0 runs from 0 to 90 deg) and standing (theta0 = 90 deg).
The contacts theta0 = 0 of the lying ones are left out: there a flat bottom gouges every concave part.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import radians

import numpy as np
from numpy.typing import NDArray

from gearsim.gouging.compare import TIE
from gearsim.gouging.khan.sizes import khan_joint, khan_mill
from gearsim.gouging.khan.worked import WorkedRow, number_row, word_row
from gearsim.gouging.sizes import largest_joint_mill, least_difference
from gearsim.gouging.standard_mills import khan_mills
from gearsim.gouging.tensors import Tensor, principal_tensor


@dataclass(frozen=True)
class SizeExample:
    """Contacts, theta [rad] of shape (n,) with the part's tensors, and the mill printed for them (None: none)."""

    name: str
    section: str
    theta: NDArray
    part: Tensor
    printed: tuple[float, float] | None
    remark: str = ""

    @property
    def khan(self) -> tuple[float, float]:
        """His algorithm's R and r [mm], the least over the contacts; nan: impossible."""
        return khan_joint(khan_mill(self.theta, self.part))

    @property
    def best(self) -> tuple[float, float]:
        """The largest R and r [mm] of his catalogue that gouge at no contact; nan: none."""
        choice = largest_joint_mill(khan_mills(), self.theta, self.part)
        return choice.shank, choice.corner

    def gouges(self, mill: tuple[float, float]) -> bool:
        return bool(np.min(least_difference(*mill, self.theta, self.part)) < -TIE)


def _point(name: str, section: str, part: tuple[float, float], alpha0: float, theta0: float,
           printed: tuple[float, float] | None, remark: str = "") -> SizeExample:  # fmt: skip
    tensor = principal_tensor([part[0]], [part[1]], [radians(alpha0)])
    return SizeExample(name, section, np.array([radians(theta0)]), tensor, printed, remark)


def _parabola(count: int = 201) -> tuple[NDArray, NDArray]:
    """Angle of the normal from the axis [rad] and curvature [1/mm] of the parabola inside its ends."""
    t = np.linspace(0.0, 1.0, count)[1:-1]
    return np.arctan2(t, 1.0 - t), 0.025 / ((1.0 - t) ** 2 + t**2) ** 1.5


def _lying(k: NDArray) -> Tensor:
    return principal_tensor(k, 0.0 * k, 0.0)


def _standing(k: NDArray) -> Tensor:
    return Tensor(0.0 * k, 0.0 * k, k)


def size_examples() -> tuple[SizeExample, ...]:
    """The examples, with the inputs that print leaves out as fixed in the errata (theta0, ks_min of 7.3.1)."""
    angle, k = _parabola()
    cylinder, wall = np.full(len(k), 0.05), np.full(len(k), 0.5 * np.pi)
    return (
        _point("case (a)", "7.1", (0.5, -0.2), 40.0, 5.788, None),
        _point("case (b), any convex part", "7.2", (-0.02, -0.05), 0.0, 5.788, (30.0, 30.0), "r is left open in print"),
        _point("case (c i)", "7.3.1", (0.1, -0.03), 20.0, 5.618, (30.0, 5.6), "ks_min and theta0 are fitted"),
        _point("case (c ii)", "7.3.2", (0.1, 0.01), 20.0, 5.618, (8.0, 5.6),
               "the ball R = r = 10 is a tie, and of R = 8 the first r that fits is 8; r = 5.6 is that of 7.3.1"),
        SizeExample("lying cylinder", "9.2", angle, _lying(cylinder), (30.0, 20.0), "a tie along the meridian"),
        SizeExample("lying free form", "9.2", angle, _lying(k), (30.0, 15.0),
                    "r = 15 gouges where k is 0.0707; 1/0.0707 is 14.1"),
        SizeExample("standing cylinder", "9.5", wall, _standing(cylinder), (16.0, 16.0),
                    "18 is less than the limit of 20 and fits; 20 is a tie"),
        SizeExample("standing free form", "9.5", wall, _standing(k), (12.0, 11.0),
                    "R = 12 reproduces; of R = 12 the first r that fits is 12"),
    )  # fmt: skip


def size_rows(examples: tuple[SizeExample, ...]) -> list[WorkedRow]:
    """Each example's printed size beside his algorithm and the true optimum, then the numbers on the way."""
    rows = []
    for e in examples:
        ours = _mill_text(e.khan)
        row = word_row(e.section, f"{e.name}: R, r [mm]", _mill_text(e.printed), ours, e.remark)
        print_gouges = e.printed is not None and e.gouges(e.printed)
        note = f"; true optimum {_mill_text(e.best)}" + ("; the printed mill gouges" if print_gouges else "")
        rows.append(row._replace(verdict=row.verdict + note))
    return [*rows, *_steps(), _counter_example()]


def _steps() -> list[WorkedRow]:
    """Numbers printed on the way to the sizes."""
    points = {e.section: e for e in size_examples() if e.section.startswith("7")}
    along, across = (float(points[s].part.c[0]) for s in ("7.3.1", "7.3.2"))
    limit = float(khan_mill(points["7.3.2"].theta, points["7.3.2"].part).limit[0])
    return [
        number_row("7.3.1", "k_s(T_t,min) [1/mm]", "-0.015", along, "ks_min is fitted"),
        number_row("7.3.2", "k_s(T_t,min) [1/mm]", "0.021", across),
        number_row("7.3.2", "R_temp [mm]", "13.79", limit, "theta0 is fitted to it"),
        number_row("9.2", "free form: k_max of the mill r = 15 [1/mm]", "0.071", 1.0 / 15.0,
                   "0.071 is 1/14.1, the part's own curvature"),
        number_row("9.2", "free form: k_min of the mill R = 30, r = 15 [1/mm]", "0.028",
                   np.sqrt(0.5) / (15.0 + 15.0 * np.sqrt(0.5))),
        number_row("9.2", "cylinder: k_min of the mill R = 30, r = 20 [1/mm]", "0.03",
                   np.sqrt(0.5) / (10.0 + 20.0 * np.sqrt(0.5))),
        number_row("9.5", "cylinder: curvatures of the ball R = 16 [1/mm]", "0.063", 1.0 / 16.0),
        number_row("9.5", "free form: k_max of the mill r = 11 [1/mm]", "0.091", 1.0 / 11.0),
        number_row("9.5", "free form: k_min of the mill R = 12 [1/mm]", "0.083", 1.0 / 12.0),
    ]  # fmt: skip


def _counter_example() -> WorkedRow:
    """7.1 calls a part impossible where the mill R = 6, r = 2 gouges: not so in a bowl of 10 mm."""
    bowl = _point("bowl of radius 10 mm", "7.1", (0.1, 0.1), 0.0, 5.8, None)
    smallest = khan_mill(bowl.theta, bowl.part).smallest_gouges[0]
    ours = _mill_text((8.0, 8.0)) if smallest and not bowl.gouges((8.0, 8.0)) else "none"
    return word_row("7.1", "bowl of radius 10 mm, theta0 5.8 deg, where R = 6, r = 2 gouges: R, r [mm]", "none", ours,
                    "k_min falls with r: a small corner does not help")  # fmt: skip


def _mill_text(mill: tuple[float, float] | None) -> str:
    if mill is None or not np.all(np.isfinite(mill)):
        return "none"
    return f"{mill[0]:g}, {mill[1]:.4g}"
