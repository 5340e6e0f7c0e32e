"""The kernel for whole stock: tiles of parallel rays, each cut by the branches of a motion that may take more of it.

The air along a ray counts as cut from the start, so that what is left of the material is all that is looked for. First
chords at single poses take away most of it; then the branches that may take more are divided, and so is the tile,
down to single rows and rays, which are cut as kernels/sweep.py does.
"""

import warp as wp

from gearsim.kernels.branches import Branches, Tile, reach_of
from gearsim.kernels.interval import IntervalLists, covers, insert
from gearsim.kernels.lattice import LISTS, RAYS, SIDE, Lattice, Square, part_of, start_of, tile_of
from gearsim.kernels.material import Material, all_cover, copy_list, empty, fill, left_of, put
from gearsim.kernels.options import OPTIONS
from gearsim.kernels.pose import Motion
from gearsim.kernels.profile import Cutter, Cutters, convex_part, cutter_interval
from gearsim.kernels.sweep import STATUS_GAP_UNDECIDED, cut_by_segment
from gearsim.kernels.tool_ray import greater, lesser, tool_ray

f64 = wp.float64

wp.set_module_options(OPTIONS)

STACK = 48
SEEDS = wp.constant(64)
PER_SEED = wp.constant(f64(1.0 / 64.0))
GUESS = wp.constant(f64(0.5))
DIVIDE = wp.constant(f64(1.0))
PAD_MM = wp.constant(f64(1.0e-3))
PAD_SHARE = wp.constant(f64(1.0e-6))

stack_of = wp.types.vector(length=STACK, dtype=wp.int32)
places_of = wp.types.vector(length=64, dtype=wp.int32)
ends_of = wp.types.vector(length=64, dtype=wp.float64)


@wp.func
def cut_chords(
    cutter: Cutter, branches: Branches, node: int, row: int, lattice: Lattice, square: Square, join: f64,
    lists: IntervalLists,
) -> int:  # fmt: skip
    """Cut from a square of rays what the cutter holds of them at a branch's pose; status bits."""
    status = int(0)
    for p in range(square.size):
        for q in range(square.size):
            slot = square.slot + p * SIDE + q
            if lists.count[slot] > 1:
                o = start_of(lattice, square.i + p, square.j + q)
                ray = tool_ray(branches.tip[node], branches.axis[node], cutter.middle, o, lattice.direction)
                hit = cutter_interval(cutter, ray)
                if hit.found == 1:
                    status = status | put(lists, slot, hit.lo + ray.shift, hit.hi + ray.shift, row, join)
    return status


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
    copy_list(lists, middle, guide)
    while noted > 0:
        noted -= 1
        if not covers(lists, guide, los[noted] + margin, his[noted] - margin):
            insert(lists, guide, los[noted], his[noted], 0, 0, f64(0.0))
            level = branches.roots[seeds.root[noted]][0]
            index = branches.roots[seeds.root[noted]][1]
            row = middle_row(motion, level, index)
            seeds.status = seeds.status | cut_chords(
                cutter, branches, branches.level[level] + index, row, lattice, square, join, lists
            )
            seeds.count += 1
            seeds.root[SEEDS - seeds.count] = seeds.root[noted]
    return seeds


