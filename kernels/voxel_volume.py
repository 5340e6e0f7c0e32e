"""The volume that bricks of signed distances hold: the best estimate, and between which bounds it is certain."""

import warp as wp

from gearsim.kernels.options import OPTIONS
from gearsim.kernels.voxels import AIR, MATERIAL, NODES, SIDE, Lattice, node_of

f64 = wp.float64

wp.set_module_options(OPTIONS)

SPLIT = wp.constant(3)
PARTS = wp.constant(f64(3.0))
Corners = wp.types.vector(length=8, dtype=f64)


@wp.func
def value_at(lattice: Lattice, values: wp.array2d(dtype=wp.float32), node: wp.vec3i) -> f64:
    """A node's signed distance [mm], plus or minus the band where it is farther; air outside of the lattice."""
    b = wp.vec3i(node[0] // SIDE, node[1] // SIDE, node[2] // SIDE)
    shape = lattice.directory.shape
    if b[0] >= shape[0] or b[1] >= shape[1] or b[2] >= shape[2]:
        return lattice.band
    place = lattice.directory[b[0], b[1], b[2]]
    if place == AIR:
        return lattice.band
    if place == MATERIAL:
        return -lattice.band
    local = node - b * SIDE
    return f64(values[place, (local[0] * SIDE + local[1]) * SIDE + local[2]])


@wp.func
def corner_of(i: int) -> wp.vec3i:
    """Corner i of a cell: bit 2 along x, bit 1 along y, bit 0 along z."""
    return wp.vec3i((i >> 2) & 1, (i >> 1) & 1, i & 1)


@wp.func
def below_zero(a: f64, b: f64, c: f64, d: f64, otherwise: f64) -> f64:
    """The share of a tetrahedron in which the linear function with these corners is below zero.

    ``otherwise`` is the share where it is zero throughout.
    """
    v = wp.vec4d(a, b, c, d)
    for i in range(3):
        for j in range(3 - i):
            low = wp.min(v[j], v[j + 1])
            v[j + 1] = wp.max(v[j], v[j + 1])
            v[j] = low
    if v[0] == f64(0.0) and v[3] == f64(0.0):
        return otherwise
    if v[0] >= f64(0.0):
        return f64(0.0)
    if v[3] <= f64(0.0):
        return f64(1.0)
    if v[1] >= f64(0.0):
        return (v[0] / (v[0] - v[1])) * (v[0] / (v[0] - v[2])) * (v[0] / (v[0] - v[3]))
    if v[2] <= f64(0.0):
        return f64(1.0) - (v[3] / (v[3] - v[0])) * (v[3] / (v[3] - v[1])) * (v[3] / (v[3] - v[2]))
    p = v[0] / (v[0] - v[2])
    q = v[0] / (v[0] - v[3])
    r = v[1] / (v[1] - v[2])
    s = v[1] / (v[1] - v[3])
    return p * q + q * r * (f64(1.0) - p) + r * s * (f64(1.0) - q)


@wp.func
def cell_share(d: Corners) -> f64:
    """The share of a cell below zero: that of six tetrahedra around its diagonal.

    A tetrahedron with its corners on the surface belongs to what most of the cell belongs to.
    """
    total = f64(0.0)
    for i in range(8):
        total += d[i]
    otherwise = f64(0.5)
    if total < f64(0.0):
        otherwise = f64(1.0)
    elif total > f64(0.0):
        otherwise = f64(0.0)
    share = f64(0.0)
    for i in range(3):
        for j in range(2):
            one = 1 << i
            two = one | (1 << ((i + 1 + j) % 3))
            share += below_zero(d[0], d[one], d[two], d[7], otherwise)
    return share / f64(6.0)


@wp.func
def certain_shares(d: Corners, spacing: wp.vec3d, error: f64) -> wp.vec2d:
    """What share of a cell is certainly material, and what share at most.

    Around every corner there is a ball, of the size of its distance, without a surface. The cell is taken in parts,
    each as one with the ball around it.
    """
    part = spacing / PARTS
    outer = f64(0.5) * wp.length(part) + error
    least = int(0)
    most = int(0)
    split = int(SPLIT)  # a variable, so that the loops are not unrolled
    for i in range(split):
        for j in range(split):
            for k in range(split):
                middle = wp.cw_mul(part, wp.vec3d(f64(i) + f64(0.5), f64(j) + f64(0.5), f64(k) + f64(0.5)))
                inside = f64(1.0e30)
                outside = f64(-1.0e30)
                for c in range(8):
                    corner = corner_of(c)
                    at = wp.cw_mul(spacing, wp.vec3d(f64(corner[0]), f64(corner[1]), f64(corner[2])))
                    aside = wp.length(middle - at)
                    inside = wp.min(inside, d[c] + aside)
                    outside = wp.max(outside, d[c] - aside)
                if inside <= -outer:
                    least += 1
                if outside < outer:
                    most += 1
    whole = PARTS * PARTS * PARTS
    return wp.vec2d(f64(least) / whole, f64(most) / whole)


@wp.kernel
def measure_bricks(
    # in
    lattice: Lattice, values: wp.array2d(dtype=wp.float32), brick: wp.array(dtype=wp.vec3i), begin: int,
    # out
    cells_out: wp.array(dtype=wp.vec3d),
):  # fmt: skip
    """Cells of material in a brick, each cell by its lowest node: estimated, certain, and at most."""
    i = begin + wp.tid()
    clear = wp.length(lattice.spacing) + lattice.error
    total = wp.vec3d()
    for number in range(NODES):
        node = brick[i] * SIDE + node_of(number)
        lowest = value_at(lattice, values, node)
        if lowest <= -clear:
            total += wp.vec3d(f64(1.0), f64(1.0), f64(1.0))
        elif lowest < clear:
            d = Corners()
            for c in range(8):
                d[c] = value_at(lattice, values, node + corner_of(c))
            bounds = certain_shares(d, lattice.spacing, lattice.error)
            total += wp.vec3d(cell_share(d), bounds[0], bounds[1])
    cells_out[i] = total
