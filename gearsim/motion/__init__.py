"""Motions: exact sources, and the table of quintic segments compiled from them."""
