"""Cylindrical gears milled by generation: plan, post, read back, cut, measure."""

from gearsim.generation_milling.job import GearJob, plan
from gearsim.generation_milling.run import measure

__all__ = ["GearJob", "measure", "plan"]
