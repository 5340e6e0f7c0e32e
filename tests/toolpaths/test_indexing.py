"""Passes in further spaces: the same ones, turned about the gear's axis by whole pitches."""

import numpy as np

from gearsim.programs.cldata import CLPath
from gearsim.toolpaths.indexing import indexed


def test_further_spaces_are_cut_by_the_same_passes_turned(rng):
    passes = [
        CLPath(name, rng.normal(size=(3, 3)), np.tile([0.0, 0.6, 0.8], (3, 1)), feed=300.0) for name in ("a", "convex")
    ]
    found = indexed(passes, 5, 3)
    assert [p.name for p in found] == ["a", "convex", "a.2", "convex.2", "a.3", "convex.3"]
    assert found[:2] == passes
    assert {p.feed for p in found} == {300.0}
    for k, path in enumerate(found):
        turn = np.exp(2j * np.pi * (k // 2) / 5)
        for before, after in ((passes[k % 2].tips, path.tips), (passes[k % 2].axes, path.axes)):
            assert np.allclose((before[:, 0] + 1j * before[:, 1]) * turn, after[:, 0] + 1j * after[:, 1])
            assert np.allclose(before[:, 2], after[:, 2])


def test_one_space_alone_stays_as_it_is():
    passes = [CLPath("a", np.zeros((2, 3)), np.tile([0.0, 0.0, 1.0], (2, 1)))]
    assert indexed(passes, 5, 1) == passes
