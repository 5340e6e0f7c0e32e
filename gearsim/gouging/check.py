"""A user's own faces looked at for local gouging: ``gearsim gouge``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.gouging.fitting import contacts_of, largest_for_all
from gearsim.gouging.joins import find_places, join_tolerance
from gearsim.gouging.junctions import Join, Junctions, junctions, least_at_sides, least_on_ridges
from gearsim.gouging.khan.sizes import SideBySide
from gearsim.gouging.lines import Lines, face_lines, longest_line
from gearsim.gouging.looked import FaceLook, look
from gearsim.gouging.prediction import Prediction, at_one
from gearsim.gouging.tool import cutter_tool
from gearsim.gouging.verdict import doubts, headline, judge
from gearsim.metrology.verdict import Verdict
from gearsim.surfaces.face import Face


@dataclass(frozen=True)
class TightPlace:
    """Where a tool gouges most or is closest to it.

    ``face``: the number of a face in the check, with its parameters ``u``, ``v`` and what is predicted there; where
    faces meet ``face`` is that which is touched, ``meets`` says how, and nothing but ``least`` [1/mm] is predicted.
    """

    face: int
    u: float
    v: float
    point: tuple[float, float, float]
    least: float
    contact: Prediction | None
    meets: str = ""
    with_face: int = -1


@dataclass(frozen=True)
class GougeCheck:
    """The faces of a file looked at for local gouging by one tool, nothing cut.

    ``met``: where faces and pieces of faces meet, with the tool's least difference of curvature at every side and on
    every convex edge. ``whole``: one mill for everything (None: none reaches anything), limited at ``place`` [mm].
    ``worst``: None where the tool reaches nothing. ``tolerance`` [mm]: how far apart faces still meet. ``doubts``: why
    not everything could be judged. ``skipped``: what could not be read; ``left_out``: faces not asked for;
    ``margin``: the share of every face left out at its borders. ``notes``: what else a reader must know.
    """

    name: str
    device: str
    verdict: Verdict
    status: str
    seconds: float
    frame: str
    looks: tuple[FaceLook, ...]
    cutter: Profile
    axis: NDArray
    met: Junctions
    at_sides: NDArray
    on_ridges: NDArray
    tolerance: float
    mills: NDArray
    whole: SideBySide | None
    place: tuple[float, ...]
    worst: TightPlace | None
    doubts: tuple[str, ...]
    skipped: tuple[str, ...]
    left_out: int
    margin: float
    notes: tuple[str, ...]

    @property
    def least_at_places(self) -> NDArray:
        """The tool's least difference of curvature [1/mm] at each place of ``met``, inf where it touches none."""
        least = np.full(self.met.places.count, np.inf)
        sides, ridges = self.met.sides.place, self.met.ridges.side
        for place, values in ((sides, self.at_sides), (sides[ridges], self.on_ridges)):
            np.minimum.at(least, place, np.where(np.isnan(values), np.inf, values))
        return least

    @property
    def headline(self) -> str:
        """What the verdict says in words, with all that is known to be wrong and all that was not looked at."""
        return headline(self)

    @property
    def exit_code(self) -> int:
        """0 gouges nowhere, 1 gouges, 3 where not all that was asked for could be judged."""
        return {"pass": 0, "fail": 1, "unchecked": 3}[self.verdict]


@dataclass(frozen=True)
class Asked:
    """Faces to look at, what of their file was ``skipped`` with the reasons, how many were ``left_out``, and notes."""

    name: str
    faces: tuple[Face, ...]
    skipped: tuple[str, ...] = ()
    left_out: int = 0
    notes: tuple[str, ...] = ()


