"""Where to begin with a tile: a few poses whose chords, together, take away most of what its rays lose."""

import warp as wp

from gearsim.kernels.branches import Branches, Tile
from gearsim.kernels.interval import IntervalLists, covers, insert
from gearsim.kernels.lattice import RAYS, SIDE, Lattice, Square, tile_of
from gearsim.kernels.material import copy_list
from gearsim.kernels.pose import Motion
from gearsim.kernels.profile import Cutter, cutter_interval
from gearsim.kernels.squares import ALL, cut_chords, cut_common
from gearsim.kernels.tool_ray import greater, tool_ray

f64 = wp.float64

PLACES = 96
SEEDS = wp.constant(PLACES)
PER_SEED = wp.constant(f64(0.5 / PLACES))
GUESS = wp.constant(f64(0.5))

places_of = wp.types.vector(length=PLACES, dtype=wp.int32)
ends_of = wp.types.vector(length=PLACES, dtype=wp.float64)


@wp.func
def middle_row(motion: Motion, level: int, index: int) -> int:
    """The row at whose pose a branch stands."""
    begin = index << level
    return (begin + wp.min(begin + (1 << level), motion.speed.shape[0])) // 2


@wp.func
def middle_slot(lattice: Lattice, square: Square) -> int:
    """The list of the ray in the middle of a square."""
    p = wp.min(square.size, lattice.first.shape[0] - square.i) // 2
    q = wp.min(square.size, lattice.second.shape[0] - square.j) // 2
    return square.slot + p * SIDE + q


@wp.func
def query_of(bvh: wp.uint64, tile: Tile, window: wp.vec2d, pad: f64):
    """The roots whose boxes a tile meets within a window."""
    start = wp.vec3(tile.origin + window[0] * tile.direction)
    way = wp.vec3((window[1] - window[0]) * tile.direction)
    return wp.bvh_query_capsule(bvh, start, way, wp.float32(pad + wp.length(tile.a) + wp.length(tile.b)), -1)


@wp.struct
class Seeds:
    """``count`` roots, the first of them last in ``root``, and status bits."""

    count: wp.int32
    status: wp.int32
    root: places_of


@wp.func
def plant(
    cutter: Cutter, motion: Motion, branches: Branches, seeds: Seeds, lattice: Lattice, square: Square, join: f64,
    lists: IntervalLists,
) -> int:  # fmt: skip
    """Cut by the seeds' chords what all rays lose alike, and where anything is left every ray by itself; status bits.

    Most tiles are empty after the first.
    """
    status = int(0)
    for k in range(2 * seeds.count):
        root = seeds.root[SEEDS - 1 - k % seeds.count]
        level = branches.roots[root][0]
        index = branches.roots[root][1]
        row = middle_row(motion, level, index)
        node = branches.level[level] + index
        if k < seeds.count:
            status = status | cut_common(
                cutter, branches.tip[node], branches.axis[node], row, lattice, square, join, lists
            )
        else:
            status = status | cut_chords(
                cutter, branches.tip[node], branches.axis[node], row, lattice, square, square, ALL, join, lists
            )
    return status


@wp.func
def seed(
    cutter: Cutter, motion: Motion, branches: Branches, bvh: wp.uint64, lattice: Lattice, square: Square,
    window: wp.vec2d, pad: f64, join: f64, lists: IntervalLists,
) -> Seeds:  # fmt: skip
    """Cut chords at the poses of a few roots, found along the middle ray.

    Those that take something from it are noted (the more are, the longer a chord must be), and applied to all rays
    from the last to the first, those that then take nothing more left out: the last of them takes most.
    """
    tile = tile_of(lattice, square)
    middle = middle_slot(lattice, square)
    guide = square.slot + RAYS
    margin = GUESS * (wp.length(tile.a) + wp.length(tile.b))
    seeds = Seeds()
    los = ends_of()
    his = ends_of()
    noted = int(0)
    longest = f64(0.0)
    copy_list(lists, middle, guide)
    query = query_of(bvh, tile, window, pad)
    root = int(0)
    while wp.bvh_query_next(query, root, wp.float32(1.0)):
        node = branches.level[branches.roots[root][0]] + branches.roots[root][1]
        ray = tool_ray(branches.tip[node], branches.axis[node], cutter.middle, tile.origin, tile.direction)
        hit = cutter_interval(cutter, ray)
        lo = hit.lo + ray.shift + margin
        hi = hit.hi + ray.shift - margin
        least = longest * f64(noted) * PER_SEED
        inside = lo < hi and lo < window[1] and hi > window[0]
        if hit.found == 1 and inside and noted < SEEDS and hi - lo >= least:
            longest = greater(longest, hi - lo)
            if not covers(lists, guide, lo + margin, hi - margin):
                insert(lists, guide, lo, hi, 0, 0, f64(0.0))
                seeds.root[noted] = root
                los[noted] = lo
                his[noted] = hi
                noted += 1
                if covers(lists, guide, window[0], window[1]):
                    break
    copy_list(lists, middle, guide)
    while noted > 0:
        noted -= 1
        if not covers(lists, guide, los[noted] + margin, his[noted] - margin):
            insert(lists, guide, los[noted], his[noted], 0, 0, f64(0.0))
            seeds.count += 1
            seeds.root[SEEDS - seeds.count] = seeds.root[noted]
    seeds.status = plant(cutter, motion, branches, seeds, lattice, square, join, lists)
    return seeds


@wp.func
def is_seed(seeds: Seeds, root: int) -> bool:
    """Whether a root is one of the seeds."""
    for k in range(seeds.count):
        if seeds.root[SEEDS - 1 - k] == root:
            return True
    return False
