"""Jobs that generate a surface: a tool in motion, its envelope in closed form, and other motions beside it."""

from gearsim.generating.job import GeneratingJob
from gearsim.generating.plan import plan
from gearsim.generating.run import measure

__all__ = ["GeneratingJob", "measure", "plan"]
