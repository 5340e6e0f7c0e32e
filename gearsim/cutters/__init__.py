"""Cutters: meridian profiles of arcs and lines, and the catalogue that builds them."""
