"""Point lists: a list checked against a closed form's tool and motion, and a closed form's points as a list."""

from __future__ import annotations

import numpy as np

from gearsim.errors import InputError
from gearsim.programs.point_list import PointList
from gearsim.verify.brute_force import gradient_at, least_distance, settled_pose
from gearsim.verify.checks import LIMITS, NEAR, FormReport, Limits, check, most, sign_check
from gearsim.verify.closed_form import ClosedForm


def verify_points(forms: list[ClosedForm], points: PointList, name: str, limits: Limits = LIMITS) -> FormReport:
    """Check points with normals against the tool on its motion: distance, sign, and normal at the closest pose.

    The motion is that of the forms whose flank is the list's. Normals are checked within 0.1 um of the surface.
    Raises InputError where no form belongs to that flank.
    """
    form = _form_of(forms, points.flank, name)
    least = least_distance(form.motion, form.cutter, points.point, 0.1 * limits.distance_mm)
    near = np.abs(least.distance) <= NEAR
    t = settled_pose(form.motion, form.cutter, points.point, least)
    into_gear = gradient_at(form.motion, form.cutter, points.point, least.piece, t)
    angle = np.linalg.norm(np.cross(into_gear, points.normal), axis=1)
    checks = {
        "distance": check(np.abs(least.distance), limits.distance_mm, points.point),
        "sign": sign_check(form, points.point, points.normal, least),
        "normal": check(angle[near], limits.normal_rad, points.point[near]),
    }
    return FormReport(name, points.flank, len(points.point), 0, 0, most(least.distance - least.bound), checks)


def _form_of(forms: list[ClosedForm], flank: str, name: str) -> ClosedForm:
    mine = [f for f in forms if f.flank == flank]
    if len({f.flank for f in forms}) == 1:
        mine = forms
    if not mine:
        flanks = sorted({f.flank for f in forms if f.flank})
        raise InputError(f"{name}: flank {flank!r} has no motion here; it may be {', '.join(flanks) or 'none'}")
    return mine[0]


def machined_points(form: ClosedForm, rows: int, columns: int, limits: Limits = LIMITS) -> PointList:
    """The form's points on a grid, columns along u and rows along v, less those missing or trimmed.

    ``shape`` is kept where none is left out.
    """
    v, u = np.meshgrid((np.arange(rows) + 0.5) / rows, (np.arange(columns) + 0.5) / columns, indexing="ij")
    claimed = form.claims(u.ravel(), v.ravel())
    keep = claimed.there
    least = least_distance(form.motion, form.cutter, claimed.point[keep], 0.1 * limits.distance_mm)
    keep[keep] = least.distance >= -limits.distance_mm
    shape = (rows, columns) if keep.all() else None
    return PointList(claimed.point[keep], claimed.normal[keep], form.flank, shape=shape)
