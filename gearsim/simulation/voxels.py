"""A sparse grid of signed distances: the stock's second representation, for volumes, queries and booleans.

Nodes are the cell centres of a DexelBox and some beyond, in bricks of 8 x 8 x 8; bricks are kept where a surface is
within a ``band``, sorted by place, and found by a directory of one integer for each brick there could be, which is
1/128 byte a node. (Warp's NanoVDB volumes are made on the CPU too and may hold float64, but take places in float32:
half a thousandth of a voxel at the ten-thousandth; a value costs 27 ns there, 20 ns here.)

What a node's number says. A cut makes the stock's distance d the larger of itself and minus the least distance of the
passing tool. Where there is material that is exact: the nearest surface is the nearest of what bounds it. In air it
is a bound: the true distance is at least d, and more where tools overlap or the blank's faces only meet beyond the
point. So zero lies on the surface everywhere, the ball of radius ``abs(d)`` around every node holds none, and d is
1-Lipschitz; but gradients and offsets are right on the material's side alone, and a band that is kept in air may be
wider than asked for. Walls and slots thinner than the spacing may fall between the nodes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.solid import Block, Solid
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.room import require_bytes

SIDE = 8
AIR, MATERIAL = -1, -2
BRICK_BYTES = 2 * (4 * SIDE**3 + 12)  # values and place, while old and new ones are kept
_DIRECTORY_BYTES = 4 + 4 * 8  # while a blank is looked at
_MARGIN = 2  # nodes beyond the box: its faces lie between nodes
_BAND = 3.0  # spacings; less than a cell's diagonal would leave surfaces between bricks that are not kept
_TILE = 1 << 12
_FLOAT32 = 2.0**-24
_CORNERS = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij"), axis=-1).reshape(8, 3)
_REMEDY = "raise the pitch, or take a sector or a part of the box"


@dataclass(frozen=True)
class VoxelStock:
    """Signed distances [mm] of a stock's surface, negative in its material, around that surface alone.

    ``directory``: for every brick its row, or AIR or MATERIAL where all its nodes are farther than ``band`` [mm] from
    the surface. ``brick`` (n, 3): bricks that are kept, in rising order; ``values`` (n, 512), float32: their nodes',
    z fastest, held within plus and minus the band. They are off by at most ``error`` [mm].
    """

    box: DexelBox
    band: float
    error: float
    directory: NDArray[np.int32]
    brick: NDArray[np.int32]
    values: NDArray[np.float32]

    @property
    def spacing(self) -> NDArray:
        """Between nodes along the box's edges [mm], shape (3,)."""
        return spacing_of(self.box)

    @property
    def origin(self) -> NDArray:
        """The first node in the box's frame [mm], shape (3,)."""
        return origin_of(self.box)

    @property
    def nbytes(self) -> int:
        """What it takes in memory [bytes]."""
        return self.directory.nbytes + self.brick.nbytes + self.values.nbytes

    def node_values(self, node: NDArray[np.integer]) -> NDArray:
        """Distances [mm] at nodes, shape (..., 3); where none are kept plus or minus the band."""
        size = SIDE * np.array(self.directory.shape)
        within = np.all((node >= 0) & (node < size), axis=-1)
        node = np.where(within[..., None], node, 0)
        place = np.where(within, self.directory[tuple(np.moveaxis(node // SIDE, -1, 0))], AIR)
        x, y, z = np.moveaxis(node % SIDE, -1, 0)
        far = np.where(place == MATERIAL, -self.band, self.band)
        if not len(self.values):
            return far
        return np.where(place >= 0, self.values[place, (x * SIDE + y) * SIDE + z], far)

    def distance(self, points: NDArray) -> NDArray:
        """Signed distance [mm] of points [mm] in the part's frame, shape (n, 3), linear between nodes.

        In air and beyond edges it is a lower bound; held within plus and minus the band.
        """
        low, share = self._cell(points)
        total = np.zeros(len(points))
        for corner in _CORNERS:
            weight = np.where(corner == 1, share, 1.0 - share).prod(axis=-1)
            total += weight * self.node_values(low + corner)
        return total

    def side(self, points: NDArray) -> NDArray[np.integer]:
        """Where points [mm], shape (n, 3), certainly are: -1 in material, 1 in air; 0 where the grid does not tell."""
        low, share = self._cell(points)
        side = np.zeros(len(points), dtype=int)
        for corner in _CORNERS:
            value = self.node_values(low + corner)
            clear = np.linalg.norm((share - corner) * self.spacing, axis=-1) + self.error
            side += np.where(np.abs(value) > clear, np.sign(value).astype(int), 0)
        return np.sign(side)

    def _cell(self, points: NDArray) -> tuple[NDArray[np.integer], NDArray]:
        """The lowest node of each point's cell, and the point's share of the way to the next along each edge."""
        local = (self.box.frame.inverse().point(points) - self.origin) / self.spacing
        low = np.floor(local).astype(int)
        return low, local - low


def spacing_of(box: DexelBox) -> NDArray:
    """Between a box's nodes [mm], shape (3,)."""
    return (box.upper - box.lower) / box.counts


def origin_of(box: DexelBox) -> NDArray:
    """A box's first node in its frame [mm], shape (3,)."""
    return box.lower + (0.5 - _MARGIN) * spacing_of(box)


def brick_reach(box: DexelBox) -> float:
    """From a brick's middle to its farthest node [mm]."""
    return 0.5 * (SIDE - 1) * float(np.linalg.norm(spacing_of(box)))


def blank_voxels(box: DexelBox, blank: Solid) -> VoxelStock:
    """A blank, as far as it lies in a box. Raises InputError where there is no memory for it, before any is taken."""
    shape = tuple(-(-(box.counts + 2 * _MARGIN) // SIDE))
    _require(_DIRECTORY_BYTES * float(np.prod(shape, dtype=float)), box, "to look where its surface is")
    band = _BAND * float(spacing_of(box).max())
    lattice = np.stack(np.unravel_index(np.arange(np.prod(shape)), shape), axis=-1).astype(np.int32)
    middle = np.concatenate([_distances(box, blank, SIDE * part + 0.5 * (SIDE - 1)) for part in _tiles(lattice)])
    brick = lattice[np.abs(middle) < band + brick_reach(box)]
    require_bricks(len(brick), box)
    directory = np.where(middle > 0.0, AIR, MATERIAL).astype(np.int32).reshape(shape)
    nodes = _tiles(SIDE * brick[:, None, :] + np.indices((SIDE,) * 3).reshape(3, -1).T)
    values = [np.clip(_distances(box, blank, part), -band, band).astype(np.float32) for part in nodes]
    return settled(VoxelStock(box, band, rounding(band), directory, brick, np.concatenate(values)))


def rounding(band: float) -> float:
    """By how much float32 rounds distances up to a band [mm]."""
    return _FLOAT32 * band


def require_bricks(bricks: int, box: DexelBox) -> None:
    """Raise InputError where there is no memory for bricks."""
    _require(float(BRICK_BYTES * bricks), box, f"for {bricks:,} bricks of {SIDE}³ voxels")


def _require(needed: float, box: DexelBox, why: str) -> None:
    require_bytes(
        needed, f"a voxel grid of pitch {box.pitch:g} mm in a box of {box.upper - box.lower} mm {why} needs", _REMEDY
    )


def settled(stock: VoxelStock) -> VoxelStock:
    """The same stock without bricks that say no more than the directory can, the others in order of their place."""
    low, high = stock.values.min(axis=1, initial=np.inf), stock.values.max(axis=1, initial=-np.inf)
    band, directory = np.float32(stock.band), stock.directory.copy()
    kept = (low < band) & (high > -band)
    directory[tuple(stock.brick.T)] = np.where(low >= band, AIR, MATERIAL)
    brick, values = stock.brick[kept], stock.values[kept]
    order = np.lexsort(brick.T[::-1])
    directory[tuple(brick[order].T)] = np.arange(len(order))
    return VoxelStock(stock.box, stock.band, stock.error, directory, brick[order], values[order])


def _tiles(rows: NDArray) -> Iterator[NDArray]:
    """Rows a tile at a time; an empty array is one tile."""
    return (rows[begin : begin + _TILE] for begin in range(0, max(len(rows), 1), _TILE))


def _distances(box: DexelBox, blank: Solid, node: NDArray) -> NDArray:
    """Distance [mm] of a blank cut off at the box, at nodes (..., 3), whole or not."""
    local = origin_of(box) + spacing_of(box) * node
    inside = Block(box.lower, box.upper).signed_distance(local)
    return np.maximum(blank.signed_distance(box.frame.point(local)), inside)
