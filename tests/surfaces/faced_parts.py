"""The solids of NURBS faces that scenes mill, as they are made: a blade's tip, and a channel between two blades.

``python -m tests.surfaces.faced_parts`` writes the files that are shipped: control nets, and the channel as STEP.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.interpolate import make_interp_spline

from gearsim.surfaces.nurbs import NurbsSurface
from gearsim.surfaces.nurbs_file import load_surfaces, write_surfaces

SHIPPED = Path(__file__).parents[2] / "scenes" / "surfaces"
_EVEN = 13


def through(name, grid, inside):
    """The surface through a grid of points on even parameters, its normal away from the point ``inside``."""
    grid, knots, degrees = np.asarray(grid, dtype=float), [], []
    for axis in (0, 1):
        count = grid.shape[axis]
        degree = 1 if count == 2 else 3
        fitted = make_interp_spline(np.linspace(0.0, 1.0, count), grid, degree, axis=axis)
        grid = np.moveaxis(fitted.c, 0, axis) if axis else fitted.c
        knots.append(fitted.t)
        degrees.append(degree)
    surface = NurbsSurface(*degrees, *knots, np.round(grid, 9), name=name)
    jet = surface.jet(np.array([0.5]), np.array([0.5]))
    flip = bool((jet.r[0] - inside) @ jet.normal[0] < 0.0)
    return NurbsSurface(*degrees, *knots, surface.points, flip=flip, name=name)


def between(one, other, count=2):
    """A grid from one row of points to another, straight."""
    share = np.linspace(0.0, 1.0, count)[None, :, None]
    return np.asarray(one)[:, None] * (1.0 - share) + np.asarray(other)[:, None] * share


def coons(low, high, first, last):
    """A grid within four rows of points: ``low`` and ``high`` along u, ``first`` and ``last`` along v."""
    u, v = np.linspace(0.0, 1.0, len(low))[:, None, None], np.linspace(0.0, 1.0, len(first))[None, :, None]
    straight = (1 - u) * first + u * last
    corners = (1 - u) * ((1 - v) * low[0] + v * high[0]) + u * ((1 - v) * low[-1] + v * high[-1])
    return (1 - v) * low[:, None] + v * high[:, None] + straight - corners


LOWER, UPPER = np.array([-1.0, 0.0, 2.0]), np.array([3.0, 2.0, 5.0])


def block_faces():
    """The six sides of a block from LOWER to UPPER."""
    corner = np.array([[[[x, y, z] for z in (2.0, 5.0)] for y in (0.0, 2.0)] for x in (-1.0, 3.0)])
    middle = 0.5 * (LOWER + UPPER)
    return tuple(through(f"side {a}{b}", np.take(corner, b, axis=a), middle) for a in range(3) for b in range(2))


_CAMBER = 1.2
SPAN, FILLET, HALF = 20.0, 3.0, np.array([17.0, 9.0])
QUARTERS = {
    "leading edge": (-25, 25),
    "suction side": (25, 155),
    "trailing edge": (155, 205),
    "pressure side": (205, 335),
}


def placed(x, y, z):
    """Points of the blade's section at heights z [mm], the unit circle its border: a cambered ellipse, smaller and
    turned with height."""
    h = np.clip(z / SPAN, 0.0, 1.0)
    x, y = (11.0 - 1.5 * h) * x, (1.5 - 0.5 * h) * y + _CAMBER * (1.0 - x**2)
    turn = np.radians(12.0) * (h - 0.5)
    return np.stack([x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn), z + 0.0 * x], axis=-1)


def section(theta, z, out=0.0):
    """Points of the section's border at heights z [mm], ``out`` [mm] off it."""
    points, step = placed(np.cos(theta), np.sin(theta), z), 1e-6
    along = placed(np.cos(theta + step), np.sin(theta + step), z) - placed(
        np.cos(theta - step), np.sin(theta - step), z
    )
    along = along / np.linalg.norm(along, axis=-1, keepdims=True)
    normal = np.stack([along[..., 1], -along[..., 0], np.zeros(along.shape[:-1])], axis=-1)
    return points + np.broadcast_to(out, along.shape[:-1])[..., None] * normal


