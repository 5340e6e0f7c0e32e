"""The four checks of a closed-form machined surface, at random points, and what came out of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.jets import Curvature
from gearsim.verify.brute_force import Least, distance_at, gradient_at, least_distance
from gearsim.verify.closed_form import Claimed, ClosedForm
from gearsim.verify.differences import curvature_gap, differentiate
from gearsim.verify.error_map import ErrorMap

CHECKS = ("distance", "sign", "normal", "curvature")
SIGN_STEP = 1e-3
NEAR = 1e-4
_SIGN_TOLERANCE = 1e-5
_SETTLED = 0.1
_NUDGE = 1e-5
_SLOPE = 1e-6


@dataclass(frozen=True)
class Limits:
    """Largest errors allowed: distance [mm], normal [rad], curvature relative to the larger principal one."""

    distance_mm: float = 1e-9
    normal_rad: float = 1e-6
    curvature: float = 1e-6

    def of(self, name: str) -> float:
        """The limit of a check that has one."""
        return {"distance": self.distance_mm, "normal": self.normal_rad, "curvature": self.curvature}[name]


LIMITS = Limits()


@dataclass(frozen=True)
class Check:
    """One check of one surface: points checked, failed, left out because their differences do not settle.

    ``worst`` is the largest error (mm, rad, relative; for the sign the least distance to the tool at 1 um,
    positive on the right side), None where nothing was checked; ``place_mm`` where that is. Of the sign's failures
    ``inward`` would be right with the normal turned round.
    """

    checked: int = 0
    failed: int = 0
    unsettled: int = 0
    worst: float | None = None
    place_mm: tuple[float, ...] | None = None
    inward: int = 0

    @property
    def passed(self) -> bool:
        """No failure, and not most points left out: differences settle on any smooth surface."""
        return not self.failed and self.unsettled <= self.checked


@dataclass(frozen=True)
class FormReport:
    """What the checks found about one surface.

    Of ``points`` random ones the formula has none at ``missing``; ``trimmed`` are cut away by another pose.
    ``certain_mm`` is how much less than found the least distance could be; ``errors`` tell of every point.
    """

    name: str
    flank: str
    points: int
    missing: int = 0
    trimmed: int = 0
    certain_mm: float | None = None
    checks: dict[str, Check] = field(default_factory=dict)
    errors: ErrorMap | None = field(default=None, repr=False, compare=False)

    @property
    def verdict(self) -> str:
        """``pass``, ``fail``, or ``nothing`` where there was no point to check."""
        if not any(c.checked or c.unsettled for c in self.checks.values()):
            return "nothing"
        return "pass" if all(c.passed for c in self.checks.values()) else "fail"


def verify_form(form: ClosedForm, points: int, seed: int, limits: Limits = LIMITS) -> FormReport:
    """Check a closed form at ``points`` random points of its chart."""
    u, v = np.random.default_rng(seed).uniform(size=(2, points))
    claimed = form.claims(u, v)
    there = claimed.there
    errors = ErrorMap(u, v, missing=~there)
    report = FormReport(form.name, form.flank, points, missing=int(np.sum(~there)), errors=errors)
    if not there.any():
        return report
    u, v, claimed = u[there], v[there], _pick(claimed, there)
    least = least_distance(form.motion, form.cutter, claimed.point, 0.1 * limits.distance_mm)
    error, trimmed = _distance_error(form, claimed, least, limits)
    kept = ~trimmed
    u, v, claimed, error = u[kept], v[kept], _pick(claimed, kept), error[kept]
    least = Least(*(c[kept] for c in least))
    report = replace(report, trimmed=int(trimmed.sum()), certain_mm=most(least.distance - least.bound))
    sign, wrong = sides(form, claimed.point, claimed.normal, least)
    everywhere = np.ones(len(u), dtype=bool)
    found = {"distance": (error, everywhere), **_differences(form, u, v, claimed, least, limits)}
    checks = {name: check(gap, limits.of(name), claimed.point, settled) for name, (gap, settled) in found.items()}
    ordered = {name: {**checks, "sign": sign}[name] for name in CHECKS if name in (*checks, "sign")}
    return replace(report, checks=ordered, errors=errors.known(trimmed, found, wrong))


def _distance_error(form: ClosedForm, claimed: Claimed, least: Least, limits: Limits) -> tuple[NDArray, NDArray]:
    """How far from the tool points are, at the claimed pose and at the closest one; and whether they are trimmed.

    Trimmed is a point that another pose cuts away, if the claimed pose really touches it: the distance there
    is zero and, unless the motion ends there, does not change as the tool moves on. Else a wrong point could
    hide among the trimmed ones.
    """
    error, trimmed = np.abs(least.distance), np.zeros(len(least.t), dtype=bool)
    if claimed.t is not None:
        at = distance_at(form.motion, form.cutter, claimed.point, claimed.pieces, claimed.t)
        error = np.maximum(np.abs(at), np.abs(np.minimum(at, least.distance)))
        touches = np.abs(at) <= limits.distance_mm
        passing = touches & ~_at_an_end(form, claimed)
        touches[passing] = _slope(form, _pick(claimed, passing)) <= _SLOPE
        trimmed = touches & (least.distance < -limits.distance_mm)
    return error, trimmed


def _at_an_end(form: ClosedForm, claimed: Claimed) -> NDArray:
    """Whether the claimed poses are the motion's first or last."""
    assert claimed.t is not None
    first, last = claimed.pieces == 0, claimed.pieces == form.motion.pieces - 1
    return (first & (claimed.t == 0.0)) | (last & (claimed.t == 1.0))


