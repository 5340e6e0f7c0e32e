"""Operations in sequence on a whole blank: what is left, and what every row takes on its way there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.solid import Solid
from gearsim.programs.names import distinct
from gearsim.simulation.checkpoints import Checkpoints, Kept
from gearsim.simulation.contour.surface import Contour, contour
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.ends import Normals
from gearsim.simulation.operation import Operation, Variant
from gearsim.simulation.rapids import look_at_rapids
from gearsim.simulation.room import RAY_BYTES, memory_bytes, require_room
from gearsim.simulation.saved_blank import with_earlier
from gearsim.simulation.stock import (
    AXES,
    Stock,
    after,
    blank_stock,
    cut_stock,
    material_rays,
    turn_stock,
    without,
)
from gearsim.simulation.turning import Turning
from gearsim.simulation.work import Work
from gearsim.simulation.workshop import Workshop

_LOOK_RAYS = 60_000
_PART = Rigid(np.eye(3), np.zeros(3))


@dataclass(frozen=True)
class Machining:
    """Operations on a blank, one after the other, seen by the tri-dexel of a box.

    ``saved``: the stock in that box that they go on from, exactly; the blank is a solid much like it.
    ``turning`` comes before them all.
    """

    blank: Solid
    box: DexelBox
    operations: tuple[Operation, ...]
    saved: Stock | None = None
    turning: Turning | None = None

    @property
    def looked_at(self) -> DexelBox:
        """The box whose rays are cut row after row: a coarser one, or a saved stock's, which has no other rays."""
        return self.box if self.saved else look_box(self.box)

    @property
    def rays(self) -> int:
        """Rays that are cut, once for every operation."""
        return len(self.operations) * (ray_count(self.box) + ray_count(self.looked_at))


class Machined(NamedTuple):
    """The ``stock`` that is left, its surface, the blank's volumes by bundle [mm³], and the work of each operation.

    ``turned_volumes`` [mm³]: what turning has left of the blank, all where there is none.
    """

    stock: Stock
    contour: Contour
    blank_volumes: tuple[float, float, float]
    work: tuple[Work, ...]
    turned_volumes: tuple[float, float, float]


def whole_box(blank: Solid, pitch: float, frame: Rigid = _PART, others: Sequence[Solid] = ()) -> DexelBox:
    """A box around a whole blank and ``others``, one cell wider on every side.

    ``frame``: where the solids' own boxes lie in the part.

    Raises InputError where its rays need more memory than there is.
    """
    corners = np.array([solid.box for solid in (blank, *others)], dtype=float)
    lower, upper, narrowest = corners[:, 0].min(axis=0), corners[:, 1].max(axis=0), np.diff(corners[0], axis=0).min()
    cells = (upper - lower) / pitch + 2.0
    rays = sum(float(np.delete(cells, axis).prod()) for axis in AXES)
    fits = pitch * float(np.sqrt(RAY_BYTES * rays / memory_bytes()))
    require_room(
        rays, f"stock.pitch_mm = {pitch:g}",
        f"{1.06 * fits:.2g} mm would do, or of a bevel gear one space's sector (stock.spaces = \"sector\")",
    )  # fmt: skip
    if not narrowest >= pitch:
        raise InputError(f"stock.pitch_mm = {pitch:g}: the blank is only {float(narrowest):.4g} mm wide")
    return DexelBox(frame, lower - pitch, upper + pitch, pitch)


def ray_count(box: DexelBox) -> int:
    """Rays of all three bundles."""
    return sum(int(np.delete(box.counts, axis).prod()) for axis in AXES)


def look_box(box: DexelBox) -> DexelBox:
    """The same box with about 60,000 rays, or as many as it has."""
    coarser = max(1.0, (ray_count(box) / _LOOK_RAYS) ** 0.5)
    return replace(box, pitch=min(box.pitch * coarser, float((box.upper - box.lower).min()) / 4.0))


