"""Parallel rays through a plane lattice, and squares of them."""

import warp as wp

from gearsim.kernels.branches import Tile

f64 = wp.float64

SIDE = wp.constant(8)
RAYS = wp.constant(64)  # of a tile
LISTS = wp.constant(65)  # of a tile: one a ray, and one more


@wp.struct
class Lattice:
    """Ray (i, j) begins at origin + first[i] u + second[j] v; rays are numbered with j fastest."""

    origin: wp.vec3d
    u: wp.vec3d
    v: wp.vec3d
    direction: wp.vec3d
    first: wp.array(dtype=f64)
    second: wp.array(dtype=f64)


@wp.struct
class Square:
    """Rays i to i + size, j to j + size, as far as there are so many; ray (i + p, j + q) has list slot + p SIDE + q."""

    i: wp.int32
    j: wp.int32
    size: wp.int32
    slot: wp.int32


@wp.func
def start_of(lattice: Lattice, i: int, j: int) -> wp.vec3d:
    """Where a ray begins."""
    return lattice.first[i] * lattice.u + lattice.second[j] * lattice.v + lattice.origin


@wp.func
def part_of(whole: Square, code: int) -> Square:
    """A part of a tile, told by its (size SIDE + i) SIDE + j."""
    square = Square()
    square.size = code // (SIDE * SIDE)
    i = code // SIDE % SIDE
    j = code % SIDE
    square.i = whole.i + i
    square.j = whole.j + j
    square.slot = whole.slot + i * SIDE + j
    return square


@wp.func
def tile_of(lattice: Lattice, square: Square) -> Tile:
    """The rays of a square that has any."""
    i = wp.min(square.i + square.size, lattice.first.shape[0]) - 1
    j = wp.min(square.j + square.size, lattice.second.shape[0]) - 1
    tile = Tile()
    tile.origin = f64(0.5) * (start_of(lattice, square.i, square.j) + start_of(lattice, i, j))
    tile.direction = lattice.direction
    tile.a = f64(0.5) * (lattice.first[i] - lattice.first[square.i]) * lattice.u
    tile.b = f64(0.5) * (lattice.second[j] - lattice.second[square.j]) * lattice.v
    return tile
