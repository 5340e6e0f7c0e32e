"""The whole part as stock: volumes, what each operation did, how the part stands beside the intended surfaces."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from gearsim.metrology.job import Job
from gearsim.metrology.stock_check import OperationFigures, StockInspection, StockMeasurement, TurnedFigures
from gearsim.output.columns import YES_NO, Column
from gearsim.output.files import STOCK
from gearsim.output.markdown import table, um
from gearsim.output.programs import duration
from gearsim.output.solid_files import solid_surface, write_solid
from gearsim.output.summary import number
from gearsim.output.table import write_columns
from gearsim.result import Result

OPERATIONS = "operations.parquet"
SOLIDS = ("part.stl", "part.vtp", "part.3mf")
PICTURE = "part.png"
TURNED = "turning tool"
EARLIER = "a tool of an earlier run"


def files(_: Job, asked: Sequence[StockInspection]) -> list[str]:
    return [STOCK, OPERATIONS, *SOLIDS, PICTURE]


def figures(m: StockMeasurement) -> dict[str, Any]:
    rays, intervals = (sum(n) for n in zip(*((len(k.first) - 1, len(k.lo)) for k in m.stock.left), strict=True))
    return {
        "pitch_mm": m.stock.box.pitch,
        "sectors": m.sectors,
        "rays": rays,
        "intervals": intervals,
        "bytes_a_ray": m.stock.nbytes / rays,
        "blank_mm3": {"exact": number(m.exact_blank_volume), "bundles": list(m.blank_volumes)},
        "left_mm3": list(m.stock.volumes),
        "intended_mm3": m.intended_volume,
        "surface": {
            "triangles": len(m.contour.mesh.triangles),
            "volume_mm3": m.contour.mesh.volume,
            "volume_bound_mm3": m.contour.bound,
            "unseen_mm3": m.contour.unseen,
        },
        "operations": [*([_turning(m.turned)] if m.turned else []), *map(_operation, m.operations)],
        "rapids": _rapids(m),
        "surfaces": {
            s.surface: {
                "ends": s.ends,
                "overcut_um": number(1e3 * s.overcut),
                "excess_um": number(1e3 * s.excess),
                "overcut_at_mm": [number(x) for x in s.overcut_place],
                "excess_at_mm": [number(x) for x in s.excess_place],
            }
            for s in m.surfaces
        },
    }


def _turning(turned: TurnedFigures) -> dict[str, Any]:
    removed = float(np.mean(turned.removed))
    return {
        "name": turned.name,
        "cutter": TURNED,
        "rows": 1,
        "removed_mm3": list(turned.removed),
        "feed_s": turned.seconds,
        "rapid_s": None,
        "rows_without_time": int(turned.seconds is None),
        "removal_rate_mm3_min": 60.0 * removed / turned.seconds if turned.seconds else None,
        "feed_mm": 0.0,
        "air_mm": None,
        "engagement_mm2": None,
    }


def _operation(o: OperationFigures) -> dict[str, Any]:
    fed, known = ~o.operation.rapid, np.isfinite(o.seconds)
    seconds = float(o.seconds[known & fed].sum())
    timed = float(o.volume[known & fed].sum())
    removed = float(np.mean(o.removed))
    return {
        "name": o.name,
        "cutter": o.operation.cutter.name,
        "rows": len(o.operation),
        "removed_mm3": list(o.removed),
        "feed_s": number(seconds) if known[fed].any() else None,
        "rapid_s": number(float(o.seconds[~fed].sum())) if known[~fed].all() else None,
        "rows_without_time": int((~known).sum()),
        "removal_rate_mm3_min": number(60.0 * timed / seconds) if seconds > 0.0 else None,
        "feed_mm": float(o.way[fed].sum()),
        "air_mm": number(float(o.way[o.air].sum())) if np.isfinite(o.volume).all() else None,
        "engagement_mm2": number(removed / float(o.way[fed & ~o.air].sum())) if o.way[fed & ~o.air].sum() > 0 else None,
    }


def _rapids(m: StockMeasurement) -> dict[str, Any]:
    """How rapids were looked at: what none of three bundles of rays meets holds no ball that is wider than told."""
    rows, near = (sum(n) for n in zip(*((int(o.operation.rapid.sum()), o.near) for o in m.operations), strict=True))
    return {"rows": rows, "near_the_blank": near, "widest_unseen_mm": 2.0**0.5 * m.stock.box.pitch}


def sections(_: Result, found: Sequence[StockMeasurement]) -> dict[str, str]:
    return {"beside": "".join(map(_section, found))}


def _section(m: StockMeasurement) -> str:
    told = figures(m)
    rows = [
        [
            o["name"], o["cutter"], f"{np.mean(o['removed_mm3']):.1f}", duration(o["feed_s"]),
            _plain(o["removal_rate_mm3_min"]), _plain(o["engagement_mm2"]), _share(o["air_mm"], o["feed_mm"]),
        ]
        for o in told["operations"]
    ]  # fmt: skip
    head = ["Operation", "cutter", "removed [mm³]", "in feed", "mm³/min", "engaged [mm²]", "feed through air"]
    near = [
        [name, s["ends"], um(s["overcut_um"]), um(s["excess_um"])] for name, s in told["surfaces"].items() if s["ends"]
    ]
    mesh = m.contour.mesh
    text = (
        f"## The whole part\n\n{_of(m)} by a tri-dexel of {told['rays']:,} rays, "
        f"{told['pitch_mm']:g} mm apart: {_three(m.blank_volumes)} mm³; left are {_three(m.stock.volumes)} mm³. The "
        f"three bundles' spread tells the grid's error. Its closed surface of {len(mesh.triangles):,} triangles holds "
        f"{mesh.volume:.1f} mm³.{_intended(m)}\n\n" + table(head, rows) + _of_rapids(told["rapids"])
    )
    if near:
        text += (
            "\nEnds of its rays near the intended surfaces, in all spaces; each is exact, between the rays nothing is "
            "seen:\n\n" + table(["Surface", "ends", "lowest [µm]", "highest [µm]"], near)
        )
    return text + "\n"


def _of_rapids(told: dict[str, Any]) -> str:
    if not told["rows"]:
        return "\nNothing is run by rapid.\n"
    clear = (
        f"\nOf {told['rows']:,} moves by rapid {told['rows'] - told['near_the_blank']:,} are clear of the uncut blank"
    )
    if not told["near_the_blank"]:
        return f"{clear}, for certain.\n"
    return (
        f"{clear}, for certain; the others were run through all rays as the stock stood then. What these do not see "
        f"holds no ball of {told['widest_unseen_mm']:.3g} mm.\n"
    )


def screen(_: Result, found: Sequence[StockMeasurement], console: Console) -> None:
    for m in found:
        left, blank = float(np.mean(m.stock.volumes)), float(np.mean(m.blank_volumes))
        count = len(m.operations) + bool(m.turned)
        console.print(
            f"Whole part: {blank - left:,.1f} of {blank:,.1f} mm3 removed in {count} operations "
            f"({sum(len(k.first) - 1 for k in m.stock.left):,} rays, {m.stock.box.pitch:g} mm apart)."
        )


def data(result: Result, found: Sequence[StockMeasurement]) -> dict[str, Callable[[Path], None]]:
    """What writes the stock, which can be continued from, its surface, and the table of all rows."""
    from gearsim.simulation.stock_file import save_stock

    (m,) = found
    surface = solid_surface(m.contour.mesh, m.stock)
    solids: dict[str, Callable[[Path], None]] = {name: partial(write_solid, surface) for name in SOLIDS}
    return solids | {
        STOCK: partial(save_stock, m.stock, job=result.name),
        OPERATIONS: partial(write_columns, [_rows(i, o) for i, o in enumerate(m.operations)], result),
    }


def layers(result: Result, found: Sequence[StockMeasurement]) -> dict[str, NDArray]:
    """The whole part's surface, of each triangle what made it, of each vertex how far it is off."""
    (m,) = found
    mesh, tolerances = m.contour.mesh, [s.tolerance for s in result.job.part.surfaces.values() if s.tolerance]
    ends = [
        max((um for um in (t.overcut_um, t.excess_um) if um < np.inf), default=10.0)
        for t in tolerances or m.tolerances.values()
    ]  # fmt: skip
    names = [done.name for done in m.stock.done]
    cutters = [*([TURNED] if m.turned else []), *(o.operation.cutter.name for o in m.operations)]
    cutters = [EARLIER] * (len(names) - len(cutters)) + cutters
    return {
        "whole:points": mesh.points,
        "whole:triangles": mesh.triangles,
        "whole:tag": mesh.tag,
        "whole:operation": m.stock.operation_of(mesh.tag),
        "whole:names": np.array(names),
        "whole:tools": np.array(cutters),
        "whole:deviation_um": 1e3 * m.deviation,
        "whole:limit_um": np.array(min(ends, default=10.0)),
    }


