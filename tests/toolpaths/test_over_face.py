"""Passes over faces: the ball touches and nowhere goes deeper than asked; axes by their rules; what cannot be."""

from itertools import pairwise

import numpy as np
import pytest

from gearsim.cutters.catalogue import ball, flat, tapered_ball
from gearsim.errors import InputError
from gearsim.geometry.solid import Block
from gearsim.surfaces.faced_solid import FacedSolid
from gearsim.surfaces.foot_within import foot_within
from gearsim.surfaces.nurbs_file import load_surfaces
from gearsim.toolpaths.layers import layers
from gearsim.toolpaths.over_face import between_axis, fixed_axis, leaning_axis, over_face
from tests.surfaces.faced_parts import block_faces

UP = np.array([0.0, 0.0, 1.0])
MILL = tapered_ball(4.0, np.radians(3.0), 30.0)
BLADE = {face.name: face for face in load_surfaces("blade-tip")}
CHANNEL = {face.name: face for face in load_surfaces("impeller-channel")}
WALLS = (CHANNEL["left wall"], CHANNEL["right wall"])


def centres(motions):
    """The ball's centres all along, and the axes there."""
    found = []
    for motion in motions:
        piece = np.repeat(np.arange(motion.pieces), 9)
        tip, axis = (s.value for s in motion.pose(piece, np.tile(np.linspace(0.0, 1.0, 9), motion.pieces), 0))
        found.append((tip + 2.0 * axis, axis))
    return tuple(np.concatenate(column) for column in zip(*found, strict=True))


@pytest.mark.parametrize(
    ("face", "axis", "along", "allowance"),
    [
        (BLADE["leading edge"], leaning_axis(UP, 0.35), "v", 0.0),
        (BLADE["leading edge fillet"], leaning_axis(UP, 0.35, BLADE["leading edge"]), "v", 0.3),
        (CHANNEL["left fillet"], between_axis(WALLS, UP), "u", 0.0),
    ],
    ids=["leaning", "as over another face", "between walls"],
)
def test_the_ball_touches_all_along(face, axis, along, allowance):
    motions = over_face(face, MILL, axis, 2.0, along=along, allowance=allowance, tolerance=1e-3)
    centre, _ = centres(motions)
    at = np.array([foot_within(face, centre, *(np.full(len(centre), x) for x in face.locate(a, b)))[2]
                   for a in (0.1, 0.35, 0.65, 0.9) for b in (0.1, 0.5, 0.9)])  # fmt: skip
    assert np.abs(at.min(axis=0) - 2.0 - allowance).max() < 1.0e-3
    for a, b in pairwise(motions):
        assert np.array_equal(a.tips[-1], b.tips[0])
    ends = face.at(*face.locate(np.array([0.0, 0.0, 1.0, 1.0]), np.array([0.0, 1.0, 0.0, 1.0])))
    reached = np.linalg.norm(centre[:, None] - ends, axis=2).min(axis=0)
    assert (reached < 2.0 + allowance + 1e-3).sum() >= 2


def test_axes_between_walls_stand_off_both():
    _, axes = centres(over_face(CHANNEL["hub"], MILL, between_axis(WALLS, UP), 2.0))
    assert (axes @ UP > 0.9).all()
    assert axes[:, 0].max() > 0.2
    assert axes[:, 0].min() < -0.2


def test_what_cannot_be_is_told():
    with pytest.raises(InputError, match="no ball at its tip"):
        over_face(BLADE["suction side"], flat(4.0, 20.0), fixed_axis(UP), 1.0)
    with pytest.raises(InputError, match=r"the ball of tapered ball end mill ends at 87.0 deg; lean the axis"):
        over_face(BLADE["pressure side"], MILL, fixed_axis(UP), 1.0)
    with pytest.raises(InputError, match="no side to lean to"):
        over_face(BLADE["tip"], MILL, leaning_axis(UP, 0.3), 1.0)
    with pytest.raises(InputError, match="stepover"):
        over_face(BLADE["tip"], MILL, fixed_axis(UP), 0.0)


@pytest.mark.parametrize(
    ("cutter", "direction", "over_edges"),
    [(flat(1.0, 9.0), UP, 0.0), (ball(1.0, 9.0), np.array([1.0, 0.0, 0.0]), 0.5)],
)
def test_layers_keep_the_allowance_and_reach_the_floor(cutter, direction, over_edges):
    """A block of 4 x 2 x 3 mm in a larger one: nothing within the allowance of it; layers end that much over its top,
    or where a ball is lowest that still leans over an edge."""
    part = FacedSolid(block_faces())
    blank = Block(np.array([-2.0, -1.0, 2.0]), np.array([3.5, 3.0, 5.5]))
    moves = layers(part, blank, cutter, direction, 1.0, 0.6, 0.2, 1.0)
    tips = np.concatenate([m.tips[None, 0] + np.linspace(0, 1, 11)[:, None] * (b - m.tips[0])
                           for m in moves if not m.rapid for b in m.tips[1:2]])  # fmt: skip
    tips = np.concatenate([tips, *(m.tips for m in moves)])
    nodes = part.nodes.reshape(-1, 3)[::83]
    off = nodes[:, None] - tips
    z = off @ direction
    r = np.sqrt(np.maximum((off**2).sum(axis=2) - z**2, 0.0))
    assert cutter.signed_distance(r, z).min() > 0.19
    top = (part.box[1] @ direction) + 0.2
    lowest = min((m.tips @ direction).min() for m in moves)
    assert top - over_edges - 1e-9 <= lowest <= top - 0.9 * over_edges + 1e-9
    highest = float(blank.box[1] @ direction) + 1.0
    for before, after in pairwise(moves):
        assert np.allclose(before.tips[-1], after.tips[0])
        if after.rapid and np.ptp(after.tips @ direction) == 0.0:
            assert np.allclose(after.tips @ direction, highest)


def test_layers_with_nothing_to_take_are_refused():
    part = FacedSolid(block_faces())
    with pytest.raises(InputError, match="nothing is to be taken away"):
        layers(part, Block(*part.box), flat(9.0, 9.0), UP, 1.0, 0.4, 0.2, 1.0)