def check_faces(
    asked: Asked, cutter: Profile, mills: NDArray, *, grid: int = 256, margin: float = 0.0,
    axis: Sequence[float] = (0.0, 0.0, 1.0), device: str = "cpu",
) -> GougeCheck:  # fmt: skip
    """Predict local gouging on all faces and where they meet, and the largest of the mills (R, r), shape (m, 2).

    ``grid``: lines along the longest face; the others have as many by their length, and more where they bend.
    ``margin``: the share of every face left out at its borders, and with them where faces meet. ``axis``: the tool's,
    away from its tip, of any length. Raises InputError for a cutter that is not convex.
    """
    started = perf_counter()
    unit = _unit(axis)
    faces = asked.faces
    step = max(longest_line(f) for f in faces) / (grid - 1)
    lines = [face_lines(f, step, grid, margin) for f in faces]
    looks = tuple(look(f, mine, cutter, unit, device) for f, mine in zip(faces, lines, strict=True))
    met = where_met(faces, lines, margin)
    tool = cutter_tool(cutter)
    at_sides, on_ridges = least_at_sides(met, tool, unit), least_on_ridges(met, tool, unit)
    contacts = contacts_of(looks, met, unit)
    whole = largest_for_all(contacts, mills)
    worst = _worst(looks, met, at_sides, on_ridges)
    reasons = doubts(asked, looks, met, at_sides, margin)
    verdict, status = judge(worst, reasons)
    return GougeCheck(
        name=asked.name,
        device=device,
        verdict=verdict,
        status=status,
        seconds=perf_counter() - started,
        frame="part frame of the file",
        looks=looks,
        cutter=cutter,
        axis=unit,
        met=met,
        at_sides=at_sides,
        on_ridges=on_ridges,
        tolerance=join_tolerance(faces),
        mills=mills,
        whole=whole,
        place=tuple(float(x) for x in contacts.place(whole.best.limiting)) if whole else (),
        worst=worst,
        doubts=reasons,
        skipped=asked.skipped,
        left_out=asked.left_out,
        margin=margin,
        notes=asked.notes,
    )


def where_met(faces: Sequence[Face], lines: Sequence[Lines], margin: float) -> Junctions:
    """Where faces and pieces of faces meet; a margin leaves out the borders."""
    places = find_places(faces, lines, borders=margin == 0.0)
    return junctions(places, np.array([f.side == "solid" for f in faces]))


def _unit(axis: Sequence[float]) -> NDArray:
    length = float(np.linalg.norm(axis))
    if not 0.0 < length < np.inf:
        raise InputError(f"the tool axis must have a direction, got {tuple(axis)}")
    return np.asarray(axis, dtype=float) / length


def _worst(looks: Sequence[FaceLook], met: Junctions, at_sides: NDArray, on_ridges: NDArray) -> TightPlace | None:
    """The tightest contact of all: where it lies, and what is predicted there."""
    found: list[TightPlace] = []
    for k, f in enumerate(looks):
        flat = (f.grid.u.ravel(), f.grid.v.ravel(), f.grid.point.reshape(-1, 3), f.samples)
        for u, v, point, seen in (flat, (f.u, f.v, f.point, f.tight)):
            i = _lowest(np.where(seen.touches, seen.comparison.least, np.nan))
            if i >= 0:
                found.append(_on_face(k, u[i], v[i], point[i], at_one(seen, i)))
    side = _lowest(at_sides)
    if side >= 0:
        found.append(_where_met(met, side, float(at_sides[side])))
    ridge = _lowest(on_ridges)
    if ridge >= 0:
        found.append(_where_met(met, int(met.ridges.side[ridge]), float(on_ridges[ridge]), Join.CONVEX))
    return min(found, key=lambda p: p.least) if found else None


def _lowest(least: NDArray) -> int:
    return int(np.nanargmin(least)) if np.isfinite(least).any() or np.isneginf(least).any() else -1


def _on_face(face: int, u: float, v: float, point: NDArray, seen: Prediction) -> TightPlace:
    x, y, z = (float(c) for c in point)
    return TightPlace(face, float(u), float(v), (x, y, z), float(seen.comparison.least[0]), seen)


def _where_met(met: Junctions, side: int, least: float, kind: Join | None = None) -> TightPlace:
    s = met.sides
    pairs = np.flatnonzero(met.pairs.touched == side)
    if kind is None and len(pairs):
        kind = Join(int(met.pairs.kind[pairs].max()))
    mine = pairs[met.pairs.kind[pairs] == kind] if kind is not None else pairs
    other = int(s.face[met.pairs.other[mine[0]]]) if len(mine) else -1
    x, y, z = (float(c) for c in s.point[side])
    return TightPlace(int(s.face[side]), float(s.u[side]), float(s.v[side]), (x, y, z), least, None,
                      _MEETS[kind] if kind is not None else "border", other)  # fmt: skip


_MEETS = {
    Join.TANGENT: "tangent join", Join.CONVEX: "convex edge", Join.CONCAVE: "concave corner",
    Join.DISAGREE: "join whose material sides disagree",
}  # fmt: skip
