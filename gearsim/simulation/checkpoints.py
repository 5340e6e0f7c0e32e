"""Stock kept after every operation, so that a run that was killed goes on where it was."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, fields
from pathlib import Path
from typing import NamedTuple
from zipfile import BadZipFile

import numpy as np

import gearsim
from gearsim.errors import InputError
from gearsim.simulation.operation import Operation
from gearsim.simulation.stock import Stock
from gearsim.simulation.stock_file import load_stock, save_stock
from gearsim.simulation.work import RapidTouch, Work

_FINE, _COARSE, _WORK = "stock-{:04}.parquet", "look-{:04}.parquet", "work-{:04}.npz"


class Kept(NamedTuple):
    """After some operations: the fine and the coarse stock, and the work of each of them."""

    stock: Stock
    look: Stock
    work: list[Work]


@dataclass(frozen=True)
class Checkpoints:
    """A ``folder`` that keeps the stock after each of ``operations`` done to a ``blank``, ends to a tolerance [mm].

    What is kept there of another job is not taken.
    """

    folder: Path
    blank: Stock
    tolerance: float
    operations: Sequence[Operation]

    def last(self) -> Kept | None:
        """What was kept last of this very job; None where nothing was."""
        for count in range(len(self.operations), 0, -1):
            with suppress(InputError, OSError, ValueError, KeyError, BadZipFile):
                stock, job = load_stock(self.folder / _FINE.format(count))
                look, other = load_stock(self.folder / _COARSE.format(count))
                if job == other == self._digest(count):
                    return Kept(stock, look, [self._work(k) for k in range(count)])
        return None

    def _work(self, k: int) -> Work:
        with np.load(self.folder / _WORK.format(k), allow_pickle=False) as kept:
            row, *place, depth = kept["touch"] if len(kept["touch"]) else (0.0, 0.0, 0.0, 0.0, 0.0)
            touch = RapidTouch(int(row), np.array(place), float(depth)) if len(kept["touch"]) else None
            x, y, z = (float(v) for v in kept["left"])
            return Work(self.operations[k], kept["volume"], (x, y, z), touch, int(kept["near"]))

    def keep(self, kept: Kept) -> None:
        """Keep what is there after an operation; only together do its files count, and till then those before stay.

        Raises InputError where the folder cannot be written.
        """
        count = len(kept.work)
        file, work = self.folder / _WORK.format(count - 1), kept.work[-1]
        touch = [] if work.touch is None else [work.touch.row, *work.touch.place, work.touch.depth]
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            np.savez(file, volume=work.volume, left=work.left, touch=np.array(touch, dtype=float), near=work.near)
        except OSError as error:
            raise InputError(f"{file}: cannot be written: {error.strerror or error}") from error
        digest = self._digest(count)
        save_stock(kept.look, self.folder / _COARSE.format(count), digest)
        save_stock(kept.stock, self.folder / _FINE.format(count), digest)
        for name in (_FINE, _COARSE):
            (self.folder / name.format(count - 1)).unlink(missing_ok=True)

    def _digest(self, count: int) -> str:
        """Of all that the stock after so many operations depends on."""
        box = self.blank.box
        places = [a.tolist() for a in (box.lower, box.upper, box.frame.rotation, box.frame.translation)]
        told = hashlib.sha256(json.dumps([gearsim.__version__, self.tolerance, box.pitch, *places]).encode())
        for bundle in self.blank.left:
            told.update(bundle.first.tobytes() + bundle.lo.tobytes() + bundle.hi.tobytes())
            told.update(bundle.lo_segment.tobytes() + bundle.hi_segment.tobytes())
        told.update(repr(self.blank.done).encode())
        for operation in self.operations[:count]:
            told.update(repr((operation.name, operation.cutter)).encode())
            for column in fields(operation.table):
                told.update(np.ascontiguousarray(getattr(operation.table, column.name)).tobytes())
            told.update(operation.rapid.tobytes())
        return told.hexdigest()
