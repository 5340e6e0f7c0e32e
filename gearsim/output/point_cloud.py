"""Ends of material as a point cloud in a Parquet file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gearsim.errors import written
from gearsim.output.columns import Column, known
from gearsim.output.table import write_table
from gearsim.simulation.ends import Ends
from gearsim.simulation.stock import Stock


def write_points(ends: Ends, stock: Stock, file: Path) -> None:
    """Write a stock's ends, a row each, with the operations' names. Raises InputError where it cannot be written."""
    operation = known(stock.operation_of(ends.tag))
    names = np.array([done.name for done in stock.done] + [""], dtype=object)
    columns = {f"{k}_mm": Column(ends.point[:, i], f"{k} of the point") for i, k in enumerate("xyz")}
    columns |= {f"normal_{k}": Column(ends.normal[:, i], f"{k} of the outward normal") for i, k in enumerate("xyz")}
    columns |= {
        "bundle": Column(ends.bundle, "which axis of the box the point's ray runs along", _AXES),
        "tag": Column(known(ends.tag), "row that made it, counted through all operations; none: the blank itself"),
        "operation": Column(
            np.ma.masked_array(names[np.ma.getdata(operation)], np.ma.getmaskarray(operation)),
            "operation that made it; none: the blank itself",
        ),
    }
    with written(file, "points") as scratch:
        write_table([columns], {"units": "mm", "frame": "that of the part"}, scratch)


_AXES = {"0": "x", "1": "y", "2": "z"}
