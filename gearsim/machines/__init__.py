"""Machines: chains of joints from tool to workpiece, forward and inverse, and the catalogue of them."""
