"""Rows of a motion halved again and again, and where the tool of such a branch may meet a tile of parallel rays.

Over a branch the tip moves by s u + e and the axis by s g + f: s within [-1, 1], u the stroke, g the swing, e no
longer than ``rest`` and f than ``sway``. In the direction n the axis' point at height h gets no farther than at the
branch's pose and |n . (u + h g)| + rest + |h| sway, and circles about it as the axis may lean toward n; rays beside the
middle one by a and b ask for n . a and n . b more. So the plane at the middle ray's contact bounds how early each ray
of the tile is entered at any pose of the branch. From an end of a single row the same holds one way only: where the
tool comes nearer all the way, the bound is as close as the chord there.
"""

import warp as wp

from gearsim.kernels.cull import PAD
from gearsim.kernels.profile import LINE, Cutter, cutter_interval, face_normal
from gearsim.kernels.tool_ray import FAR, TINY, ToolRay, ball_interval, greater, lesser, line_interval, tool_ray

f64 = wp.float64

FLAT = wp.constant(f64(0.05))


@wp.struct
class Branches:
    """Branch i of level j holds the rows i 2^j to (i + 1) 2^j and stands at ``level[j] + i``.

    (``tip``, ``axis``) is a pose of it. Over it the tip stays within ``rest`` [mm] of tip + s stroke and the axis
    within ``sway`` of axis + s swing, for some s of [-1, 1], and within ``turn`` of axis. ``roots``: the branches that
    a search begins with, as (level, i).
    """

    level: wp.array(dtype=wp.int32)
    tip: wp.array(dtype=wp.vec3d)
    axis: wp.array(dtype=wp.vec3d)
    stroke: wp.array(dtype=wp.vec3d)
    swing: wp.array(dtype=wp.vec3d)
    rest: wp.array(dtype=f64)
    sway: wp.array(dtype=f64)
    turn: wp.array(dtype=f64)
    roots: wp.array(dtype=wp.vec2i)


@wp.struct
class Branch:
    """One of them: a pose of it, in the middle of the stroke (``way`` 0) or at an end of it (-1, 1), and its bounds."""

    tip: wp.vec3d
    axis: wp.vec3d
    stroke: wp.vec3d
    swing: wp.vec3d
    rest: f64
    sway: f64
    turn: f64
    way: f64


@wp.struct
class Tile:
    """Parallel rays: the middle one, and how far the others lie beside it at most: s a + t b, s and t in [-1, 1]."""

    origin: wp.vec3d
    direction: wp.vec3d
    a: wp.vec3d
    b: wp.vec3d


@wp.struct
class Reach:
    """The middle ray's chord [lo, hi] at the branch's pose, if ``found``, and the stretch [first, last] outside of
    which no ray of the tile meets the tool anywhere in the branch; none if first > last. The ray s a + t b beside the
    middle one does not before early . (1, s, t), nor after late . (1, s, t). At the end of the stroke the
    chord begins about ``lo_lead`` earlier and ends ``hi_lead`` later.
    """

    found: wp.int32
    lo: f64
    hi: f64
    first: f64
    last: f64
    early: wp.vec3d
    late: wp.vec3d
    lo_lead: f64
    hi_lead: f64


@wp.func
def branch_at(branches: Branches, node: int) -> Branch:
    """A branch as it stands in the table."""
    branch = Branch()
    branch.tip = branches.tip[node]
    branch.axis = branches.axis[node]
    branch.stroke = branches.stroke[node]
    branch.swing = branches.swing[node]
    branch.rest = branches.rest[node]
    branch.sway = branches.sway[node]
    branch.turn = branches.turn[node]
    return branch


@wp.func
def at_end(branch: Branch, tip: wp.vec3d, axis: wp.vec3d, way: f64) -> Branch:
    """A branch of one row seen from the pose at an end of it.

    With |x^k - 1| <= k |x - 1| the row's bends, of degrees 2 to 5, count 5 |x - 1| times their size at most.
    """
    branch.tip = tip
    branch.axis = axis
    branch.turn *= f64(2.0)
    branch.way = way
    return branch


@wp.struct
class Facing:
    """A direction n as a branch sees it: how far its pose's tip is that way, how far its axis leans that way, how far a
    circle of radius 1 about the axis gets at most and at least; how fast tip and axis go that way along the stroke.
    """

    tip: f64
    lean: f64
    wide: f64
    narrow: f64
    stroke: f64
    swing: f64


