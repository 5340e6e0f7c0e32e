"""What a formula claims about a machined surface, in the form that ``gearsim verify`` can check."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.element import Element
from gearsim.cutters.profile import Profile
from gearsim.envelope.surface import BRANCHES, envelope_points
from gearsim.errors import InputError
from gearsim.geometry.jets import Curvature
from gearsim.motion.sources import MotionSource
from gearsim.verify.shared import SharedPoses

_UNIT = 1e-9


@dataclass(frozen=True)
class Claimed:
    """Claims about n points of a machined surface, workpiece frame.

    ``point`` [mm] and unit ``normal`` out of the material (out of the gear, into the tool that cuts it there),
    shape (n, 3). Optional: ``exists``, shape (n,), False where the formula has no point (default: where all
    numbers are finite); ``curvature``, its sign such that a bulge of the material is negative; ``t`` (0 to
    1) and ``piece``, shape (n,), the pose of the motion that is said to cut the point (default piece: 0).
    """

    point: NDArray
    normal: NDArray
    exists: NDArray | None = None
    curvature: Curvature | None = None
    t: NDArray | None = None
    piece: NDArray | None = None

    @property
    def there(self) -> NDArray:
        """Where the formula has a point, shape (n,)."""
        finite = np.isfinite(self.point).all(axis=1) & np.isfinite(self.normal).all(axis=1)
        return finite if self.exists is None else finite & self.exists

    @property
    def pieces(self) -> NDArray:
        """The claimed pieces, 0 where none were given."""
        return np.zeros(len(self.point), dtype=int) if self.piece is None else self.piece


@dataclass(frozen=True)
class ClosedForm:
    """A machined surface in closed form: ``points(u, v)`` for u and v in [0, 1], both shape (n,).

    ``cutter`` on the exact ``motion`` is what brute force moves. ``joints`` are values of u across which the
    surface is not smooth. ``flank`` says which flank it belongs to.
    """

    name: str
    motion: MotionSource
    cutter: Profile
    points: Callable[[NDArray, NDArray], Claimed]
    flank: str = ""
    joints: tuple[float, ...] = ()

    def claims(self, u: NDArray, v: NDArray) -> Claimed:
        """``points(u, v)``, checked: raises InputError where shapes or normals are wrong."""
        claimed = self.points(u, v)
        _check(claimed, len(u), self.name)
        return claimed


def _check(claimed: Claimed, count: int, name: str) -> None:
    for field in ("point", "normal"):
        shape = np.shape(getattr(claimed, field))
        if shape != (count, 3):
            raise InputError(f"{name}: points(u, v) gave a {field} of shape {shape}; expected {(count, 3)}")
    columns = {"exists": claimed.exists, "t": claimed.t, "piece": claimed.piece}
    if claimed.curvature is not None:
        columns |= {k: getattr(claimed.curvature, k) for k in ("gaussian", "mean", "k1", "k2")}
    for field, column in columns.items():
        if column is not None and np.shape(column) != (count,):
            raise InputError(f"{name}: points(u, v) gave {field} of shape {np.shape(column)}; expected {(count,)}")
    length = np.linalg.norm(claimed.normal[claimed.there], axis=1)
    if np.abs(length - 1.0).max(initial=0.0) > _UNIT:
        worst = length[np.argmax(np.abs(length - 1.0))]
        raise InputError(f"{name}: points(u, v) gave a normal of length {worst:.10g}; expected 1")


def principal(k1: NDArray, k2: NDArray) -> Curvature:
    """A curvature [1/mm] known by its principal values alone, in any order; directions are nan."""
    unknown = np.full((*np.shape(k1), 3), np.nan)
    return Curvature(k1 * k2, 0.5 * (k1 + k2), np.maximum(k1, k2), np.minimum(k1, k2), unknown, unknown)


def envelope_form(
    name: str, source: MotionSource, cutter: Profile, element: int, branch: float,
    t_range: tuple[float, float] = (0.0, 1.0), flank: str = "",
) -> ClosedForm:  # fmt: skip
    """The closed-form envelope of one profile element: u runs along the motion, v along the element.

    ``branch`` is +1 or -1, the side of the tool (see geometry/grazing.py); ``t_range`` is the part of the whole
    motion to check, as fractions of its pieces.
    """
    source = SharedPoses(source)
    first, last = (source.pieces * t for t in t_range)
    length = cutter.elements[element].length

    def points(u: NDArray, v: NDArray) -> Claimed:
        time = first + u * (last - first)
        piece = np.clip(np.floor(time).astype(int), 0, source.pieces - 1)
        where = (piece, time - piece, np.full(len(u), element), v * length, np.full(len(u), branch))
        grazing = envelope_points(source, cutter, *where)
        return Claimed(grazing.point, -grazing.normal, grazing.exists, grazing.curvature(), time - piece, piece)

    joints = (np.arange(np.floor(first) + 1.0, last) - first) / (last - first)
    return ClosedForm(name, source, cutter, points, flank, tuple(joints.tolist()))


def envelope_forms(
    source: MotionSource, cutter: Profile, flank: str = "", elements: tuple[int, ...] | None = None
) -> list[ClosedForm]:
    """Both branches of the envelopes of profile elements; by default all but the tool's top."""
    return [
        envelope_form(f"{name}, branch {branch:+.0f}", source, cutter, element, branch, flank=flank)
        for element, name in _named(cutter, flank, elements)
        for branch in BRANCHES
    ]