@wp.func
def search(
    cutter: Cutter, motion: Motion, branches: Branches, root: int, lattice: Lattice, whole: Square, window: wp.vec2d,
    tolerance: f64,
    lists: IntervalLists, counts: wp.array2d(dtype=wp.int32), t: int,
) -> int:  # fmt: skip
    """Cut a tile by all rows of a root that may take something of it; status bits."""
    levels = stack_of()
    indices = stack_of()
    squares = stack_of()
    levels[0] = branches.roots[root][0]
    indices[0] = branches.roots[root][1]
    squares[0] = whole.size * RAYS
    top = int(1)
    status = int(0)
    while top > 0:
        top -= 1
        level = levels[top]
        index = indices[top]
        code = squares[top]
        square = part_of(whole, code)
        left = window
        if square.size < SIDE:
            left = left_of(lists, square)
        if left[0] >= left[1]:
            continue
        counts[t, 0] += 1
        node = branches.level[level] + index
        tile = tile_of(lattice, square)
        width = wp.length(tile.a) + wp.length(tile.b)
        reach = reach_of(cutter, branches, node, tile, left)
        if reach.first > reach.last or all_cover(lists, square, reach.first, reach.last):
            continue
        row = middle_row(motion, level, index)
        if square.size == 1 and level == 0:
            counts[t, 1] += 1
            status = status | cut_by_segment(
                cutter, motion, row, tile.origin, tile.direction, left, tolerance, square.slot, lists
            )
            continue
        if reach.found == 1:
            lo = greater(reach.lo, left[0]) + GUESS * width
            hi = lesser(reach.hi, left[1]) - GUESS * width
            if square.size == 1:
                status = status | put(lists, square.slot, reach.lo, reach.hi, row, tolerance)
            elif not covers(lists, middle_slot(lattice, square), lo, hi):
                status = status | cut_chords(cutter, branches, node, row, lattice, square, tolerance, lists)
        move = wp.length(branches.stroke[node]) + branches.rest[node]
        if square.size == 1 or (level > 0 and move > DIVIDE * width):
            near = wp.where(reach.lead > f64(0.0), 1, 0)
            for h in range(2):
                child = 2 * index + (h + near + 1) % 2
                if (child << (level - 1)) < motion.speed.shape[0]:
                    levels[top] = level - 1
                    indices[top] = child
                    squares[top] = code
                    top += 1
        else:
            half = square.size // 2
            for k in range(4):
                levels[top] = level
                indices[top] = index
                squares[top] = code - half * RAYS + k // 2 * half * SIDE + k % 2 * half
                top += 1
    return status


@wp.kernel
def cut_tiles(
    # cutter
    cutters: Cutters,
    # motion
    motion: Motion,
    branches: Branches,
    bvh: wp.uint64,
    tolerance: f64,
    first_tag: int,
    # in
    lattice: Lattice,
    material: Material,
    first_tile: int,
    # out
    lists_out: IntervalLists,
    counts_out: wp.array2d(dtype=wp.int32),
    status_out: wp.array(dtype=wp.int32),
):
    """Leave of the material along tiles of SIDE x SIDE rays what no row of the motion takes."""
    t = wp.tid()
    columns = (lattice.second.shape[0] + SIDE - 1) // SIDE
    whole = Square()
    whole.i = (first_tile + t) // columns * SIDE
    whole.j = (first_tile + t) % columns * SIDE
    whole.size = SIDE
    whole.slot = t * LISTS
    status = int(0)
    for k in range(RAYS):
        i = whole.i + k // SIDE
        j = whole.j + k % SIDE
        lists_out.count[whole.slot + k] = 0
        if i < lattice.first.shape[0] and j < lattice.second.shape[0]:
            status = status | fill(material, i * lattice.second.shape[0] + j, lists_out, whole.slot + k)
    tile = tile_of(lattice, whole)
    window = left_of(lists_out, whole)
    extent = f64(0.0)
    if window[0] < window[1]:
        for k in range(3):
            a = wp.abs(tile.origin[k] + window[0] * tile.direction[k])
            extent += greater(a, wp.abs(tile.origin[k] + window[1] * tile.direction[k]))
        extent += wp.length(tile.a) + wp.length(tile.b)
    pad = PAD_MM + PAD_SHARE * extent
    for p in range(cutters.job_first[0], cutters.job_first[1]):
        cutter = convex_part(cutters, p, extent)
        told = int(0)
        turn = int(0)
        seeds = Seeds()
        while turn < 2:
            window = left_of(lists_out, whole)
            if window[0] >= window[1] or (turn == 1 and (told & ~STATUS_GAP_UNDECIDED) == 0):
                break
            told = told & STATUS_GAP_UNDECIDED
            if turn == 0:
                seeds = seed(cutter, motion, branches, bvh, lattice, whole, window, pad, tolerance, lists_out)
                told = told | seeds.status
            window = left_of(lists_out, whole)
            query = query_of(bvh, tile, window, pad)
            root = int(0)
            pairs = int(0)
            given = int(0)
            while True:
                if given < seeds.count:
                    given += 1
                    root = seeds.root[SEEDS - given]
                elif not wp.bvh_query_next(query, root, wp.float32(1.0)):
                    break
                if counts_out[t, 1] != pairs:
                    pairs = counts_out[t, 1]
                    window = left_of(lists_out, whole)
                    if window[0] >= window[1]:
                        break
                told = told | search(
                    cutter, motion, branches, root, lattice, whole, window, tolerance, lists_out, counts_out, t
                )
            turn += 1
        status = status | told
    for k in range(RAYS):
        empty(lists_out, whole.slot + k, first_tag)
    status_out[t] = status
