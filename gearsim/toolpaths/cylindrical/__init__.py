"""Toolpaths for cylindrical gears on a five-axis mill (Groover 2018)."""
