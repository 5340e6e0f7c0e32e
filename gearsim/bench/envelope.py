"""Benchmark suite `envelope`: closed form against equation of meshing, three ways to curvature (Zhou 3.5, 3.6).

The workload is Zhou's generated face-milled gear (tables 3.3 and 3.4): the inside blades' cone, rolled by the
cradle, generates the convex flank. 100 contact lines of 100 or 1000 points between toe and heel.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, radians, sin, tan
from statistics import median
from time import perf_counter, thread_time
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Element, Profile
from gearsim.envelope.surface import envelope_grid, envelope_points, prepare_envelope
from gearsim.errors import NumericalError
from gearsim.geometry.grazing import MeridianPoints, PoseJet, grazing_points
from gearsim.geometry.jets import Curvature, rodrigues_curvature
from gearsim.geometry.meshing import (
    generated_curvature,
    meshing_angle,
    meshing_angle_newton,
    meshing_coefficients,
    meshing_lever,
    tool_point,
)
from gearsim.machines.generator import CradleGenerator
from gearsim.motion.sources import CurveMotion

_LINES, _PER_LINE, _LARGE = 100, (100, 1000), (10_000,)
_ROUNDS = 11
_AGREE = 1e-9
_BRANCH = -1.0  # the branch that is the convex flank
_START = -0.4  # Newton's first blade angle [rad]: the middle of the flank
_ROLL = (-0.24, 0.12)  # cradle angles [rad] whose contact lines cross the face
_BLADE, _TIP, _HEIGHT, _FILLET = radians(22.0), 63.5 - 0.5 * 2.54, 8.0, 1.524
_LINE = Element((_TIP - _HEIGHT * tan(_BLADE), _HEIGHT), (_TIP, 0.0))
# Table 3.4 has the sliding base and the blank offset exchanged (errata)
_GENERATOR = CradleGenerator(64.3718, radians(-56.78), radians(69.59), 1.0323, sliding_base=-0.2071)
_COLUMNS = ("case", "points", "ms", "spread", "ns/point", "ratio", "ratio in Zhou", "agrees to")

Results = tuple[NDArray, ...]


class Workload(NamedTuple):
    """What every method gets, a row a point, (n, 3) or (n,): the same arrays for all.

    ``x`` and ``y`` are the head's own axes and ``theta`` the blade angle [rad] of the contact from x to y:
    the closed form uses none of them, Litvin's elimination takes theta as its parameter instead of the place
    on the blade.
    """

    pose: PoseJet
    x: NDArray
    y: NDArray
    meridian: MeridianPoints
    branch: NDArray
    theta: NDArray


def workload(per_line: int) -> Workload:
    """Contact lines of the convex flank within the face, ``per_line`` points on each."""
    roll = np.linspace(*_ROLL, _LINES)
    first, last = _in_face(roll)
    fraction = (np.arange(per_line) + 0.5) / per_line
    s = (first[:, None] + (last - first)[:, None] * fraction).ravel()
    frames = _GENERATOR.frames(np.repeat(roll, per_line), 2)
    pose, x = _pose_jet(frames.pose), frames.radial.value
    y = np.cross(pose.axis, x)
    meridian, branch = _LINE.at(s), np.full(len(s), _BRANCH)
    theta = meshing_angle(*meshing_coefficients(pose, meridian, x, y), branch)
    return Workload(pose, x, y, meridian, branch, theta)


def _in_face(roll: NDArray) -> tuple[NDArray, NDArray]:
    """First and last arc length of each contact line between toe and heel (cone distances 55.17 to 82.67 mm)."""
    s = np.linspace(0.0, _LINE.length - _FILLET * (1.0 - sin(_BLADE)) / cos(_BLADE), 400)
    n = len(s) * len(roll)
    pose = _pose_jet(_GENERATOR.poses(np.repeat(roll, len(s)), 2))
    g = grazing_points(pose, _LINE.at(np.tile(s, len(roll))), np.full(n, _BRANCH))
    distance = np.linalg.norm(g.point, axis=1)
    inside = (g.exists & (distance > 55.1707) & (distance < 82.6707)).reshape(len(roll), len(s))
    return s[np.argmax(inside, axis=1)], s[len(s) - 1 - np.argmax(inside[:, ::-1], axis=1)]


def _pose_jet(pose: Any) -> PoseJet:
    pairs = zip(pose.tip.derivatives(), pose.axis.derivatives(), strict=True)
    return PoseJet(*(d for pair in pairs for d in pair))


def closed_form(w: Workload) -> Results:
    """Geometric envelope: points and the tool's normals (Zhou 2.34, 2.35)."""
    axis, (r, z, nr, cosine) = w.pose.axis, w.meridian[:4]
    rho = r / nr
    h = z - rho * cosine
    v = w.pose.tip_rate + h[:, None] * w.pose.axis_rate
    across = np.cross(axis, v)
    size2, along = _dot(across, across), _dot(axis, v)
    speed2 = size2 + along * along
    root = np.sqrt(size2 - cosine * cosine * speed2) * w.branch
    n = (cosine * speed2)[:, None] * axis - (along * cosine)[:, None] * v + root[:, None] * across
    n /= size2[:, None]
    return w.pose.tip + h[:, None] * axis + rho[:, None] * n, n


