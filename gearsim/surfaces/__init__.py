"""Intended surfaces: gear blanks and teeth in closed form."""
