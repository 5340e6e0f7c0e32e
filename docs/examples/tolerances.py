"""One cut judged by other tolerances: a part's tolerances are data, and nothing is judged that has none."""

from dataclasses import replace

from gearsim.processes.run import plan, run_job
from gearsim.scene import load_scene
from gearsim.surfaces.part import Tolerance

scene, folder = load_scene("flat-end-envelope", ("metrology.rows=3", "metrology.columns=5"))
job = plan(scene, folder)


def judged(tolerance, variant):
    """The same job with every surface held against a tolerance under one of its motions."""
    surfaces = {name: replace(surface, tolerance=tolerance) for name, surface in job.part.surfaces.items()}
    inspections = tuple(replace(i, judged=(variant,) if tolerance else ()) for i in job.inspections)
    return replace(job, part=replace(job.part, surfaces=surfaces), inspections=inspections, main=variant)


for tolerance, variant in ((Tolerance.both(0.1), "theory"), (Tolerance.both(0.1), "cl"), (None, "cl")):
    result = run_job(judged(tolerance, variant))
    print(f"{variant:7} {tolerance.text if tolerance else 'no tolerance':9} {result.verdict}: {result.status[:60]}")
