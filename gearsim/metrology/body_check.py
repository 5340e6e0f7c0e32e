"""Whether tools, and what holds them, touch a machine's table or a fixture, over the whole program.

Both move with the workpiece, so that what the tool does relative to the part is all that counts. Rows that stay clear
of a body are, for certain; where the others come near it, rays look at it, and they are run in the program's order
until the first move is found that takes anything of a ray.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rigid import Rigid
from gearsim.geometry.solid import Solid
from gearsim.metrology.body_rays import body_rays
from gearsim.metrology.findings import body_hit
from gearsim.metrology.holder_check import Moves, Touch
from gearsim.metrology.indexed import surface_points, tools_and_holders, where, who
from gearsim.metrology.inspection import Reading, Steps
from gearsim.simulation.near import rows_near
from gearsim.simulation.operation import Operation, Variant

if TYPE_CHECKING:
    from gearsim.metrology.job import Job

TABLE, FIXTURE, NOSE = "table", "fixture", "spindle nose"


@dataclass(frozen=True)
class BodyLook:
    """How a body of a ``name`` was looked at: how many of all ``rows`` are not for certain clear of it, by rays how far
    apart [mm] (0: none was needed).
    """

    name: str
    rows: int
    near: int
    pitch: float


@dataclass(frozen=True)
class BodyMeasurement:
    """Looks at all bodies; ``missing`` are those that are not named, so that nothing is known of them.

    ``bare``: the operations of whose tools it is not known what stands above the flutes.
    """

    variant: str
    looks: tuple[BodyLook, ...]
    missing: tuple[str, ...]
    bare: tuple[str, ...]
    surface: str = ""
    inspection: str = "machine bodies"


@dataclass(frozen=True)
class BodyInspection:
    """Whether a variant's tools touch ``bodies``, given with their names in a frame that ``frame`` takes to the part's.

    ``copies``: how often the variant is done, the part and the bodies indexed about its axis.
    """

    variant: str
    bodies: tuple[tuple[str, Solid], ...]
    frame: Rigid
    copies: int = 1
    missing: tuple[str, ...] = ()
    name: str = "machine bodies"

    def steps(self, job: Job) -> Steps[Reading]:
        looks, findings = [], []
        tools = self._tools(job) if self.bodies else ()
        for name, solid in self.bodies:
            look, hit = yield from self._look(name, solid, tools)
            looks.append(look)
            if hit is not None:
                touch, place, depth = hit
                called = f"the {touch.body} of {who(touch.operation, touch.row)}"
                told = where(touch.operation, touch.row, self.copies)
                findings.append(body_hit(job.part, name, place, depth, called, told))
        bare = tuple(dict.fromkeys(o.name for o in job.variant(self.variant).operations if o.holder is None))
        measured = BodyMeasurement(self.variant, tuple(looks), self.missing, bare)
        return Reading((measured,), tuple(findings))

    def _tools(self, job: Job) -> tuple[Operation, ...]:
        cutters, holders = tools_and_holders(job.variant(self.variant), self.copies)
        return (*cutters, *holders)

    def _look(
        self, name: str, solid: Solid, tools: tuple[Operation, ...]
    ) -> Steps[tuple[BodyLook, tuple[Touch, NDArray, float] | None]]:
        back = self.frame.inverse()
        masks = [rows_near(o.table.moved(back), o.cutter, solid) for o in tools]
        rows, near = sum(map(len, tools)), int(sum(m.sum() for m in masks))
        if not near:
            return BodyLook(name, rows, 0, 0.0), None
        close = tuple(o.part(m) for o, m in zip(tools, masks, strict=True) if m.any())
        chords, pitch = body_rays(solid, *_around(close, back, solid))
        none = Variant(name, "", ())
        moves = Moves.of(none, replace(none, operations=close))
        touch = yield from moves.first_hit(chords.moved(self.frame))
        look = BodyLook(name, rows, near, pitch)
        if touch is None:
            return look, None
        points = np.concatenate([touch.points, surface_points(touch.operation, touch.row)])
        depth = -solid.signed_distance(back.point(points))
        deepest = int(np.argmax(depth))
        return look, (touch, points[deepest], float(depth[deepest]))


def _around(tools: tuple[Operation, ...], back: Rigid, solid: Solid) -> tuple[NDArray, NDArray]:
    """The part of a solid's own box that tools may come to, in its frame."""
    lower, upper = np.full(3, np.inf), np.full(3, -np.inf)
    for o in tools:
        tip = back.point(o.table.tip[:, 0])
        reach = (o.cutter.reach + o.table.speed)[:, None]
        lower, upper = np.minimum(lower, (tip - reach).min(axis=0)), np.maximum(upper, (tip + reach).max(axis=0))
    own = solid.box
    return np.maximum(lower, own[0]), np.minimum(upper, own[1])
