"""Rapid moves between cutting passes that provably stay clear of the blank.

A rapid is kept where the tool stays clear of the whole uncut blank all along. Otherwise the tool goes up along its
axis, in feed as long as it is near the blank, and over to the next pass, higher up if need be or around a sphere about
the blank: a tool whose tip stands the sphere's radius out along its own axis lies beyond a plane that the sphere does
not reach.
"""

from __future__ import annotations

from math import ceil, cos, radians

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.geometry.solid import Solid
from gearsim.programs.cldata import RAPID, CLPath, CLProgram
from gearsim.toolpaths.clearance import Clearance

APPROACH, WITHDRAWAL = "approach", "withdrawal"
_HIGHER = (1.0, 2.0, 4.0)
_TURN_RAD = radians(10.0)

Pose = tuple[NDArray, NDArray]


def clear_rapids(program: CLProgram, cutter: Profile, stock: Solid, retract: float) -> CLProgram:
    """The program with every rapid led clear of a blank; those that are clear stay as they are.

    A rapid that goes another way first withdraws ``retract`` [mm] along the tool's axis from where the tool is clear.
    Moves near the blank that no pass makes are feeds named ``approach`` and ``withdrawal``.
    """
    clearance = Clearance(stock, cutter)
    paths: list[CLPath] = []
    rapids: list[CLPath] = []
    last: CLPath | None = None
    for path in (*program.paths, None):
        if path is not None and path.name == RAPID:
            rapids.append(path)
            continue
        clear = all(clearance.clears(p.tips, p.axes) for p in rapids)
        paths += rapids if clear else _link(clearance, last, path, retract)
        paths += [path] if path is not None else []
        rapids, last = [], path
    return CLProgram(tuple(paths), program.tools, program.feed)


def _link(clearance: Clearance, before: CLPath | None, after: CLPath | None, retract: float) -> list[CLPath]:
    """From the end of one pass to the start of another; from or to the open where there is none."""
    there: list[CLPath] = []
    back: list[CLPath] = []
    ways: list[list[Pose]] = []
    ends = [(p.tips[i], p.axes[i]) if p else None for p, i in ((before, -1), (after, 0))]
    for end, cut, feed, name in zip(ends, (before, after), (there, back), (WITHDRAWAL, APPROACH), strict=True):
        if end is None or cut is None:
            continue
        up = clearance.height(*end)
        if up > 0.0:
            feed.append(_path(name, [end, _raised(end, up)][:: 1 if name == WITHDRAWAL else -1], cut.feed))
        ways.append([_raised(end, up), _raised(end, up + retract)])
    way = _over(clearance, *ways) if len(ways) == 2 else ways[0][:: 1 if before else -1]
    return [*there, _path(RAPID, way), *back]


def _over(clearance: Clearance, first: list[Pose], last: list[Pose]) -> list[Pose]:
    """From the lower pose of the first to that of the last, by the lowest way that is clear."""
    for higher in _HIGHER:
        ups = [_raised(low, higher * float((high[0] - low[0]) @ low[1])) for low, high in (first, last)]
        way = [first[0], *ups, last[0]]
        tips, axes = (np.array(part) for part in zip(*way, strict=True))
        if clearance.clears(tips, axes):
            return way
    return _around(clearance, first[0], last[0])


def _around(clearance: Clearance, first: Pose, last: Pose) -> list[Pose]:
    """Up until beyond the sphere about the blank, around it, and down again."""
    centre, radius = clearance.sphere
    radius /= cos(0.5 * _TURN_RAD)
    out = [_raised(pose, max(0.0, radius - float((pose[0] - centre) @ pose[1]))) for pose in (first, last)]
    distance = max(float((tip - centre) @ axis) for tip, axis in out)
    turns = _turned(first[1], last[1])
    return [first, out[0], *((centre + distance * axis, axis) for axis in turns), out[1], last]


def _turned(first: NDArray, last: NDArray) -> NDArray:
    """Unit axes from the first to the last in equal steps of at most ten degrees, shape (n, 3)."""
    sideways = last - (last @ first) * first
    if not np.linalg.norm(sideways) > 1e-9:
        sideways = np.cross(first, np.eye(3)[np.argmin(np.abs(first))])
    sideways /= np.linalg.norm(sideways)
    angle = float(np.arctan2(last @ sideways, last @ first)) if last @ first < 1.0 else 0.0
    turn = np.linspace(0.0, angle, max(1, ceil(abs(angle) / _TURN_RAD)) + 1)[:, None]
    axes = np.cos(turn) * first + np.sin(turn) * sideways
    axes[-1] = last
    return axes


def _raised(pose: Pose, height: float) -> Pose:
    tip, axis = pose
    return tip + height * axis, axis


def _path(name: str, poses: list[Pose], feed: float | None = None) -> CLPath:
    tips, axes = zip(*poses, strict=True)
    return CLPath(name, np.array(tips), np.array(axes), feed=feed)
