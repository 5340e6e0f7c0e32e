"""Bricks of signed distances, and how a passing tool cuts them."""

import warp as wp

from gearsim.kernels.options import OPTIONS
from gearsim.kernels.passing import pass_distance
from gearsim.kernels.pose import Motion
from gearsim.kernels.ring import Ring
from gearsim.kernels.sweep import STATUS_NOT_CONVERGED

f64 = wp.float64

wp.set_module_options(OPTIONS)

SIDE = wp.constant(8)
NODES = wp.constant(512)
AIR = wp.constant(-1)
MATERIAL = wp.constant(-2)
BOX_PAD = wp.constant(wp.float32(1.0e-3))


@wp.struct
class Lattice:
    """Bricks of 8 x 8 x 8 nodes: ``origin`` and ``spacing`` [mm] of the nodes; distances are kept within ``band`` [mm].

    ``error`` [mm] is what kept distances may be off by. ``directory`` holds each brick's row of the values, or AIR or
    MATERIAL where all nodes are a band or more away from any surface.
    """

    origin: wp.vec3d
    spacing: wp.vec3d
    band: f64
    error: f64
    directory: wp.array3d(dtype=wp.int32)


@wp.func
def node_at(lattice: Lattice, node: wp.vec3i) -> wp.vec3d:
    """Where a node is [mm]."""
    return lattice.origin + wp.cw_mul(lattice.spacing, wp.vec3d(f64(node[0]), f64(node[1]), f64(node[2])))


@wp.func
def node_of(number: int) -> wp.vec3i:
    """A brick's node by its number, z fastest."""
    return wp.vec3i(number // (SIDE * SIDE), (number // SIDE) % SIDE, number % SIDE)


@wp.kernel
def find_rows(
    # cutter
    ring: Ring, hollow: int,
    # motion
    motion: Motion, bvh: wp.uint64,
    # in
    lattice: Lattice, reach: f64, tolerance: f64, begin: int, brick: wp.array(dtype=wp.vec3i),
    first: wp.array(dtype=wp.int32), fill: int,
    # out
    nearest_out: wp.array(dtype=f64), count_out: wp.array(dtype=wp.int32), row_out: wp.array(dtype=wp.int32),
    least_out: wp.array(dtype=f64), status_out: wp.array(dtype=wp.int32),
):  # fmt: skip
    """The rows that may lower a distance in a brick, and how near each comes to its middle, to a coarse tolerance.

    No node is farther than ``reach`` from there. First the nearest is found and the rows are counted, rather too many;
    none where the tool swallows brick and band whole. Then they are filled in.
    """
    i = begin + wp.tid()
    lowest = node_at(lattice, brick[i] * SIDE)
    half = lattice.spacing * (f64(0.5) * f64(SIDE - 1))
    centre = lowest + half
    grown = half + wp.vec3d(lattice.band, lattice.band, lattice.band)
    pad = wp.vec3(BOX_PAD, BOX_PAD, BOX_PAD)
    near = lattice.band + reach
    nearest = near
    count = int(0)
    if fill == 1:
        nearest = nearest_out[i]
    query = wp.bvh_query_aabb(bvh, wp.vec3(centre - grown) - pad, wp.vec3(centre + grown) + pad)
    row = int(0)
    while nearest > -near and wp.bvh_query_next(query, row):
        useful = wp.min(near, nearest + f64(2.0) * reach) + tolerance
        found = pass_distance(ring, hollow, motion, row, centre, useful, tolerance)
        if found[1] > f64(0.0):
            status_out[i] = STATUS_NOT_CONVERGED
        if found[0] < useful:
            if fill == 1 and count == first[i + 1] - first[i]:  # a search to a tolerance may turn out otherwise
                status_out[i] = STATUS_NOT_CONVERGED
                count -= 1
            elif fill == 1:
                row_out[first[i] + count] = row
                least_out[first[i] + count] = found[0] - tolerance
            nearest = wp.min(nearest, found[0])
            count += 1
    nearest_out[i] = nearest
    count_out[i] = wp.where(nearest > -near, count, 0)


@wp.kernel
def cut_nodes(
    # cutter
    ring: Ring, hollow: int,
    # motion
    motion: Motion,
    # in
    lattice: Lattice, tolerance: f64, begin: int, brick: wp.array(dtype=wp.vec3i),
    first: wp.array(dtype=wp.int32), row: wp.array(dtype=wp.int32), least: wp.array(dtype=f64),
    # out
    values_out: wp.array2d(dtype=wp.float32), status_out: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Take what the brick's rows sweep out of one node's distance: the larger of it and minus the least distance.

    ``least`` rises within a brick: no row of it is nearer than that to the brick's middle. What changes by less than
    ``tolerance`` is left, so that nothing is cut twice; a node as near as that to the new surface is put onto it, so
    that faces in planes of nodes are met whole.
    """
    t = begin + wp.tid()
    i = t // NODES
    number = t % NODES
    here = node_at(lattice, brick[i] * SIDE + node_of(number))
    half = lattice.spacing * (f64(0.5) * f64(SIDE - 1))
    aside = wp.length(here - node_at(lattice, brick[i] * SIDE) - half)
    before = f64(values_out[i, number])
    best = -before
    k = first[i]
    while k < first[i + 1] and best > -lattice.band:
        if least[k] - aside >= best:
            k = first[i + 1]
        else:
            found = pass_distance(ring, hollow, motion, row[k], here, best, tolerance)
            best = found[0]
            if found[1] > f64(0.0):
                status_out[i] = STATUS_NOT_CONVERGED
            k += 1
    if best < -before - tolerance:
        if wp.abs(best) <= tolerance:
            best = f64(0.0)
        values_out[i, number] = wp.float32(wp.min(-best, lattice.band))
