"""How far a ray that misses the cutter at rest passes it: needed only where hits may hide between poses."""

import warp as wp

from gearsim.kernels.profile import FAR, LINE, TINY, Cutter, ToolRay

f64 = wp.float64

GAP_STEPS = wp.constant(90)


@wp.func
def outside_distance(cutter: Cutter, r: f64, z: f64) -> wp.vec3d:
    """Distance of a point outside the cutter to it, with the unit gradient (nr, nz); about 0 inside."""
    best = FAR
    near_r = f64(0.0)
    near_z = f64(0.0)
    for k in range(cutter.first, cutter.end):
        z0 = cutter.slabs[k, 0]
        z1 = cutter.slabs[k, 1]
        r0 = cutter.slabs[k, 2]
        r1 = r0
        if cutter.slabs[k, 5] == LINE:
            slope = cutter.slabs[k, 3]
            r1 = r0 + slope * (z1 - z0)
            along = ((r - r0) * slope + (z - z0)) / (f64(1.0) + slope * slope)
            along = wp.clamp(along, f64(0.0), z1 - z0)
            pr = r0 + slope * along
            pz = z0 + along
        else:
            zc = cutter.slabs[k, 3]
            rho = cutter.slabs[k, 4]
            out = wp.max(r - r0, f64(0.0))
            length = wp.max(wp.sqrt(out * out + (z - zc) * (z - zc)), TINY)
            pz = wp.clamp(zc + rho * (z - zc) / length, z0, z1)
            pr = r0 + wp.sqrt(wp.max(rho * rho - (pz - zc) * (pz - zc), f64(0.0)))
            r1 = r0 + wp.sqrt(wp.max(rho * rho - (z1 - zc) * (z1 - zc), f64(0.0)))
            r0 = r0 + wp.sqrt(wp.max(rho * rho - (z0 - zc) * (z0 - zc), f64(0.0)))
        d = wp.sqrt((r - pr) * (r - pr) + (z - pz) * (z - pz))
        if d < best:
            best = d
            near_r = pr
            near_z = pz
        if k == cutter.first:
            pr = wp.min(r, r0)
            d = wp.sqrt((r - pr) * (r - pr) + (z - z0) * (z - z0))
            if d < best:
                best = d
                near_r = pr
                near_z = z0
        if k == cutter.end - 1:
            pr = wp.min(r, r1)
            d = wp.sqrt((r - pr) * (r - pr) + (z - z1) * (z - z1))
            if d < best:
                best = d
                near_r = pr
                near_z = z1
    scale = f64(1.0) / wp.max(best, TINY)
    return wp.vec3d(best, (r - near_r) * scale, (z - near_z) * scale)


@wp.func
def ray_distance(cutter: Cutter, ray: ToolRay, tau: f64) -> wp.vec2d:
    """Distance of the ray's point to the cutter, and its derivative along the ray."""
    w = ray.w0 + tau * ray.w1
    r = wp.length(w)
    d = outside_distance(cutter, r, ray.z0 + tau * ray.dz)
    rate = d[2] * ray.dz
    if r > TINY:
        rate += d[1] * wp.dot(w, ray.w1) / r
    return wp.vec2d(d[0], rate)


@wp.func
def closest_point(cutter: Cutter, ray: ToolRay) -> f64:
    """Tau at which a ray that misses the cutter comes closest to it; safeguarded secant on the derivative."""
    a = -cutter.size
    b = cutter.size
    fa = f64(-1.0)
    fb = f64(1.0)
    tau = f64(0.0)
    step = int(0)
    while step < GAP_STEPS:
        tau = f64(0.5) * (a + b)
        if step % 2 == 1 and fb > fa:
            tau = wp.clamp((a * fb - b * fa) / (fb - fa), a + f64(0.01) * (b - a), b - f64(0.01) * (b - a))
        f = ray_distance(cutter, ray, tau)[1]
        if wp.abs(f) < f64(1.0e-12) or b - a < f64(1.0e-13):
            break
        if f < f64(0.0):
            a = tau
            fa = f
        else:
            b = tau
            fb = f
        step += 1
    return tau