def on_tip(grid):
    """Points of the tip from those of the unit disc."""
    return placed(grid[..., 0], grid[..., 1], SPAN)


def blade_tip():
    """A compressor blade's last 20 mm on a block, its fillet of 3 mm around: 22 x 3 mm below, 19 x 2 mm at the tip."""
    inner = np.array([0.0, 0.0, -4.0])
    corners = {"leading edge": (1, -1, 1, 1), "suction side": (1, 1, -1, 1), "trailing edge": (-1, 1, -1, -1),
               "pressure side": (-1, -1, 1, -1)}  # fmt: skip
    walls, fillets, platforms, sides, rim = [], [], [], [], {}
    for name, (first, last) in QUARTERS.items():
        theta = np.radians(np.linspace(first, last, _EVEN))[:, None]
        inside = section(theta[6], np.array([10.0])).mean(axis=0) * (0.5, 0.5, 1.0)
        if "edge" in name:
            inside = inside * (1.9, 1.0, 1.0)
        walls.append(through(name, section(theta, np.linspace(FILLET, SPAN, 9)[None]), inside))
        phi = np.linspace(0.5 * np.pi, 0.0, 9)[None]
        curve = section(theta, FILLET * (1.0 - np.sin(phi)), FILLET * (1.0 - np.cos(phi)))
        fillets.append(through(f"{name} fillet", curve, np.array([0.0, 0.0, -9.0])))
        x0, y0, x1, y1 = corners[name]
        border = between([np.array([*HALF * (x0, y0), 0.0])], [np.array([*HALF * (x1, y1), 0.0])], _EVEN)[0]
        platforms.append(through(f"{name} platform", between(border, curve[:, 0]), inner))
        low = border[[0, -1]] - (0.0, 0.0, 8.0)
        sides.append(through(f"{name} block", between(low, border[[0, -1]]), inner))
        rim[name] = np.concatenate([np.cos(theta), np.sin(theta)], axis=1)
    core = {name: 0.5 * between(border[:1], border[-1:], _EVEN)[0] for name, border in rim.items()}
    le, suction, te, pressure = core.values()
    tip = [through("tip", on_tip(coons(pressure[::-1], suction, le, te[::-1])), inner)]
    tip += [through(f"tip at the {name}", on_tip(between(rim[name], core[name], 5)), inner) for name in rim]
    x, y = HALF
    floor = through("block bottom", [[[-x, -y, -8], [-x, y, -8]], [[x, -y, -8], [x, y, -8]]], inner)
    return [*walls, *fillets, *platforms, *tip, *sides, floor]


LENGTH, TOP, WIDE, LOW = 40.0, 26.0, 20.0, 9.0


def channel_section(s):
    """Polygons and arc of the channel at share s of its length, in the plane across it: five pieces, left to right."""
    lean, open_by, half, radius = np.radians(16.0) * np.cos(np.pi * s), np.radians(7.0), 3.2, 2.6
    middle = np.array([2.5 * np.sin(np.pi * s), LENGTH * s, 12.0 - 5.0 * s + 1.5 * s**2])
    across = np.array([np.cos(lean), 0.0, -np.sin(lean)])
    up = np.array([np.sin(lean), 0.0, np.cos(lean)])
    turn = np.linspace(0.0, 0.5 * np.pi - open_by, 9)[:, None]
    pieces = {}
    for sign in (-1.0, 1.0):
        arc = middle + sign * (half + radius * np.sin(turn)) * across + radius * (1.0 - np.cos(turn)) * up
        way = sign * np.sin(open_by) * across + np.cos(open_by) * up
        top = arc[-1] + (TOP - arc[-1][2]) / way[2] * way
        pieces[sign] = arc, np.array([arc[-1], top])
    (left, left_wall), (right, right_wall) = pieces[-1.0], pieces[1.0]
    return [left_wall[::-1], left[::-1], np.array([left[0], right[0]]), right, right_wall]