def pose_forms(
    source: MotionSource, cutter: Profile, flank: str = "", elements: tuple[int, ...] | None = None
) -> list[ClosedForm]:
    """The tool as it stands at both ends of a motion, one profile element each; by default all but its top."""
    return [
        pose_form(f"{name}, {end} pose", source, cutter, element, t, flank)
        for element, name in _named(cutter, flank, elements)
        for end, t in (("first", 0.0), ("last", 1.0))
    ]


def _named(cutter: Profile, flank: str, elements: tuple[int, ...] | None) -> list[tuple[int, str]]:
    """Profile elements with names that tell them apart."""
    if elements is None:
        elements = tuple(range(len(cutter.elements) - (0 if cutter.is_ring else 1)))
    names = [element_name(cutter.elements[i]) for i in elements]
    prefix = f"{flank}: " if flank else ""
    return [(i, f"{prefix}{n} {i}" if names.count(n) > 1 else prefix + n) for i, n in zip(elements, names, strict=True)]


def pose_form(
    name: str, source: MotionSource, cutter: Profile, element: int, t: float, flank: str = ""
) -> ClosedForm:  # fmt: skip
    """One profile element of the tool standing at ``t`` of the motion, as fraction of its pieces: a plunge's end.

    u runs once round the axis, v along the element; the curvature is that of a surface of revolution.
    """
    source = SharedPoses(source)
    length, piece = cutter.elements[element].length, min(int(t * source.pieces), source.pieces - 1)
    at = t * source.pieces - piece
    pose = source.pose(np.array([piece]), np.array([at]), 0)
    tip, axis = pose.tip.value[0], pose.axis.value[0]
    x = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    x /= np.linalg.norm(x)

    def points(u: NDArray, v: NDArray) -> Claimed:
        m = cutter.elements[element].at(v * length)
        angle = 2.0 * np.pi * u[:, None]
        radial = np.cos(angle) * x + np.sin(angle) * np.cross(axis, x)
        point = tip + m.z[:, None] * axis + m.r[:, None] * radial
        normal = -(m.nr[:, None] * radial + m.nz[:, None] * axis)
        with np.errstate(invalid="ignore", divide="ignore"):
            curvature = principal(m.curvature, m.nr / m.r)
        return Claimed(point, normal, None, curvature, np.full(len(u), at), np.full(len(u), piece))

    return ClosedForm(name, source, cutter, points, flank)


def file_name(form: str) -> str:
    """A form's name as part of a file's."""
    return re.sub(r"[^a-z0-9]+", "-", form.lower().replace("+", "plus").replace("-1", "minus1")).strip("-")


def element_name(element: Element) -> str:
    """What surface a profile element sweeps about the axis."""
    if element.is_arc:
        return "ball" if element.centre[0] == 0.0 else "torus"
    if element.is_flat:
        return "disc" if min(element.start[0], element.end[0]) == 0.0 else "annulus"
    return "cylinder" if abs(element.end[0] - element.start[0]) <= 1e-12 * element.length else "cone"
