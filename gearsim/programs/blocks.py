"""What a program makes a machine's axes do: one row a block, whatever language it is written in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.machines.chain import Machine


@dataclass(frozen=True)
class Blocks:
    """Motions of a machine, block after block.

    ``start`` (k,) are the axis values [mm, rad] before the first block and ``values`` (n, k) those at the end of
    each, in the machine's axis order; linear axes count from the work offset, tool length compensated. All of the
    following have shape (n,): ``rapid`` marks G0; ``tip_control`` blocks between whose ends the tip runs straight
    on the workpiece (else all axes are linear in time); ``seconds`` is the time a block takes (nan for rapids);
    ``line`` the line of the program, from 1 (0 where none is written); ``tool`` the tool's number;
    ``operation`` the index of the operation it belongs to.

    An arc turns the linear axes about ``centre`` (n, 3) [mm] by ``sweep`` (n,) [rad], right-handed about the axis
    ``normal`` (n,) (0 X, 1 Y, 2 Z), all other axes linear; blocks with sweep 0 are straight.
    Raises InputError for shapes that do not fit.
    """

    machine: Machine
    start: NDArray[np.floating]
    values: NDArray[np.floating]
    rapid: NDArray[np.bool_]
    tip_control: NDArray[np.bool_]
    seconds: NDArray[np.floating]
    line: NDArray[np.integer]
    tool: NDArray[np.integer]
    operation: NDArray[np.integer]
    sweep: NDArray[np.floating]
    centre: NDArray[np.floating]
    normal: NDArray[np.integer]

    def __post_init__(self) -> None:
        n, k = len(self.values), len(self.machine.axes)
        columns = ("rapid", "tip_control", "seconds", "line", "tool", "operation", "sweep", "normal")
        shapes = {name: (n,) for name in columns} | {"start": (k,), "values": (n, k), "centre": (n, 3)}
        for name, shape in shapes.items():
            if np.shape(getattr(self, name)) != shape:
                found = np.shape(getattr(self, name))
                raise InputError(f"blocks of {self.machine.name}: {name} has shape {found}, expected {shape}")

    def __len__(self) -> int:
        return len(self.values)

    @property
    def before(self) -> NDArray[np.floating]:
        """Axis values at the start of each block, (n, k)."""
        return np.concatenate([self.start[None], self.values[:-1]])
