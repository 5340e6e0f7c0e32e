"""The kernel for whole stock: tiles of parallel rays, each cut by the branches of a motion that may take more of it.

The air along a ray counts as cut from the start, so that what is left of the material is all that is looked for. First
chords at single poses take away most of it; then the branches that may take more are divided, and so is the tile,
down to single rows and rays, which are cut as kernels/sweep.py does. What a branch cannot take of a ray is told by
planes, for each ray of a square by how far it lies beside the middle one; half a tolerance more is not looked for.
"""

import warp as wp

from gearsim.kernels.branches import Branches, Tile, at_end, branch_at, reach_of
from gearsim.kernels.interval import IntervalLists
from gearsim.kernels.lattice import LISTS, RAYS, SIDE, Lattice, Square, part_of, start_of, tile_of
from gearsim.kernels.material import Material, empty, fill, left_of
from gearsim.kernels.options import OPTIONS
from gearsim.kernels.pose import Motion, place_at
from gearsim.kernels.profile import LINE, Cutter, Cutters, convex_part
from gearsim.kernels.seeds import SEEDS, Seeds, is_seed, middle_row, query_of, seed
from gearsim.kernels.squares import ALL, chord_of, cut_chords, mask_of, open_rays
from gearsim.kernels.sweep import STATUS_GAP_UNDECIDED, cut_by_segment
from gearsim.kernels.tool_ray import greater

f64 = wp.float64

wp.set_module_options(OPTIONS)

STACK = 48
CHANGED = wp.constant(1 << 16)  # beside the status bits: something was cut
SMALL = wp.constant(2)
GUESS = wp.constant(f64(0.5))
DIVIDE = wp.constant(f64(2.0))
PAD_MM = wp.constant(f64(1.0e-3))
PAD_SHARE = wp.constant(f64(1.0e-6))

stack_of = wp.types.vector(length=STACK, dtype=wp.int32)
masks_of = wp.types.vector(length=STACK, dtype=wp.uint64)
ways_of = wp.types.vector(length=STACK, dtype=wp.float64)


@wp.func
def widest(cutter: Cutter) -> f64:
    """The cutter's largest radius."""
    most = f64(0.0)
    for k in range(cutter.first, cutter.end):
        most = greater(most, cutter.slabs[k, 2])
        if cutter.slabs[k, 5] == LINE:
            most = greater(most, cutter.slabs[k, 2] + cutter.slabs[k, 3] * (cutter.slabs[k, 1] - cutter.slabs[k, 0]))
        else:
            most = greater(most, cutter.slabs[k, 2] + cutter.slabs[k, 4])
    return most


@wp.struct
class Looked:
    """The rays of a square of which a branch may take more, the end of it that takes more, and status bits.

    ``moves``: whether the bounds are wide because of the branch's motion rather than because of the square's size.
    """

    rays: wp.uint64
    way: f64
    status: wp.int32
    moves: wp.int32


