"""The workshop: operations loaded onto one device, and rays cut by them, as many in one launch as are asked for.

Warp and each kind of kernel are loaded by the first that needs them: many jobs need few, who draws results none.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rays import RayBundle
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.intervals import IntervalSet, nothing, unite
from gearsim.simulation.operation import Operation

if TYPE_CHECKING:
    from gearsim.simulation.in_order import Taken
    from gearsim.simulation.removal import Loaded, Removal
    from gearsim.simulation.tiles import TileCutter


class Workshop:
    """Cuts rays by operations; refuses results it cannot trust. What was loaded once stays on the device.

    ``tolerance`` [mm] and ``slots`` as of ``simulation.removal.cut``. Owns the totals of a run: ``rays``,
    ``candidates``, ``pairs``, ``kernel_s``; ``progress`` is told of rays done. ``checkpoints``: a folder in which a
    whole part's stock is kept after every operation, to go on from. ``threads``: CPU threads that cut rays (default:
    all cores).
    """

    def __init__(
        self, device: str, tolerance: float = 1e-9, slots: int = 16, progress: Callable[[int], None] | None = None,
        checkpoints: Path | None = None, threads: int | None = None,
    ):  # fmt: skip
        self.device, self.tolerance, self.slots, self.checkpoints = device, tolerance, slots, checkpoints
        self.progress, self.threads = progress or (lambda n: None), threads
        self.rays = self.candidates = self.pairs = 0
        self.kernel_s = 0.0
        self._places: dict[int, tuple[Loaded, int]] = {}
        self._tiles: dict[int, TileCutter] = {}
        self._kept: list[Operation] = []  # an id is only known while its object lives

    def cut(self, asked: Sequence[tuple[RayBundle, Sequence[Operation]]]) -> list[IntervalSet]:
        """What the operations of every bundle remove from its rays, together.

        Segments are numbered through a bundle's operations, in their order. Raises NumericalError where a status
        forbids trust.
        """
        flat = [(rays, operation) for rays, operations in asked for operation in operations]
        parts = iter(self._removed(flat))
        results = []
        for rays, operations in asked:
            rows = np.cumsum([0, *map(len, operations)])
            mine = [_numbered(next(parts), int(row)) for row in rows[:-1]]
            results.append(unite(mine) if mine else nothing(len(rays)))
        return results

    def cut_bundle(
        self, box: DexelBox, axis: int, left: IntervalSet, operation: Operation, first_tag: int
    ) -> IntervalSet:
        """What an operation with a convex tool leaves of the material along a box's bundle; ends carry tags.

        The operation's rows are told by tags from ``first_tag`` on. Raises NumericalError where a status forbids trust.
        """
        from gearsim.simulation.tiles import TileCutter

        cutter = self._tiles.get(id(operation.table))
        if cutter is None:
            cutter = TileCutter(operation.table, operation.cutter, self.device, self.tolerance)
            self._tiles[id(operation.table)] = cutter
            self._kept.append(operation)
        started, pairs = perf_counter(), cutter.pairs
        result = cutter.cut(box, axis, left, first_tag, self.slots, progress=self.progress)
        self.kernel_s += perf_counter() - started
        self.rays += len(left.first) - 1
        self.pairs += cutter.pairs - pairs
        return result

    def cut_in_order(self, rays: RayBundle, material: IntervalSet, operation: Operation) -> Taken:
        """What each of an operation's rows is the first to take, as ``simulation.in_order`` tells it."""
        from gearsim.simulation.in_order import cut_in_order

        started = perf_counter()
        taken = cut_in_order(
            rays, material, operation, device=self.device, tolerance=self.tolerance, slots=self.slots
        )  # fmt: skip
        self.kernel_s += perf_counter() - started
        self.rays += len(rays)
        self.progress(len(rays))
        return taken

    def _removed(self, asked: list[tuple[RayBundle, Operation]]) -> list[IntervalSet]:
        self._load([operation for _, operation in asked])
        places = [self._places[id(operation.table)] for _, operation in asked]
        results: list[IntervalSet | None] = [None] * len(asked)
        for loaded in {id(where): where for where, _ in places}.values():
            mine = [i for i, (where, _) in enumerate(places) if where is loaded]
            removals = loaded.cut([(asked[i][0], places[i][1]) for i in mine], self.threads, self.progress)
            self.kernel_s += removals[0].kernel_s
            for i, removal in zip(mine, removals, strict=True):
                results[i] = self._trusted(removal, len(asked[i][0]))
        return [result for result in results if result is not None]

    def _trusted(self, removal: Removal, rays: int) -> IntervalSet:
        removal.require_trust()
        self.rays += rays
        self.candidates += removal.candidates
        self.pairs += removal.pairs
        return removal.removed

    def _load(self, operations: list[Operation]) -> None:
        """Put operations that are not there onto the device, those of convex tools together."""
        from gearsim.simulation.removal import Loaded

        new = {id(o.table): o for o in operations if id(o.table) not in self._places}
        convex = [o for o in new.values() if not o.cutter.is_ring]
        rings = [[o] for o in new.values() if o.cutter.is_ring]
        for batch in [convex, *rings] if convex else rings:
            loaded = Loaded([(o.table, o.cutter) for o in batch], self.device, self.tolerance, self.slots)
            self._places.update({id(o.table): (loaded, i) for i, o in enumerate(batch)})
            self._kept += batch


def _numbered(part: IntervalSet, first: int) -> IntervalSet:
    if not first:
        return part

    def shifted(segment: NDArray) -> NDArray:
        return np.where(segment >= 0, segment + first, segment)

    return replace(part, lo_segment=shifted(part.lo_segment), hi_segment=shifted(part.hi_segment))