def _rows(number_: int, o: OperationFigures) -> dict[str, Column]:
    """Every row of an operation."""
    n = len(o.operation)
    index = np.arange(n)
    line = np.ma.masked_equal(o.operation.line, 0)
    return {
        "operation": Column(np.full(n, number_), "number of the operation, from 0 in the order of the work"),
        "name": Column(np.full(n, o.name, dtype=object), "name of the operation"),
        "row": Column(index, "row of the operation's motion, from 0"),
        "line": Column(line, "line of the program that states it, from 1"),
        "rapid": Column(o.operation.rapid.astype(np.int8), "whether it is run by rapid", YES_NO),
        "volume_mm3": Column(o.volume, "material that it is the first to take, by a coarse tri-dexel's three bundles"),
        "way_mm": Column(o.way, "way of the tip over the part, straight from end to end"),
        "seconds": Column(o.seconds, "how long it takes [s]"),
        "removal_rate_mm3_min": Column(_over(60.0 * o.volume, o.seconds), "volume over time [mm³/min]"),
        "engagement_mm2": Column(_over(o.volume, o.way), "volume over way: the section in engagement [mm²]"),
    }


def _over(a: NDArray, b: NDArray) -> NDArray:
    return np.where(b > 0.0, a / np.where(b > 0.0, b, 1.0), np.nan)


def _of(m: StockMeasurement) -> str:
    if np.isnan(m.exact_blank_volume):
        return "What an earlier run has left"
    which = "The blank" if m.sectors == 1 else f"One of {m.sectors} alike sectors of the blank"
    return f"{which} ({m.exact_blank_volume:.1f} mm³)"


def _intended(m: StockMeasurement) -> str:
    return "" if m.intended_volume is None else f" The intended part holds {m.intended_volume:.1f} mm³."


def _three(volumes: Sequence[float]) -> str:
    return ", ".join(f"{v:.1f}" for v in volumes)


def _plain(x: float | None) -> str:
    return "–" if x is None else f"{x:.3g}" if x < 100.0 else f"{x:.0f}"


def _share(part: float | None, whole: float) -> str:
    return "–" if part is None or whole <= 0.0 else f"{100.0 * part / whole:.0f} %"
