"""Questions of a round are answered together; every one gets the answer that it would get alone."""

import numpy as np

from gearsim.envelope import machined_along
from gearsim.metrology.inspection import Cut, Solve, answer
from gearsim.metrology.samples import sample_grid
from gearsim.processes.run import plan
from gearsim.scene import load_scene
from gearsim.simulation.workshop import Workshop


def test_solved_together_as_alone():
    scene, folder = load_scene("spiral-bevel-flank")
    job = plan(scene, folder)
    own, theory = (job.variant(name, "convex") for name in ("own pass", "theory"))
    flank = scene.tooth().flank("convex")
    few, more = (sample_grid(flank, *shape).rays() for shape in ((2, 3), (3, 9)))
    questions = [Solve(few, own), Cut(few, own), Solve(more, theory), Solve(more, own)]
    found = answer(questions, Workshop("cpu"))
    assert [len(found[i].deviation) for i in (0, 2, 3)] == [6, 27, 27]
    for i in (0, 2, 3):
        q = questions[i]
        alone = machined_along(q.rays, q.variant.motions(), q.variant.cutter)
        for ours, his in zip(found[i].columns(), alone.columns(), strict=True):
            assert np.array_equal(ours, his, equal_nan=True)
    assert len(found[1].first) == 7
