"""A built-in scene planned, looked at before anything is cut, run, and its numbers taken as arrays."""

import numpy as np

from gearsim.processes.run import plan, run_job
from gearsim.scene import load_scene

SMALL = ("metrology.rows=5", "metrology.columns=17", "metrology.convergence=[]", "simulation.dexel_pitch_mm=0.8")
scene, folder = load_scene("spiral-bevel-flank", SMALL)
job = plan(scene, folder)
for name, surface in job.part.surfaces.items():
    print(f"{name:16} {surface.tolerance.text}")
for variant in job.variants:
    print(f"{variant.name:14} {', '.join(variant.surfaces) or 'all':8} {len(variant):4} segments: {variant.text}")

result = run_job(job)
for (surface, variant, inspection), measured in result.measurements.items():
    if inspection == "dense grid":
        um = 1e3 * measured.deviation.value  # rows root to tip, columns toe to heel
        print(f"{surface:16} {variant:10} {np.nanmin(um):9.3f} to {np.nanmax(um):9.3f} um")
print(result.verdict, result.findings[0].text)
