"""Rapids between flank passes stay clear of the blank: the removal road with the rapids alone, over the whole blank."""

from dataclasses import replace

import numpy as np
import pytest

from gearsim.cutters.catalogue import ball, conical, flat
from gearsim.geometry.turned import Turned
from gearsim.metrology.chords import blank_rays
from gearsim.metrology.inspection import perform
from gearsim.metrology.rapid_check import rapid_touch
from gearsim.motion.sources import CLMotion
from gearsim.processes.run import plan
from gearsim.programs.cldata import RAPID, CLPath, assemble, parse_cl
from gearsim.scene import load_scene
from gearsim.simulation.operation import Variant, operation
from gearsim.simulation.workshop import Workshop
from gearsim.toolpaths.clearance import CLEAR_MM, Clearance
from gearsim.toolpaths.links import APPROACH, WITHDRAWAL, clear_rapids

PINION = (
    "surface.teeth=9", "surface.mate_teeth=33", "surface.hand='right'", "surface.addendum_mm=6.7968",
    "surface.dedendum_mm=2.6332", "surface.face_angle_deg=20.4167", "surface.root_angle_deg=13.8833",
    "surface.rim_mm=3", "toolpath.points=9",
)  # fmt: skip
SHORT = ("toolpath.run_mm=0", "toolpath.retract_mm=1")


def cut_by_rapids(program, cutter, stock, device):
    """Longest chord [mm] that the rapids of a program alone cut out of an uncut blank."""
    rapids = [p for p in program.paths if p.name == RAPID]
    moves = operation("rapids", cutter, [CLMotion(p.tips, p.axes) for p in rapids], 1e-9)
    rays = blank_rays(stock)
    ray, start, end = stock.chords(rays.origin, rays.direction)
    removed = Workshop(device, slots=64).cut([(rays, [moves])])[0]
    longest = 0.0
    for lo, hi, k in zip(removed.lo, removed.hi, removed.ray, strict=True):
        mine = ray == k
        longest = max(longest, float((np.minimum(hi, end[mine]) - np.maximum(lo, start[mine])).max(initial=0.0)))
    return longest


@pytest.mark.parametrize(
    ("scene", "overrides"),
    [
        ("spiral-bevel-flank", PINION),
        ("spiral-bevel-flank", (*PINION, *SHORT)),
        ("spiral-bevel-flank", SHORT),
        ("spiral-bevel-flank-conventional", ("toolpath.retract_mm=0.5",)),
    ],
)
def test_planned_rapids_touch_nothing_of_the_blank(scene, overrides, device):
    """The pinion's straight way from pass to pass led through it; passes that end on the blank are left by feed."""
    job = plan(*load_scene(scene, overrides))
    program, stock, cutter = parse_cl(job.files["toolpath.cl"]), job.part.stock, job.variant("program").cutter
    assert cut_by_rapids(program, cutter, stock, device) == 0.0
    clearance = Clearance(stock, cutter)
    assert all(clearance.along(p.tips, p.axes) > CLEAR_MM - 1e-6 for p in program.paths if p.name == RAPID)
    assert {"convex", "concave"} <= {p.name for p in program.paths}
    for before, after in zip(program.paths[:-1], program.paths[1:], strict=True):
        assert np.allclose(before.tips[-1], after.tips[0])
        assert np.allclose(before.axes[-1], after.axes[0])


def test_a_pass_that_ends_on_the_blank_is_reached_and_left_by_feed():
    job = plan(*load_scene("spiral-bevel-flank", (*SHORT, "toolpath.points=9")))
    names = [p.name for p in parse_cl(job.files["toolpath.cl"]).paths]
    assert names == ["rapid", APPROACH, "convex", WITHDRAWAL, "rapid", APPROACH, "concave", WITHDRAWAL, "rapid"]


def test_rapids_that_are_clear_stay_as_they_are():
    job = plan(*load_scene("spiral-bevel-flank", ("toolpath.points=9",)))
    names = [p.name for p in parse_cl(job.files["toolpath.cl"]).paths]
    assert names == ["rapid", "convex", "rapid", "concave", "rapid"]


