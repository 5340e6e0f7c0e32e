"""A user's own surface: a small Python file with tool, motion and formula. See docs/verify.md."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError, read_input
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.series import Series
from gearsim.motion.sources import MotionSource
from gearsim.verify.closed_form import Claimed, ClosedForm
from gearsim.verify.shared import SharedPoses

_STEP = 1e-4


@dataclass(frozen=True)
class PoseFunction:
    """One smooth piece from plain poses: ``poses(t)`` gives tips [mm] and unit axes, (n, 3), at t in [0, 1].

    Values are exact; derivatives, which only bound how fast the tool moves, come from differences.
    """

    poses: Callable[[NDArray], tuple[NDArray, NDArray]]

    @property
    def pieces(self) -> int:
        return 1

    def pose(self, piece: NDArray, t: NDArray, order: int) -> PoseSeries:
        t = np.asarray(t, dtype=float)
        here = self._at(t)
        if not order:
            return PoseSeries(*(Series(x[None]) for x in here))
        inner = np.clip(t, _STEP, 1.0 - _STEP)
        back, middle, ahead = (self._at(inner + s * _STEP) for s in (-1.0, 0.0, 1.0))
        coefficients = (
            [x, (b - a) / (2.0 * _STEP), (b - 2.0 * m + a) / (2.0 * _STEP**2)]
            for x, a, m, b in zip(here, back, middle, ahead, strict=True)
        )
        return PoseSeries(*(Series(np.stack(c[: order + 1])) for c in coefficients))

    def _at(self, t: NDArray) -> tuple[NDArray, NDArray]:
        poses = self.poses(t)
        if not isinstance(poses, tuple) or len(poses) != 2:
            raise InputError("pose(t) must return two arrays: tips and axes")
        tip, axis = (np.asarray(x, dtype=float) for x in poses)
        for name, x in (("tips", tip), ("axes", axis)):
            if x.shape != (len(t), 3) or not np.isfinite(x).all():
                raise InputError(f"pose(t) gave {name} of shape {x.shape}; expected finite numbers, {(len(t), 3)}")
        length = np.linalg.norm(axis, axis=1)
        if np.abs(length - 1.0).max(initial=0.0) > 1e-9:
            raise InputError(
                f"pose(t) gave an axis of length {length[np.argmax(np.abs(length - 1.0))]:.10g}; expected 1"
            )
        return tip, axis


def load_surface(file: Path) -> ClosedForm:
    """The closed form a Python file defines by the names cutter, motion or pose, and points.

    Whatever goes wrong in the file, now or when its functions are called, is an InputError naming file and line.
    """
    code = read_input(file, "surface")
    names: dict[str, Any] = {"__name__": "__surface__", "__file__": str(file)}
    _guarded(file, lambda: exec(compile(code, str(file), "exec"), names))()
    cutter = _needed(file, names, "cutter", Profile, "a Profile, made by a function of gearsim.cutters.catalogue")
    points = _needed(file, names, "points", Callable, "a function of u and v")
    if callable(names.get("pose")):
        motion: MotionSource = SharedPoses(_GuardedMotion(file, PoseFunction(names["pose"])))
    else:
        source = _needed(file, names, "motion", object, "a motion (CLMotion, CurveMotion), or a function pose(t)")
        if not hasattr(source, "pieces") or not hasattr(source, "pose"):
            raise InputError(f"{file}: 'motion' is {type(source).__name__}; expected CLMotion or CurveMotion")
        motion = SharedPoses(_GuardedMotion(file, source))

    def claims(u: NDArray, v: NDArray) -> Claimed:
        found = _guarded(file, points)(u, v)
        return found if isinstance(found, Claimed) else _plain(file, found)

    joints = tuple(float(x) for x in names.get("joints", ()))
    return ClosedForm(str(names.get("name", file.stem)), motion, cutter, claims, str(names.get("flank", "")), joints)


def _plain(file: Path, found: Any) -> Claimed:
    """Claims from a plain pair (points, normals)."""
    if not isinstance(found, tuple) or len(found) != 2:
        raise InputError(f"{file}: points(u, v) must return a Claimed, or two arrays: points and normals")
    point, normal = (np.asarray(x, dtype=float) for x in found)
    return Claimed(point, normal)


def _needed(file: Path, names: dict[str, Any], name: str, kind: Any, what: str) -> Any:
    if name not in names:
        raise InputError(f"{file}: it does not define '{name}', {what}")
    if not isinstance(names[name], kind):
        raise InputError(f"{file}: '{name}' is {type(names[name]).__name__}; expected {what}")
    return names[name]


@dataclass(frozen=True)
class _GuardedMotion:
    """A motion whose exceptions name the user's file."""

    file: Path
    source: MotionSource

    @property
    def pieces(self) -> int:
        return self.source.pieces

    def pose(self, piece: NDArray, t: NDArray, order: int) -> PoseSeries:
        return _guarded(self.file, self.source.pose)(piece, t, order)


def _guarded(file: Path, function: Callable[..., Any]) -> Callable[..., Any]:
    """The function, its exceptions turned into one message with file and line."""

    def call(*arguments: Any) -> Any:
        try:
            return function(*arguments)
        except SyntaxError as error:
            raise InputError(f"{file}, line {error.lineno}: not valid Python: {error.msg}") from error
        except (Exception, SystemExit) as error:
            lines = [f.lineno for f in traceback.extract_tb(error.__traceback__) if f.filename == str(file)]
            where = f"{file}, line {lines[-1]}" if lines else str(file)
            kind = "" if isinstance(error, InputError) else f"{type(error).__name__}: "
            raise InputError(f"{where}: {kind}{error}") from error

    return call