def impeller_channel():
    """Two twisted blades and the hub between them, in a block of 40 x 40 x 26 mm: walls ruled, a fillet of 2.6 mm."""
    names = ["left wall", "left fillet", "hub", "right fillet", "right wall"]
    rows = [channel_section(s) for s in np.linspace(0.0, 1.0, _EVEN)]
    middle = rows[6][2].mean(axis=0) + np.array([0.0, 0.0, 9.0])
    found = []
    for k, name in enumerate(names):
        grid = np.array([row[k] for row in rows])
        at = through(name, grid, middle)  # away from the middle of the channel: into the material
        found.append(
            NurbsSurface(at.degree_u, at.degree_v, at.knots_u, at.knots_v, at.points, flip=not at.flip, name=name)
        )
    corners = np.array([[-WIDE, TOP], [-WIDE, LOW], [-WIDE, 0.0], [WIDE, 0.0], [WIDE, LOW], [WIDE, TOP]])
    centre = np.array([0.0, 0.5 * LENGTH, 4.0])
    ends = [np.insert(corners, 1, y, axis=1) for y in (0.0, LENGTH)]
    for k, name in enumerate(["left side", "left side below", "bottom", "right side below", "right side"]):
        found.append(through(name, [end[k : k + 2] for end in ends], centre))
    for name, k, corner in (("left top", 0, 0), ("right top", -1, 5)):
        inner = np.array([row[k][k] for row in rows])
        outer = between(ends[0][corner][None], ends[1][corner][None], _EVEN)[0]
        found.append(through(name, between(outer, inner), centre))
    for end, row, what in ((ends[0], rows[0], "inlet"), (ends[1], rows[-1], "outlet")):
        for k, name in enumerate(names):
            outer = between(end[k][None], end[k + 1][None], len(row[k]))[0]
            found.append(through(f"{what} {name}", between(outer, row[k]), centre))
    return found


def write_solid(surfaces, file):
    """Sew surfaces into one solid, by Open CASCADE, and write it as STEP."""
    from OCP.BRep import BRep_Builder
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Sewing
    from OCP.BRepLib import BRepLib
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS, TopoDS_Solid

    from gearsim.output.step import _face
    from tests.gouging.cad_parts import write_step

    sewing = BRepBuilderAPI_Sewing(1e-6)
    for surface in surfaces:
        sewing.Add(_face(surface))
    sewing.Perform()
    shell = TopoDS.Shell(TopExp_Explorer(sewing.SewedShape(), TopAbs_ShapeEnum.TopAbs_SHELL).Current())
    solid = TopoDS_Solid()
    BRep_Builder().MakeSolid(solid)
    BRep_Builder().Add(solid, shell)
    BRepLib.OrientClosedSolid_s(solid)
    write_step(solid, file)


def named_as_read(surfaces, read):
    """Faces as a STEP file has them, in its order, called as the surfaces of the same points were."""
    found = []
    for face in read:
        same = (
            s.name for s in surfaces if s.points.shape == face.points.shape and abs(s.points - face.points).max() < 1e-9
        )
        found.append(replace(face, name=next(same)))
    return found


if __name__ == "__main__":
    write_surfaces(blade_tip(), SHIPPED / "blade-tip.json", "A compressor blade's tip: tests/surfaces/faced_parts.py")
    step = SHIPPED / "impeller-channel.step"
    write_solid(impeller_channel(), step)
    faces = named_as_read(impeller_channel(), load_surfaces(step))
    note = "An impeller's channel: the faces of impeller-channel.step, in its order"
    write_surfaces(faces, SHIPPED / "impeller-channel.json", note)
