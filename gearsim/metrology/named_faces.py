"""Ends of a whole stock's rays against a solid with named faces: each end belongs to one of them, judged there."""

from __future__ import annotations

from gearsim.metrology.stock_surfaces import SurfaceFigures, all_ends, extremes
from gearsim.simulation.stock import Stock
from gearsim.surfaces.part import NamedFaces, Part


def beside_faces(intended: NamedFaces, stock: Stock) -> tuple[list[SurfaceFigures], tuple[str, ...]]:
    """The figures of every face by all of a stock's ends, those of the blank too; what forbids trust.

    Nothing of the part escapes them but what lies between rays: the solid is connected, so that where a piece of it is
    missing, or stands beside it, material ends there inside of it or out.
    """
    ends = all_ends(stock)
    distance, face = intended.locate(ends)
    found, doubts = [], []
    for number, name in enumerate(intended.faces):
        own = face == number
        found.append(extremes(name, int(own.sum()), ends[own], distance[own]))
        if not own.any():
            doubts.append(
                f"no end of the whole part's rays lies on its {name}: nothing of it was judged; a finer stock.pitch_mm "
                "may find some"
            )
    return found, tuple(doubts)


def one_road(intended: NamedFaces, part: Part) -> tuple[str, ...]:
    """What must be said of the faces that are no surfaces of the part's own, which two roads measure."""
    alone = [name for name in intended.faces if name not in part.surfaces]
    return (f"{', '.join(alone)}: by one road only, at the ends of a tri-dexel's rays",)
