"""Toolpath planning: from an intended surface and a cutter to a motion."""
