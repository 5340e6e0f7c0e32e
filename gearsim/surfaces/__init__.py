"""Intended surfaces: gear blanks and teeth in closed form, sculptured parts as NURBS and their files."""
