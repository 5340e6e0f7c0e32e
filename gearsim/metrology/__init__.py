"""Deviation of the machined tooth from the intended one, as an inspector reads it."""