def _slope(form: ClosedForm, claimed: Claimed) -> NDArray:
    """Change of the distance per length that the tool's tip and far end move, at the claimed poses."""
    assert claimed.t is not None
    tip, axis = (s.derivatives() for s in form.motion.pose(claimed.pieces, claimed.t, 1))
    speed = np.linalg.norm(tip[1], axis=1) + form.cutter.reach * np.linalg.norm(axis[1], axis=1)
    step = np.minimum(_NUDGE / np.maximum(speed, 1e-12), 1e-3)
    t = np.concatenate([claimed.t + step, claimed.t - step])
    both = np.tile(claimed.point, (2, 1))
    ahead, back = distance_at(form.motion, form.cutter, both, np.tile(claimed.pieces, 2), t).reshape(2, -1)
    return np.abs(ahead - back) / (2.0 * step * np.maximum(speed, 1e-12))


def sign_check(form: ClosedForm, point: NDArray, normal: NDArray, least: Least) -> Check:
    """Whether normals point out of the material; see ``sides``."""
    return sides(form, point, normal, least)[0]


def sides(form: ClosedForm, point: NDArray, normal: NDArray, least: Least) -> tuple[Check, NDArray]:
    """Whether normals point out of the material, and which do not, shape (n,).

    Moved by 1 um out of the material a point must be cut, moved into it it must stay uncut.

    Points farther than 0.1 um from the machined surface say nothing about the sign and are not checked; those on
    a ridge so sharp that another pose cuts within 1 um of them are left out.
    """
    near = np.abs(least.distance) <= NEAR
    wrong = np.zeros(len(point), dtype=bool)
    point, step, piece, t = point[near], SIGN_STEP * normal[near], least.piece[near], least.t[near]
    if not len(point):
        return Check(), wrong
    moved = np.concatenate([point + step, point - step])
    out, into = distance_at(form.motion, form.cutter, moved, np.tile(piece, 2), np.tile(t, 2)).reshape(2, -1)
    right = (out < 0.0) & (into > 0.0)
    wrong[near] = ~right
    margin = np.minimum(-out, into)
    anywhere = least_distance(form.motion, form.cutter, (point - step)[right], _SIGN_TOLERANCE)
    ridge = np.zeros(len(point), dtype=bool)
    ridge[right] = anywhere.bound <= 0.0
    margin[right] = np.minimum(margin[right], anywhere.distance)
    kept = ~ridge
    if not kept.any():
        return Check(unsettled=len(point)), wrong
    worst = int(np.argmin(np.where(kept, margin, np.inf)))
    place = tuple(point[worst].tolist())
    failed, inward = int(np.sum(~right)), int(np.sum((out > 0.0) & (into < 0.0)))
    return Check(int(kept.sum()), failed, int(ridge.sum()), float(margin[worst]), place, inward), wrong


def _differences(
    form: ClosedForm, u: NDArray, v: NDArray, claimed: Claimed, least: Least, limits: Limits
) -> dict[str, tuple[NDArray, NDArray]]:
    """Errors of normals and curvatures against differences of the points, and where these settle.

    The tool tells which side is out of the material.
    """
    ours = differentiate(_finite(form), u, v, form.joints)
    angle = np.linalg.norm(np.cross(ours.normal, claimed.normal), axis=1)
    settled = ours.normal_error <= _SETTLED * limits.normal_rad
    found = {"normal": (angle, settled)}
    if claimed.curvature is not None:
        into_gear = gradient_at(form.motion, form.cutter, claimed.point, least.piece, least.t)
        turned = _oriented(ours.curvature, np.einsum("ij,ij->i", ours.normal, into_gear) > 0.0)
        settled = ours.curvature_error <= _SETTLED * limits.curvature
        gap = curvature_gap(claimed.curvature, turned)
        found["curvature"] = (gap, settled)
    return found


def _finite(form: ClosedForm) -> Callable[[NDArray, NDArray], NDArray]:
    """The form's points, nan where it has none."""

    def points(u: NDArray, v: NDArray) -> NDArray:
        claimed = form.claims(u, v)
        return np.where(claimed.there[:, None], claimed.point, np.nan)

    return points


def _oriented(c: Curvature, flip: NDArray) -> Curvature:
    """Curvatures with the normal turned round where ``flip``."""
    sign = np.where(flip, -1.0, 1.0)
    k1, k2 = np.where(flip, -c.k2, c.k1), np.where(flip, -c.k1, c.k2)
    return replace(c, mean=sign * c.mean, k1=k1, k2=k2)


def check(error: NDArray, limit: float, place: NDArray, settled: NDArray | None = None) -> Check:
    """A check from its errors; one that is not a number has failed."""
    settled = np.ones(len(error), dtype=bool) if settled is None else settled
    if not settled.any():
        return Check(unsettled=len(error))
    error, place = np.where(np.isnan(error), np.inf, error)[settled], place[settled]
    worst = int(np.argmax(error))
    failed, unsettled = int(np.sum(error > limit)), int(np.sum(~settled))
    return Check(len(error), failed, unsettled, float(error[worst]), tuple(place[worst].tolist()))


def _pick(claimed: Claimed, rows: NDArray) -> Claimed:
    """Some of the claims."""

    def pick(column: NDArray | None) -> NDArray | None:
        return None if column is None else column[rows]

    curvature = claimed.curvature
    if curvature is not None:
        names = ("gaussian", "mean", "k1", "k2", "direction1", "direction2")
        curvature = Curvature(*(getattr(curvature, n)[rows] for n in names))
    optional = (pick(claimed.exists), curvature, pick(claimed.t), pick(claimed.piece))
    return Claimed(claimed.point[rows], claimed.normal[rows], *optional)


def most(values: NDArray) -> float | None:
    return float(values.max()) if len(values) else None