DISC = Turned(np.array([[10.0, 0.0], [40.0, 0.0], [40.0, -8.0], [10.0, -8.0]]))


def unit(v):
    return np.asarray(v, dtype=float) / np.linalg.norm(v)


@pytest.mark.parametrize(
    "cutter", [flat(6.0, 30.0), ball(8.0, 30.0), conical(1.0, 0.5, 0.2, 40.0)], ids=lambda c: c.name
)
def test_passes_on_opposite_sides_of_a_disc_are_joined_around_it(cutter, device, rng):
    """Above, below, beside and in the bore; opposite axes, too."""
    places = [
        ([25.0, 0.0, 0.0], [0.0, 0.0, 1.0]), ([25.0, 0.0, -8.0], [0.0, 0.0, -1.0]),
        ([40.0, 0.0, -4.0], [1.0, 0.0, 0.0]), ([-40.0, 0.0, -4.0], [-1.0, 0.0, 0.0]),
        ([0.0, 0.0, -20.0], [0.0, 0.0, 1.0]),
        *((40.0 * unit([*v[:2], 0.0]), unit(v)) for v in rng.normal(size=(3, 3))),
    ]  # fmt: skip
    passes = []
    for i, (tip, axis) in enumerate(places):
        tip, axis = np.array(tip), unit(axis)
        side = unit(np.cross(axis, [0.3, 0.5, 0.8]))
        passes.append(CLPath(f"p{i}", np.array([tip, tip + 2.0 * side]), np.array([axis, axis])))
    program = clear_rapids(assemble(passes, 3.0, cutter), cutter, DISC, 3.0)
    assert cut_by_rapids(program, cutter, DISC, device) == 0.0
    assert [p.name for p in program.paths if p.name.startswith("p")] == [p.name for p in passes]
    for before, after in zip(program.paths[:-1], program.paths[1:], strict=True):
        assert np.allclose(before.tips[-1], after.tips[0])


def test_the_clearance_is_a_lower_bound_near_the_truth(rng):
    """Against the least distance of points of the tool's skin from the blank, at random poses and on the way."""
    cutter = conical(1.0, 0.5, 0.2, 20.0)
    clearance = Clearance(DISC, cutter)
    angle = np.linspace(0.0, 2.0 * np.pi, 49)
    meridian = [e.at(np.linspace(0.0, e.length, 40)) for e in cutter.elements]
    r, z = (np.concatenate([getattr(p, k) for p in meridian]) for k in ("r", "z"))
    for _ in range(20):
        axis = unit(rng.normal(size=3))
        tip = unit(rng.normal(size=3)) * 60.0
        x = unit(np.cross(axis, rng.normal(size=3)))
        y = np.cross(axis, x)
        ring = np.cos(angle)[:, None] * x + np.sin(angle)[:, None] * y
        skin = tip + z[:, None, None] * axis + r[:, None, None] * ring
        true = DISC.signed_distance(skin).min()
        bound = float(clearance.at(tip[None], axis[None])[0])
        assert bound <= true + 1e-9
        assert bound > true - cutter.max_radius - 1.0
        up = np.stack([tip, tip + 5.0 * axis])
        assert clearance.along(up, np.stack([axis, axis])) <= true + 1e-9


def test_the_clearance_of_a_tool_of_metres_is_a_bound_by_fewer_discs():
    """Beside a disc of 50 mm radius, the tool's side 10 mm off; longer discs make the bound looser, never too much."""
    stock = Turned(np.array([[0.0, -5.0], [50.0, -5.0], [50.0, 5.0], [0.0, 5.0]]))
    tips, axes = np.array([[70.0, 0.0, -10_000.0]]), np.array([[0.0, 0.0, 1.0]])
    (found,) = Clearance(stock, flat(20.0, 20_000.0)).at(tips, axes)
    assert 9.0 < found <= 10.0


