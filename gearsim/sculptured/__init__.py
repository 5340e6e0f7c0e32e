"""Jobs that mill a NURBS surface with a vertical tool and set predicted local gouging against the cut."""

from gearsim.sculptured.job import SculpturedJob, plan
from gearsim.sculptured.run import measure

__all__ = ["SculpturedJob", "measure", "plan"]
