"""Closed surfaces from rays: dual contouring of material that is known along the lines of a lattice.

``columns``, ``crossings``, ``sheets`` and ``cells`` know indices of the lattice only, ``hits`` where its nodes are.
"""
