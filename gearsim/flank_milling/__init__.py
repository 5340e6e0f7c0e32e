"""Flank milling of a bevel tooth slot: two passes, planned here or read from CL data."""

from gearsim.flank_milling.job import Job, plan
from gearsim.flank_milling.run import measure

__all__ = ["Job", "measure", "plan"]