def meshing_closed(w: Workload) -> Results:
    """Equation of meshing as A cos theta + B sin theta = C, solved in closed form."""
    return tool_point(w.pose, w.meridian, _radial(w, meshing_angle(*_coefficients(w), w.branch)))


def meshing_newton(w: Workload) -> Results:
    """The same by Newton's method, as the literature does: one start for all points."""
    return tool_point(w.pose, w.meridian, _radial(w, meshing_angle_newton(*_coefficients(w), start=_START)))


def meshing_linear(w: Workload) -> Results:
    """Litvin and Chen's own elimination: the blade angle is given, the place on the blade follows (11)."""
    nr, nz = float(w.meridian.nr[0]), float(w.meridian.nz[0])
    offset = float(w.meridian.r[0] * nr + w.meridian.z[0] * nz)  # the line's distance from the tip plane's centre
    radial = _radial(w, w.theta)
    lever = meshing_lever(w.pose, nr, nz, radial)
    place = MeridianPoints(offset * nr - lever * nz, offset * nz + lever * nr, *w.meridian[2:])
    return tool_point(w.pose, place, radial)


def fundamental(w: Workload) -> Results:
    """Closed form with derivatives, then both fundamental forms."""
    return _measures(grazing_points(w.pose, w.meridian, w.branch).curvature())


def rodrigues(w: Workload) -> Results:
    """Closed form with derivatives, then Rodrigues' formula."""
    g = grazing_points(w.pose, w.meridian, w.branch)
    return _measures(rodrigues_curvature(g.point_s, g.point_t, -g.normal_s, -g.normal_t, -g.normal))


def gearing(w: Workload) -> Results:
    """Equation of meshing in closed form, then the tool's curvature carried over by the motion's."""
    radial = _radial(w, meshing_angle(*_coefficients(w), w.branch))
    return _measures(generated_curvature(w.pose, w.meridian, radial))


def closed_form_gearing(w: Workload) -> Results:
    """Closed-form normals, then the tool's curvature carried over by the motion's."""
    _, n = closed_form(w)
    radial = (n - w.meridian.nz[:, None] * w.pose.axis) / w.meridian.nr[:, None]
    return _measures(generated_curvature(w.pose, w.meridian, radial))


def _measures(c: Curvature) -> Results:
    return c.gaussian, c.mean, c.k1, c.k2


def _coefficients(w: Workload) -> tuple[NDArray, NDArray, NDArray]:
    return meshing_coefficients(w.pose, w.meridian, w.x, w.y)


def _radial(w: Workload, theta: NDArray) -> NDArray:
    return np.cos(theta)[:, None] * w.x + np.sin(theta)[:, None] * w.y


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("ij,ij->i", a, b)


Method = Callable[[Workload], Results]
# The first method of a group is what the others are divided by: Litvin's way, as in Zhou's tables.
_MESHING: dict[str, Method] = {
    "points: meshing, theta in closed form": meshing_closed,
    "points: meshing, theta by Newton": meshing_newton,
    "points: meshing, blade place from theta": meshing_linear,
    "points: geometric envelope": closed_form,
}
_CURVATURE: dict[str, Method] = {
    "curvature: theory of gearing": gearing,
    "curvature: fundamental forms": fundamental,
    "curvature: Rodrigues": rodrigues,
    "curvature: envelope + theory of gearing": closed_form_gearing,
}
_ZHOU: dict[tuple[Method, int], float] = {
    (closed_form, 100): 0.652, (closed_form, 1000): 0.459, (fundamental, 100): 0.848, (fundamental, 1000): 0.813,
    (rodrigues, 100): 0.836, (rodrigues, 1000): 0.781,
}  # fmt: skip


def envelope(device: str, size: str) -> dict[str, Any]:
    """Zhou's tables 3.5 and 3.6 measured again: the same arrays for every method, results compared first."""
    rows = []
    for per_line in (*_PER_LINE, *(_LARGE if size == "large" else ())):
        w = workload(per_line)
        for group in (_MESHING, _CURVATURE):
            rows += _race(group, w, per_line)
        rows.append(_warp_row(per_line, device))
    return {"columns": list(_COLUMNS), "rows": rows, "notes": _notes(rows)}


