"""Checks closed-form machined surfaces against brute force that uses no envelope condition.

A ``ClosedForm`` says where a tool on a motion leaves the material, with normals and curvatures; ``verify_form``
tries it at random points. Scenes declare theirs in ``scenes.py``; users bring a Python file or a point list.
"""

from gearsim.verify.checks import Check, FormReport, Limits, verify_form
from gearsim.verify.closed_form import (
    Claimed,
    ClosedForm,
    envelope_form,
    envelope_forms,
    pose_form,
    pose_forms,
    principal,
)
from gearsim.verify.points import machined_points, verify_points
from gearsim.verify.scenes import closed_forms
from gearsim.verify.user_surface import PoseFunction, load_surface

__all__ = [
    "Check", "Claimed", "ClosedForm", "FormReport", "Limits", "PoseFunction", "closed_forms", "envelope_form",
    "envelope_forms", "load_surface", "machined_points", "pose_form", "pose_forms", "principal", "verify_form",
    "verify_points",
]  # fmt: skip
