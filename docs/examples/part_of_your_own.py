"""A surface, a tool and a path of your own, put together from the nouns alone; nothing comes from a scene."""

import numpy as np

from gearsim.cutters.catalogue import ball
from gearsim.metrology.grid import DENSE, GridInspection
from gearsim.metrology.job import Job
from gearsim.motion.sources import CLMotion
from gearsim.processes.run import run_job
from gearsim.simulation.operation import Variant, operation
from gearsim.surfaces.nurbs_file import load_surfaces
from gearsim.surfaces.part import Intended, Part, Tolerance

# The part: a shipped quarter of a cylinder, 50 mm radius, that may be cut 1 um too deep and keep 30 um of scallops.
cylinder = load_surfaces("khan-9-1-cylinder")[0]
part = Part("part frame of the control net", None, {cylinder.name: Intended(cylinder, Tolerance(1.0, 30.0))})

# The operation: a 20 mm ball along 41 straight lines, its centre a radius off the surface, its axis +z.
mill, lines = ball(20.0, 60.0), []
for v in np.linspace(*cylinder.domain[1], 41):
    jet = cylinder.jet(np.array(cylinder.domain[0]), np.full(2, v))
    tips = jet.r + 10.0 * jet.normal - [0.0, 0.0, 10.0]
    lines.append(CLMotion(tips, np.tile([0.0, 0.0, 1.0], (2, 1))))
finish = operation("finishing", mill, lines, tolerance=1e-9)

# What is asked: the surface on a grid, under the whole program, by both roads.
program = Variant("program", "a ball along straight lines", (finish,))
grid = GridInspection(cylinder.name, ("program",), ("program",), rows=9, columns=33, margin=0.05, judged=("program",))
result = run_job(Job("my part", part, (program,), "program", (grid,)))

measured = result.measurements[cylinder.name, "program", DENSE]
print(result.verdict, measured.deviation.summary_um())
print(f"the two roads agree to {1e3 * measured.gap.max_um:.2g} nm over {measured.gap.valid} samples")
