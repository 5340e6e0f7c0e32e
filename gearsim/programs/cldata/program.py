"""A CL program: paths of a tool's tip and axis, and what the file says beside them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.programs.cldata.tools import CLTool

RAPID = "rapid"
UNNAMED = "cut"


@dataclass(frozen=True)
class CLPath:
    """Consecutive moves of one kind: ``tips`` [mm] and unit ``axes``, shape (n, 3), first point included.

    ``name`` is the pass's name (UNNAMED: the file gives none), or RAPID for moves at rapid rate; ``tool`` counts the
    program's tools from 0. ``lines`` (n,): the line of the file that each point is stated in, from 1 (empty: no file);
    ``seconds`` (n,): how long the move to each point takes (nan: by rapid, or no feed says it; empty: none does).
    ``feed`` [mm/min] is the slowest of its moves (None: none is stated, or rapid).
    """

    name: str
    tips: NDArray[np.floating]
    axes: NDArray[np.floating]
    tool: int = 0
    lines: tuple[int, ...] = ()
    seconds: tuple[float, ...] = ()
    feed: float | None = None


@dataclass(frozen=True)
class CLProgram:
    """A CL program: its paths in order, the tools they are run with and the slowest feed in a cutting move [mm/min].

    ``fastest`` [mm/min] is the largest such feed, ``spindle`` [1/min] the last speed. Feeds and speed are None where
    the file states none. ``named``: the line of each pass name; ``notes``: what a person must be told of
    the reading.
    """

    paths: tuple[CLPath, ...]
    tools: tuple[CLTool, ...] = (CLTool(),)
    feed: float | None = None
    fastest: float | None = None
    spindle: float | None = None
    named: tuple[tuple[str, int], ...] = ()
    notes: tuple[str, ...] = ()

    def path(self, name: str) -> CLPath | None:
        """The first path of that name, or None."""
        return next((p for p in self.paths if p.name == name), None)
