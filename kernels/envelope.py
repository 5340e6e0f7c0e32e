"""Closed-form grazing points for batches: the device twin of geometry/grazing.py."""

import warp as wp

from gearsim.kernels.options import OPTIONS

f64 = wp.float64

# Circles that stand still or move along their axis, as in geometry/grazing.py.
AT_REST = wp.constant(f64(1e-10))
PARALLEL = wp.constant(f64(1e-11))

wp.set_module_options(OPTIONS)


@wp.struct
class Grazing:
    """A grazing point and the tool's outward normal there; ``exists`` 0 where there is none."""

    exists: wp.int32
    point: wp.vec3d
    normal: wp.vec3d


@wp.func
def grazing_point(
    tip: wp.vec3d, axis: wp.vec3d, tip_rate: wp.vec3d, axis_rate: wp.vec3d,
    r: f64, z: f64, nr: f64, nz: f64, branch: f64,
) -> Grazing:  # fmt: skip
    """The point of the circle (r, z) with meridian normal (nr, nz) that grazes, on one branch."""
    out = Grazing()
    g = nr * tip_rate + (z * nr - r * nz) * axis_rate
    b = nz * wp.dot(axis, tip_rate)
    flat = g - wp.dot(axis, g) * axis
    size2 = wp.dot(flat, flat)
    travel2, spin2 = wp.dot(tip_rate, tip_rate), wp.dot(axis_rate, axis_rate)
    parts2 = nr * nr * travel2 + (z * z * nr * nr + r * r * nz * nz) * spin2
    moves = size2 > PARALLEL * PARALLEL * parts2 and travel2 + (r * r + z * z) * spin2 > AT_REST * AT_REST
    inside = size2 - b * b
    out.exists = 0
    if moves and inside >= f64(0.0):
        out.exists = 1
        u = (branch * wp.sqrt(inside) * wp.cross(axis, flat) - b * flat) / size2
        out.point = tip + z * axis + r * u
        out.normal = nr * u + nz * axis
    return out


@wp.kernel
def grazing_grid(
    # motion
    tip: wp.array(dtype=wp.vec3d),
    axis: wp.array(dtype=wp.vec3d),
    tip_rate: wp.array(dtype=wp.vec3d),
    axis_rate: wp.array(dtype=wp.vec3d),
    # cutter
    profile: wp.array2d(dtype=f64),
    # out
    exists_out: wp.array3d(dtype=wp.int32),
    point_out: wp.array3d(dtype=wp.vec3d),
    normal_out: wp.array3d(dtype=wp.vec3d),
):
    """Grazing points of every pose (i), profile point (j: r, z, nr, nz) and branch (k: +1, -1)."""
    i, j, k = wp.tid()
    branch = f64(1.0)
    if k == 1:
        branch = f64(-1.0)
    out = grazing_point(
        tip[i], axis[i], tip_rate[i], axis_rate[i],
        profile[j, 0], profile[j, 1], profile[j, 2], profile[j, 3], branch,
    )  # fmt: skip
    exists_out[i, j, k] = out.exists
    point_out[i, j, k] = out.point
    normal_out[i, j, k] = out.normal