def in_sequence(variant: Variant) -> tuple[Operation, ...]:
    """A variant's operations cut up where the program changes tool or heading, in the program's order, no two alike in
    name.
    """
    owner = np.repeat(np.arange(len(variant.operations)), [len(o) for o in variant.operations])
    row = np.concatenate([np.arange(len(o)) for o in variant.operations])
    step, section, rapid = (
        np.concatenate([getattr(o, name) for o in variant.operations]) for name in ("step", "section", "rapid")
    )
    order = np.argsort(step, kind="stable")
    owner, row, section, rapid = owner[order], row[order], section[order], rapid[order]
    found = []
    for run in _runs(owner, section, rapid):
        operation = variant.operations[owner[run[0]]]
        heading = operation.headings[section[run[0]]] if operation.headings else ""
        found.append(replace(operation.part(row[run]), name=heading or operation.name))
    names = distinct([o.name for o in found])
    return tuple(replace(o, name=name) for o, name in zip(found, names, strict=True))


def _runs(owner: NDArray, section: NDArray, rapid: NDArray) -> list[NDArray]:
    """Rows of one tool under one heading. Rapids behind a heading and before its tool change, the retreat of the tool
    before, belong to that one's work.
    """
    change = (np.diff(owner) != 0) | (np.diff(section) != 0)
    runs = np.split(np.arange(len(owner)), np.flatnonzero(change) + 1)
    joined = runs[:1]
    for run, then in zip(runs[1:], [*runs[2:], None], strict=False):
        retreats = then is not None and owner[then[0]] != owner[run[0]] and section[then[0]] == section[run[0]]
        if retreats and rapid[run].all() and owner[run[0]] == owner[joined[-1][0]]:
            joined[-1] = np.concatenate([joined[-1], run])
        else:
            joined.append(run)
    return joined


def machine(asked: Machining, workshop: Workshop) -> Machined:
    """Carry the operations out, on from where the workshop's checkpoints stand, if it has any.

    Raises NumericalError where a status forbids trust, InputError where what is to be kept cannot be written.
    """
    blank = asked.saved or blank_stock(asked.box, asked.blank)
    look = asked.saved or blank_stock(asked.looked_at, asked.blank)
    turned = blank
    if asked.turning:
        turned, look = (turn_stock(stock, asked.turning.kept, asked.turning.name) for stock in (blank, look))
    keeper = workshop.checkpoints and Checkpoints(workshop.checkpoints, turned, workshop.tolerance, asked.operations)
    kept = (keeper and keeper.last()) or Kept(turned, look, [])
    for operation in asked.operations[len(kept.work) :]:
        stock = cut_stock(kept.stock, [operation], workshop)
        look, volume = _looked_at(kept.look, operation, workshop)
        touch, near = look_at_rapids(None if asked.saved else asked.blank, kept.stock, operation, workshop)
        kept = Kept(stock, look, [*kept.work, Work(operation, volume, stock.volumes, touch, near)])
        if keeper:
            keeper.keep(kept)
    normals = end_normals(asked, workshop.device, workshop.tolerance)
    return Machined(kept.stock, contour(kept.stock, normals), blank.volumes, tuple(kept.work), turned.volumes)


def end_normals(asked: Machining, device: str, tolerance: float) -> Normals:
    """The normals at the ends of what is made, by who made them: the blank, turning, operations, another run."""
    from gearsim.simulation.normals import EndNormals  # Warp loads with it

    turned = [asked.turning.kept] if asked.turning else []
    normals = EndNormals(asked.blank, [*turned, *asked.operations], device, tolerance)
    return normals if asked.saved is None else with_earlier(asked.saved, normals)


def _looked_at(look: Stock, operation: Operation, workshop: Workshop) -> tuple[Stock, NDArray]:
    """What an operation leaves of a coarse stock, and the volume that each of its rows takes."""
    if operation.cutter.is_ring:
        return cut_stock(look, [operation], workshop), np.full(len(operation), np.nan)
    volume, left = np.zeros(len(operation)), []
    for axis, material in zip(AXES, look.left, strict=True):
        taken = workshop.cut_in_order(material_rays(look, axis), material, operation)
        left.append(without(material, np.arange(len(material.first) - 1), taken.removed, look.next_tag))
        volume += look.box.cell_area(axis) * taken.length / len(AXES)
    return after(look, left, operation), volume
