"""A table of axis values as text: what a controller would run, block by block.

CSV as every reader takes it: a line of column names ``block,X_mm,...,A_deg,...,machine``, then one line a block with
its number and the machine's name. By hand, lines that start with ``#`` and empty lines may stand anywhere.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.machines.chain import Machine


@dataclass(frozen=True)
class AxisTable:
    """Axis values (n, k) [mm, rad] in the machine's axis order, and rising block numbers (n,).

    ``lines`` (n,): the line of the text that each stands in, from 1 (empty: it was not read from one).
    """

    machine: Machine
    values: NDArray[np.floating]
    blocks: NDArray[np.integer]
    lines: tuple[int, ...] = ()

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of the columns with their units, as they stand in the text."""
        return column_names(self.machine)


def column_names(machine: Machine) -> tuple[str, ...]:
    """The columns of a machine's table: block number, slides in mm, rotary axes in degrees, the machine's name."""
    units = ("deg" if joint.is_rotary else "mm" for joint in machine.joints)
    return ("block", *(f"{name}_{unit}" for name, unit in zip(machine.axes, units, strict=True)), "machine")


def format_axis_table(table: AxisTable, decimals: int) -> str:
    """The table as text with ``decimals`` digits behind the point."""
    shown = np.round(table.values * _degrees(table.machine), decimals) + 0.0
    rows = (
        f"{block}," + ",".join(f"{value:.{decimals}f}" for value in row) + f",{table.machine.name}"
        for block, row in zip(table.blocks, shown, strict=True)
    )
    return "\n".join([",".join(table.columns), *rows, ""])


def parse_axis_table(text: str, machine: Machine, name: str = "axis table") -> AxisTable:
    """Read a table for a machine; ``name`` stands in the messages.

    Raises InputError naming line and column for anything it cannot use: another machine, other columns or
    units, a cell that is no finite number, block numbers that do not rise.
    """
    lines = [
        (number, [cell.strip() for cell in line.split(",")])
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    columns = column_names(machine)
    if len(lines) < 2:
        raise InputError(f"{name}: expected a line {','.join(columns)} and at least one block")
    (first, header), *rows = lines
    _check_header(header, columns, f"{name}, line {first}")
    blocks = np.array([_block(cells[0], f"{name}, line {number}") for number, cells in rows])
    values = np.array([_row(cells, columns, machine.name, f"{name}, line {number}") for number, cells in rows])
    wrong = np.flatnonzero(np.diff(blocks) <= 0)
    if len(wrong):
        i = int(wrong[0]) + 1
        raise InputError(
            f"{name}, line {rows[i][0]}, column block: block {blocks[i]} does not rise above {blocks[i - 1]}"
        )
    return AxisTable(machine, values / _degrees(machine), blocks, tuple(number for number, _ in rows))


def _degrees(machine: Machine) -> NDArray:
    """What a value is multiplied by to be shown: rotary axes in degrees."""
    return np.where([joint.is_rotary for joint in machine.joints], 180.0 / np.pi, 1.0)


def _check_header(header: list[str], columns: tuple[str, ...], where: str) -> None:
    for i, wanted in enumerate(columns):
        if i >= len(header):
            raise InputError(f"{where}: column {wanted} is missing; expected {','.join(columns)}")
        if header[i] != wanted:
            raise InputError(f"{where}, column {i + 1}: expected {wanted}, got {header[i]!r}")
    if len(header) > len(columns):
        raise InputError(f"{where}: unknown column {header[len(columns)]!r} behind {columns[-1]}")


def _block(cell: str, where: str) -> int:
    if not (cell.isascii() and cell.isdigit() and len(cell) <= 15):
        raise InputError(f"{where}, column block: {cell!r} is not a block number; expected 1, 2, 3, ...")
    return int(cell)


def _row(cells: list[str], columns: tuple[str, ...], machine: str, where: str) -> list[float]:
    if len(cells) != len(columns):
        raise InputError(f"{where}: {len(cells)} cells; expected {len(columns)} for {','.join(columns)}")
    if cells[-1] != machine:
        raise InputError(f"{where}, column machine: expected {machine}, got {cells[-1]!r}")
    numbers = []
    for cell, column in zip(cells[1:-1], columns[1:-1], strict=True):
        try:
            numbers.append(float(cell))
        except ValueError:
            raise InputError(f"{where}, column {column}: {cell!r} is not a number") from None
        if not isfinite(numbers[-1]):
            raise InputError(f"{where}, column {column}: {cell} is not a finite number")
    return numbers
