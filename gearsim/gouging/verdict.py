"""What ``gearsim gouge`` may say of faces that were looked at, and what must be said with it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import Status
from gearsim.gouging.compare import TIE, Decision
from gearsim.gouging.junctions import Join, Junctions
from gearsim.gouging.looked import FaceLook
from gearsim.metrology.verdict import Verdict

if TYPE_CHECKING:
    from gearsim.gouging.check import Asked, GougeCheck, TightPlace

_NAMED = 4
_LOCAL = "local gouging alone: whether the tool hits the part beside its contact was not asked"


def doubts(
    asked: Asked, looks: Sequence[FaceLook], met: Junctions, at_sides: NDArray, margin: float
) -> tuple[str, ...]:
    """Why not everything that was asked for could be judged; empty where it was."""
    found = []
    if asked.left_out:
        found.append(f"{asked.left_out} faces of the file were not looked at (without --number all are)")
    if asked.skipped:
        names = some([reason.partition(":")[0] for reason in asked.skipped])
        found.append(f"{len(asked.skipped)} faces could not be read: {names}")
    pairs = met.pairs
    against = met.sides.face[pairs.touched[pairs.kind == Join.DISAGREE]]
    if len(against):
        names = some([looks[k].face.name for k in np.unique(against)])
        found.append(f"material lies on opposite sides of faces that meet: {names} (--flip NAME turns one)")
    hidden = [look.face.name for look in _hidden(looks, met, at_sides) if look.face.side != "solid"]
    if hidden:
        found.append(f"the tool reaches no point of {some(hidden)}")
    if margin > 0.0 and len(looks) > 1:
        found.append("the margin leaves out where faces meet")
    return tuple(found)


def judge(worst: TightPlace | None, reasons: Sequence[str]) -> tuple[Verdict, str]:
    """Fail where anything gouges, whatever else is in doubt; unchecked where nothing is reached or anything is."""
    well = str(Status.OK.name)
    if worst is None:
        return "unchecked", "; ".join(["the tool reaches no point: nothing was judged", *reasons])
    if worst.least < -TIE:
        return "fail", well
    return ("unchecked", "; ".join(reasons)) if reasons else ("pass", well)


def headline(check: GougeCheck) -> str:
    """The verdict's reason, then all that is known to be wrong and all that was not looked at."""
    if check.verdict == "fail":
        said = [*_gouging(check), *check.doubts]
    else:
        said = ["it gouges at no place looked at"] if check.verdict == "pass" else [check.status]
    return "; ".join(dict.fromkeys([*said, *_not_judged(check), *check.notes, _LOCAL]))


def some(names: Sequence[str]) -> str:
    """A few of some names, and how many more there are."""
    return ", ".join(names[:_NAMED]) + (f" and {len(names) - _NAMED} more" if len(names) > _NAMED else "")


def _gouging(check: GougeCheck) -> Iterator[str]:
    """Where the tool gouges: points by face, places where faces meet, and the worst of all."""
    by_face = [(look, int(np.count_nonzero(look.decision == Decision.GOUGES))) for look in check.looks]
    faces = [f"{count:,} points of {look.face.name}" for look, count in by_face if count]
    if faces:
        yield f"it gouges at {some(faces)}"
    places = int(np.count_nonzero(check.least_at_places < -TIE))
    if places:
        yield f"it gouges at {places:,} places on borders and where faces meet"
    if check.worst is not None:
        place = ", ".join(f"{x:.4g}" for x in check.worst.point)
        yield f"it is worst at ({place}) mm on {check.looks[check.worst.face].face.name}"


def _not_judged(check: GougeCheck) -> Iterator[str]:
    """Places that tie, that the tool does not reach, and those that a margin left out."""
    ties = sum(int(np.count_nonzero(look.decision == Decision.TIE)) for look in check.looks)
    ties += int(np.count_nonzero(np.abs(check.least_at_places) <= TIE))
    if ties:
        yield f"{ties:,} places tie: the curvatures are equal there, which does not tell"
    away = [look.face.name for look in _hidden(check.looks, check.met, check.at_sides) if look.face.side == "solid"]
    if away:
        yield f"the tool reaches no point of {some(away)} of the solid"
    partly = [
        f"{np.count_nonzero(look.decision < 0):,} of {look.decision.size:,} points of {look.face.name}"
        for look in check.looks
        if look.reached and (look.decision < 0).any()
    ]
    if partly:
        yield f"out of the tool's reach and not judged: {some(partly)}"
    if check.margin > 0.0:
        yield f"{100.0 * check.margin:g} % of every face was left out at its borders"


def _hidden(looks: Sequence[FaceLook], met: Junctions, at_sides: NDArray) -> list[FaceLook]:
    """The faces of which the tool reaches no point, on the face or where it meets others."""
    reached = np.unique(met.sides.face[~np.isnan(at_sides)])
    return [look for k, look in enumerate(looks) if not look.reached and k not in reached]
