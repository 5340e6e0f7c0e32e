"""Cylindrical gears milled by generation: plan, post, read back, cut, measure."""