@wp.func
def facing_of(branch: Branch, origin: wp.vec3d, n: wp.vec3d) -> Facing:
    """See Facing; counted from a point. The less the axis leans the wider the circle is."""
    facing = Facing()
    facing.tip = wp.dot(n, branch.tip - origin)
    facing.lean = wp.dot(n, branch.axis)
    facing.stroke = wp.dot(n, branch.stroke)
    facing.swing = wp.dot(n, branch.swing)
    turn = (f64(1.0) + wp.abs(branch.way)) * (wp.abs(facing.swing) + branch.sway)
    least = greater(wp.abs(facing.lean) - turn, f64(0.0))
    most = wp.abs(facing.lean) + turn
    across = n - facing.lean * branch.axis
    whole = wp.dot(across, across) + facing.lean * facing.lean
    facing.wide = wp.sqrt(whole - least * least)
    facing.narrow = wp.sqrt(greater(whole - most * most, f64(0.0)))
    return facing


@wp.func
def circle_past(branch: Branch, facing: Facing, z: f64, r: f64) -> f64:
    """How far a circle about the tool's axis, or the one that a spindle's centre makes (r < 0), gets in the branch."""
    push = facing.stroke + z * facing.swing
    rest = branch.rest + wp.abs(z) * branch.sway
    ahead = wp.abs(push) + rest
    if branch.way != f64(0.0):
        ahead = greater(f64(2.0) * (f64(5.0) * rest - branch.way * push), f64(0.0))
    return facing.tip + z * facing.lean + r * wp.where(r < f64(0.0), facing.narrow, facing.wide) + ahead


@wp.func
def past(cutter: Cutter, branch: Branch, tile: Tile, n: wp.vec3d, base: f64) -> wp.vec2d:
    """How far the tool gets past the middle ray's origin in direction n anywhere in the branch, and how much farther
    its axis' point at height ``base`` is at the end of the stroke than at the pose [mm].
    """
    facing = facing_of(branch, tile.origin, n)
    far = -FAR
    for k in range(cutter.first, cutter.end):
        if cutter.slabs[k, 5] == LINE:
            z0 = cutter.slabs[k, 0]
            z1 = cutter.slabs[k, 1]
            r = cutter.slabs[k, 2]
            far = greater(far, circle_past(branch, facing, z0, r))
            far = greater(far, circle_past(branch, facing, z1, r + cutter.slabs[k, 3] * (z1 - z0)))
        else:
            circle = circle_past(branch, facing, cutter.slabs[k, 3], cutter.slabs[k, 2])
            far = greater(far, circle + cutter.slabs[k, 4])
    return wp.vec2d(far + f64(16.0) * cutter.skin, facing.stroke + base * facing.swing)


