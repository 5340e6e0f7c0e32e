"""Colours that mean one thing in every picture: material left, overcut, the intended surface, the steel around it."""

EXCESS = "#b2182b"
OVERCUT = "#2166ac"
DIVERGING = "RdBu_r"  # overcut in the one colour, excess in the other
BAND = "#dfe8d8"  # within tolerance
LINE = "0.35"
