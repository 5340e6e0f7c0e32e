"""Rigid motions, truncated series, surface jets and the grazing condition: geometry that knows no gear."""
