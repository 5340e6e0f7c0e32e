"""What a misplaced tool costs: one job under several changes, all cut together, as a table."""

from dataclasses import replace

import numpy as np

from gearsim.geometry.rigid import Rigid
from gearsim.motion.sources import MovedMotion
from gearsim.processes.run import plan, study
from gearsim.scene import load_scene

scene, folder = load_scene("flat-end-envelope", ("metrology.rows=3", "metrology.columns=5"))
job = plan(scene, folder)
nominal = job.variant("cl")


def moved(by: np.ndarray):
    """The CL data with the whole path displaced."""
    (operation,), shift = nominal.operations, Rigid(np.eye(3), by)
    sources = tuple(MovedMotion(source, shift) for source in operation.sources)
    return replace(nominal, operations=(replace(operation, sources=sources, table=operation.table.moved(shift)),))


changes = {f"{axis} + 5 um": {"cl": moved(5e-3 * unit)} for axis, unit in zip("xyz", np.eye(3), strict=True)}
for row in study(job, changes):
    if row["variant"] == "cl":
        print(f"{row['change'] or 'as planned':12} {row['surface']:6} {row['deviation_um.mean']:8.3f} um on average")