@wp.func
def earliest(
    cutter: Cutter, branch: Branch, tile: Tile, ray: ToolRay, tau: f64, face: int, way: f64
) -> wp.vec4d:  # fmt: skip
    """Before this the middle ray, run forward (``way`` 1) or backward (-1), is not in the tool; how much later those
    beside it by a and by b, and how much earlier it is at the end of the stroke. -FAR where that is lost.

    ``tau`` and ``face``: where the middle ray, seen from the tool as ``ray``, has an end of its chord.
    """
    z = ray.z0 + tau * ray.dz
    w = ray.w0 + tau * ray.w1
    r = wp.length(w)
    normal = face_normal(cutter, face, r, z)
    n = normal[1] * branch.axis
    if r > TINY:
        n = n + (normal[0] / r) * w
    n = wp.normalize(n)
    steep = -way * wp.dot(n, tile.direction)
    if not steep > FLAT:
        return wp.vec4d(-FAR, f64(0.0), f64(0.0), f64(0.0))
    base = z
    if face % 2 == 0 and cutter.slabs[face // 2, 5] != LINE:
        base = cutter.slabs[face // 2, 3]
    far = past(cutter, branch, tile, n, base)
    return wp.vec4d(-far[0], wp.dot(n, tile.a), wp.dot(n, tile.b), far[1]) / steep


@wp.func
def passes(cutter: Cutter, branch: Branch, tile: Tile, ray: ToolRay) -> bool:
    """Whether a plane along the rays, across the way from the axis to the middle one, keeps the tool from them all."""
    low = cutter.slabs[cutter.first, 0]
    if cutter.slabs[cutter.first, 5] != LINE:
        low = cutter.slabs[cutter.first, 3]
    base = ray.z0
    if ray.square > TINY:
        base -= ray.dz * ray.half / ray.square
    base = wp.clamp(base, low, cutter.slabs[cutter.end - 1, 1])
    n = tile.origin - branch.tip - base * branch.axis
    n = n - wp.dot(n, tile.direction) * tile.direction
    size = wp.length(n)
    if size < TINY:
        return False
    n = n / size
    beside = wp.abs(wp.dot(n, tile.a)) + wp.abs(wp.dot(n, tile.b))
    return past(cutter, branch, tile, n, base)[0] + beside < f64(0.0)


@wp.func
def around(cutter: Cutter, ray: ToolRay, move: f64, turn: f64, window: wp.vec2d) -> wp.vec2d:
    """The part of a window where a ray is within ``move`` [mm] of the cutter turned by ``turn``, if first <= last."""
    per_dz = FAR
    if wp.abs(ray.dz) > TINY:
        per_dz = f64(1.0) / ray.dz
    first = FAR
    last = -FAR
    for k in range(cutter.first, cutter.end):
        z0 = cutter.slabs[k, 0]
        z1 = cutter.slabs[k, 1]
        width = cutter.slabs[k, 2]
        if cutter.slabs[k, 5] == LINE:
            width = greater(width, width + cutter.slabs[k, 3] * (z1 - z0))
        else:
            width += cutter.slabs[k, 4]
        grown = move + turn * (greater(wp.abs(z0), wp.abs(z1)) + width)
        below = (z0 - grown - ray.z0) * per_dz
        above = (z1 + grown - ray.z0) * per_dz
        lo = greater(lesser(below, above), window[0] - ray.shift)
        hi = lesser(greater(below, above), window[1] - ray.shift)
        if lo <= hi:
            part = wp.vec2d(f64(1.0), f64(0.0))
            if cutter.slabs[k, 5] == LINE:
                part = line_interval(
                    ray, cutter.slabs[k, 2] + grown * cutter.slabs[k, 4], cutter.slabs[k, 3], z0, lo, hi
                )
            elif cutter.slabs[k, 2] < f64(0.0):
                part = line_interval(ray, width + grown, f64(0.0), f64(0.0), lo, hi)
            else:
                part = ball_interval(ray, cutter.slabs[k, 3], width + grown, lo, hi)
            if part[0] <= part[1]:
                first = lesser(first, part[0])
                last = greater(last, part[1])
    return wp.vec2d(first + ray.shift, last + ray.shift)


@wp.func
def reach_of(cutter: Cutter, branch: Branch, tile: Tile, window: wp.vec2d) -> Reach:
    """See Reach; within a window along the rays."""
    ray = tool_ray(branch.tip, branch.axis, cutter.middle, tile.origin, tile.direction)
    hit = cutter_interval(cutter, ray)
    reach = Reach()
    reach.found = hit.found
    reach.first = window[0]
    reach.last = window[1]
    reach.early[0] = -FAR
    reach.late[0] = FAR
    if hit.found == 0 and passes(cutter, branch, tile, ray):
        reach.first = FAR
        reach.last = -FAR
        return reach
    lost = 1 - hit.found
    if hit.found == 1:
        reach.lo = hit.lo + ray.shift
        reach.hi = hit.hi + ray.shift
        if reach.lo > window[0]:
            end = earliest(cutter, branch, tile, ray, hit.lo, hit.lo_face, f64(1.0))
            lost = wp.where(end[0] == -FAR, 1, lost)
            reach.early = wp.vec3d(end[0], end[1], end[2])
            reach.lo_lead = end[3]
        if reach.hi < window[1]:
            end = earliest(cutter, branch, tile, ray, hit.hi, hit.hi_face, f64(-1.0))
            lost = wp.where(end[0] == -FAR, 1, lost)
            reach.late = -wp.vec3d(end[0], end[1], end[2])
            reach.hi_lead = end[3]
    if lost == 1:
        move = (f64(1.0) + wp.abs(branch.way)) * (wp.length(branch.stroke) + branch.rest)
        move += wp.length(tile.a) + wp.length(tile.b) + PAD * cutter.size + f64(1.0e3) * cutter.skin
        reach.lo_lead = wp.dot(ray.w0, branch.stroke)
        near = around(cutter, ray, move, branch.turn, window)
        reach.first = greater(reach.first, near[0])
        reach.last = lesser(reach.last, near[1])
    reach.first = greater(reach.first, reach.early[0] - wp.abs(reach.early[1]) - wp.abs(reach.early[2]))
    reach.last = lesser(reach.last, reach.late[0] + wp.abs(reach.late[1]) + wp.abs(reach.late[2]))
    return reach