@wp.func
def look(
    cutter: Cutter, motion: Motion, branches: Branches, level: int, index: int,
    lattice: Lattice, whole: Square, square: Square, window: wp.vec2d, rays: wp.uint64, way: f64, tolerance: f64,
    lists: IntervalLists,
) -> Looked:  # fmt: skip
    """Cut from rays of a square what the tool holds of them at a pose of a branch, and see which it may take more of.

    A single row is also seen from the end ``way`` that takes more: where it is the row's best pose the bound there is
    as close as the chord.
    """
    branch = branch_at(branches, branches.level[level] + index)
    row = middle_row(motion, level, index)
    tile = tile_of(lattice, square)
    width = wp.length(tile.a) + wp.length(tile.b)
    bent = width * width / widest(cutter)
    looked = Looked()
    looked.rays = rays
    looked.way = way
    if square.size == 1 or wp.length(branch.stroke) + branch.rest > DIVIDE * bent:
        looked.moves = 1
    turns = wp.where(level == 0 and square.size <= SMALL and way == f64(0.0), 2, 1)
    while turns > 0 and looked.rays != wp.uint64(0):
        turns -= 1
        if looked.way != f64(0.0):
            place = place_at(motion, row, looked.way)
            branch = at_end(branch, place.tip, place.axis, looked.way)
        reach = reach_of(cutter, branch, tile, window)
        if looked.way == f64(0.0):
            looked.way = wp.where(reach.lo_lead + reach.hi_lead > f64(0.0), f64(1.0), f64(-1.0))
        if reach.found == 1 and turns == 0:
            chord = chord_of(reach, GUESS * bent)
            fresh = open_rays(chord, lattice, whole, square, looked.rays, f64(0.0), lists)
            if fresh != wp.uint64(0):
                looked.status = CHANGED | cut_chords(
                    cutter, branch.tip, branch.axis, row, lattice, whole, square, fresh, tolerance, lists
                )
        looked.rays = open_rays(reach, lattice, whole, square, looked.rays, GUESS * tolerance, lists)
    return looked


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
    open = masks_of()
    ways = ways_of()
    levels[0] = branches.roots[root][0]
    indices[0] = branches.roots[root][1]
    squares[0] = whole.size * RAYS
    open[0] = ALL
    ways[0] = f64(0.0)
    top = int(1)
    status = int(0)
    while top > 0:
        top -= 1
        level = levels[top]
        index = indices[top]
        code = squares[top]
        square = part_of(whole, code)
        counts[t, 0] += 1
        looked = look(
            cutter,
            motion,
            branches,
            level,
            index,
            lattice,
            whole,
            square,
            window,
            open[top],
            ways[top],
            tolerance,
            lists,
        )
        status = status | looked.status
        if looked.rays == wp.uint64(0):
            continue
        if square.size == 1 and level == 0:
            counts[t, 1] += 1
            status = status | CHANGED
            origin = start_of(lattice, square.i, square.j)
            left = left_of(lists, square)
            status = status | cut_by_segment(
                cutter, motion, index, origin, lattice.direction, left, tolerance, square.slot, lists
            )
            continue
        if level > 0 and looked.moves == 1:
            near = wp.where(looked.way > f64(0.0), 1, 0)
            for h in range(2):
                child = 2 * index + (h + near + 1) % 2
                if (child << (level - 1)) < motion.speed.shape[0]:
                    levels[top] = level - 1
                    indices[top] = child
                    squares[top] = code
                    open[top] = looked.rays
                    ways[top] = f64(0.0)
                    top += 1
        else:
            half = square.size // 2
            for k in range(4):
                part = code - half * RAYS + k // 2 * half * SIDE + k % 2 * half
                mine = looked.rays & mask_of(part)
                if mine != wp.uint64(0):
                    levels[top] = level
                    indices[top] = index
                    squares[top] = part
                    open[top] = mine
                    ways[top] = wp.where(level == 0 and half <= SMALL, looked.way, f64(0.0))
                    top += 1
    return status


@wp.func
def extent_of(tile: Tile, window: wp.vec2d) -> f64:
    """More than any coordinate of a tile's rays within a window; 0 where that is empty."""
    extent = f64(0.0)
    if window[0] < window[1]:
        for k in range(3):
            a = wp.abs(tile.origin[k] + window[0] * tile.direction[k])
            extent += greater(a, wp.abs(tile.origin[k] + window[1] * tile.direction[k]))
        extent += wp.length(tile.a) + wp.length(tile.b)
    return extent


@wp.func
def cut_tile(
    cutter: Cutter, motion: Motion, branches: Branches, bvh: wp.uint64, lattice: Lattice, whole: Square, pad: f64,
    tolerance: f64,
    lists: IntervalLists, counts: wp.array2d(dtype=wp.int32), t: int,
) -> int:  # fmt: skip
    """Cut a tile by a whole motion: by the seeds, then by all roots; status bits.

    A search that had to give up, for instance for want of slots, is tried once more with what is cut by then.
    """
    tile = tile_of(lattice, whole)
    told = int(0)
    turn = int(0)
    seeds = Seeds()
    while turn < 2:
        window = left_of(lists, whole)
        if window[0] >= window[1] or (turn == 1 and (told & ~STATUS_GAP_UNDECIDED) == 0):
            break
        told = told & STATUS_GAP_UNDECIDED
        if turn == 0:
            seeds = seed(cutter, motion, branches, bvh, lattice, whole, window, pad, tolerance, lists)
            told = told | seeds.status
            window = left_of(lists, whole)
        query = query_of(bvh, tile, window, pad)
        root = int(0)
        given = int(0)
        while window[0] < window[1]:
            if given < seeds.count:
                given += 1
                root = seeds.root[SEEDS - given]
            elif not wp.bvh_query_next(query, root, wp.float32(1.0)):
                break
            elif is_seed(seeds, root):
                continue
            found = search(cutter, motion, branches, root, lattice, whole, window, tolerance, lists, counts, t)
            told = told | (found & ~CHANGED)
            if (found & CHANGED) != 0:
                window = left_of(lists, whole)
        turn += 1
    return told


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
    extent = extent_of(tile_of(lattice, whole), left_of(lists_out, whole))
    for p in range(cutters.job_first[0], cutters.job_first[1]):
        cutter = convex_part(cutters, p, extent)
        pad = PAD_MM + PAD_SHARE * extent
        status = status | cut_tile(
            cutter, motion, branches, bvh, lattice, whole, pad, tolerance, lists_out, counts_out, t
        )
    for k in range(RAYS):
        empty(lists_out, whole.slot + k, first_tag)
    status_out[t] = status
