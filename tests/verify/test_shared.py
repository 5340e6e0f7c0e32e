import numpy as np

from gearsim.motion.sources import CLMotion
from gearsim.verify.shared import SharedPoses


def test_the_poses_are_the_motions_and_each_is_asked_for_once(rng):
    axes = np.array([0.0, 0.0, 1.0]) + 0.3 * rng.normal(size=(4, 3))
    motion = CLMotion(rng.normal(size=(4, 3)), axes / np.linalg.norm(axes, axis=1, keepdims=True))
    asked = []

    class Watched:
        pieces = motion.pieces

        def pose(self, piece, t, order):
            asked.append(len(t))
            return motion.pose(piece, t, order)

    piece, t = rng.integers(0, 3, 5).repeat(4), np.append(rng.uniform(-0.1, 1.1, 4), 0.0).repeat(4)
    shuffled = rng.permutation(20)
    piece, t = piece[shuffled], t[shuffled]
    shared = SharedPoses(Watched())
    assert shared.pieces == 3
    for ours, theirs in zip(shared.pose(piece, t, 2), motion.pose(piece, t, 2), strict=True):
        assert np.array_equal(ours.c, theirs.c)
    assert asked == [5]