def test_the_distance_from_a_turned_solid_is_that_of_its_outline():
    points = np.array([[50.0, 0, -4], [0, 0, -4], [25, 0, 3], [25, 0, -2], [0, 43, 4], [40, 0, 0], [10, 0, -4]])
    assert np.allclose(DISC.signed_distance(points), [10.0, 10.0, 3.0, -2.0, 5.0, 0.0, 0.0])


def touched(moves, device):
    """The first rapid of an operation, whose motions are its steps, that touches the disc."""
    rapid = np.array([moves.rapid[moves.step == k].all() for k in range(len(moves.sources))])
    return perform(rapid_touch(DISC, blank_rays(DISC), Variant("program", "", (moves,)), rapid), Workshop(device))


@pytest.mark.parametrize(("opened", "touches"), [(False, True), (True, False)])
def test_a_rapid_where_feeds_have_cut_before_touches_nothing(opened, touches, device):
    """Down by rapid into a hole: touching before it is drilled, not after; the order counts."""
    cutter = flat(6.0, 30.0)
    down = np.array([[25.0, 0.0, 5.0], [25.0, 0.0, -5.0]])
    up, axis = down[::-1], np.tile([0.0, 0.0, 1.0], (2, 1))
    order = [(False, down), (True, up), (True, down)] if opened else [(True, down), (False, up), (False, down)]
    rapid = [is_rapid for is_rapid, _ in order]
    found = touched(operation("drill", cutter, [CLMotion(tips, axis) for _, tips in order], 1e-9, rapid=rapid), device)
    assert (found is not None) == touches
    if found:
        assert found.step == 0
        assert found.rays > 10
        assert np.hypot(*(found.place[:2] - [25.0, 0.0])) < 3.0 + 1e-9


def test_a_rapid_that_just_touches_a_face_cuts_nothing(device):
    """Sliding over the top face at its very height, and a micrometre lower."""
    cutter, axis = flat(6.0, 30.0), np.tile([0.0, 0.0, 1.0], (2, 1))
    for z, touches in ((0.0, False), (-1e-3, True)):
        over = CLMotion(np.array([[-50.0, 0.0, z], [50.0, 0.0, z]]), axis)
        found = touched(operation("over", cutter, [over], 1e-9, rapid=[True]), device)
        assert (found is not None) == touches


@pytest.mark.parametrize(
    "cutter", [flat(6.0, 20.0), ball(8.0, 40.0), conical(1.0, 0.8, 0.26, 25.0)], ids=lambda c: c.name
)
def test_bounds_of_a_way_are_below_the_distance_of_any_point_of_the_tool(cutter):
    """Rough looks as well as fine ones; where both say that a way is clear, and where the blank is touched."""
    rng = np.random.default_rng(11)
    z, angle = np.linspace(cutter.box[2], cutter.height, 40), np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
    said = set()
    for _ in range(20):
        axes = np.array([0.0, 0.0, 1.0]) + 0.4 * rng.normal(size=(2, 3))
        axes /= np.linalg.norm(axes, axis=1)[:, None]
        tips = np.array([0.0, 0.0, 2.0]) + [60.0, 60.0, 8.0] * rng.uniform(-1.0, 1.0, size=(2, 3))
        clearance = Clearance(DISC, cutter)
        tip, axis = (s.value for s in CLMotion(tips, axes).pose(np.zeros(60, int), np.linspace(0.0, 1.0, 60), 0))
        side = np.cross(axis, [1.0, 0.0, 0.0])
        side /= np.linalg.norm(side, axis=1)[:, None]
        other = np.cross(axis, side)
        round_it = np.cos(angle)[:, None] * side[:, None] + np.sin(angle)[:, None] * other[:, None]
        on_axis = tip[:, None] + z[:, None] * axis[:, None]
        skin = on_axis[:, :, None] + cutter.radii_at(z)[:, None, None] * round_it[:, None]
        least = float(DISC.signed_distance(skin).min())
        assert clearance.along(tips, axes) <= least
        assert replace(clearance, rough=8.0).along(tips, axes) <= least
        assert not clearance.clears(tips, axes) or least >= CLEAR_MM
        said.add(clearance.clears(tips, axes))
    assert said == {True, False}