def _race(methods: dict[str, Method], w: Workload, per_line: int) -> list[dict[str, Any]]:
    """Rows of one group; rounds run the methods in turn, a ratio is the median of the rounds' own ratios."""
    results = [method(w) for method in methods.values()]
    worst = [disagreement(r, results[0]) for r in results]
    for name, miss in zip(methods, worst, strict=True):
        if not miss <= _AGREE:
            raise NumericalError(f"{name} disagrees with its rivals by {miss:.2g}; nothing was timed")
    times = np.array([[_seconds(method, w) for method in methods.values()] for _ in range(_ROUNDS)])
    rows = []
    for k, (name, method) in enumerate(methods.items()):
        ratio = float(np.median(times[:, k] / times[:, 0]))
        zhou: float | str = _ZHOU.get((method, per_line), "-")
        rows.append(_row(name, len(w.theta), list(times[:, k]), ratio, zhou, worst[k]))
    return rows


def disagreement(a: Results, b: Results) -> float:
    """Largest difference of any value, relative to the largest one of its kind; infinite where one is nan."""
    misses = [np.max(np.abs(x - y)) / np.max(np.abs(y)) for x, y in zip(a, b, strict=True)]
    return float(np.max(np.where(np.isnan(misses), np.inf, misses)))


def _seconds(method: Method, w: Workload) -> float:
    started = thread_time()
    method(w)
    return thread_time() - started


def _row(
    name: str, points: int, seconds: list[float], ratio: float | str, zhou: float | str, worst: float
) -> dict[str, Any]:
    s = median(seconds)
    return {
        "case": name,
        "points": points,
        "ms": 1e3 * s,
        "spread": (max(seconds) - min(seconds)) / s,
        "ns/point": 1e9 * s / points,
        "ratio": ratio,
        "ratio in Zhou": zhou,
        "agrees to": worst,
    }


def _warp_row(per_line: int, device: str) -> dict[str, Any]:
    """The closed form as a Warp kernel: a rectangular grid of the whole head, both branches, copies included."""
    outer = 63.5 + 0.5 * 2.54
    high = outer + _HEIGHT * tan(_BLADE)
    land, flank = Element((_TIP, 0.0), (outer, 0.0)), Element((outer, 0.0), (high, _HEIGHT))
    head = Profile("head", (land, flank, Element((high, _HEIGHT), _LINE.start), _LINE))
    source = CurveMotion(_GENERATOR.poses, *_ROLL)
    prepare_envelope(device)
    each = per_line // (2 * len(head.elements))  # as many circles and branches as the others have points
    clock, seconds = thread_time if device == "cpu" else perf_counter, []
    for _ in range(_ROUNDS):
        started = clock()
        grid = envelope_grid(source, head, _LINES, each, device)
        seconds.append(clock() - started)
    i, j = np.nonzero(grid.exists[..., 1] & (grid.element == 3))
    twin = envelope_points(source, head, grid.piece[i], grid.t[i], grid.element[j], grid.s[j], np.full(len(i), _BRANCH))
    worst = disagreement((grid.point[i, j, 1], grid.normal[i, j, 1]), (twin.point, twin.normal))
    if not worst <= _AGREE:
        raise NumericalError(f"the Warp kernel disagrees with NumPy by {worst:.2g}")
    return _row("points: geometric envelope, Warp", grid.exists.size, seconds, "-", "-", worst)


def _notes(rows: list[dict[str, Any]]) -> list[str]:
    lines = [
        f"Median of {_ROUNDS} rounds in one process, CPU time of one thread (on CUDA the Warp row is wall time), NumPy "
        "float64, the same input arrays; every result was compared with its group's first before it was timed (agrees "
        "to: relative). spread: (slowest - fastest)/median; ratio: time over that of the group's first row.",
        "meshing: the equation of meshing; blade place from theta: Litvin's elimination, with the blade angle given in "
        "place of the point of the blade. The curvature rows begin at the poses. Warp: copies to and fro included.",
    ]
    return [*lines, *(_reading(rows, per_line) for per_line in _PER_LINE)]


def _reading(rows: list[dict[str, Any]], per_line: int) -> str:
    """Our ratios beside Zhou's, whose text does not say how his equation of meshing was solved."""
    mine = {r["case"]: r for r in rows if r["points"] == _LINES * per_line}
    ours = mine["points: geometric envelope"]
    per = {how: ours["ms"] / mine[f"points: meshing, theta {how}"]["ms"] for how in ("by Newton", "in closed form")}
    forms, rodri = (mine[f"curvature: {name}"] for name in ("fundamental forms", "Rodrigues"))
    return (
        f"{_LINES} x {per_line}: geometric envelope / equation of meshing {per['by Newton']:.2f} (Newton), "
        f"{per['in closed form']:.2f} (closed form); in Zhou's table 3.5 {ours['ratio in Zhou']:.3f}, solver not said. "
        f"Over theory of gearing: fundamental forms {forms['ratio']:.2f}, Rodrigues {rodri['ratio']:.2f}; in Zhou's "
        f"table 3.6 {forms['ratio in Zhou']:.3f} and {rodri['ratio in Zhou']:.3f}."
    )
