"""A surface's points as contacts of a tool with a given axis: angles, tensors, and the largest tool at each."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.cutters.contact import approach
from gearsim.gouging.sizes import Choice, largest_mills
from gearsim.gouging.tensors import Tensor
from gearsim.surfaces.nurbs import shape_tensor
from gearsim.surfaces.patch import Jet


class SurfaceContacts(NamedTuple):
    """Contact angles theta [rad], shape (n,), and the part's tensors in the basis (uphill, n x uphill)."""

    theta: NDArray
    part: Tensor


def surface_contacts(jet: Jet, axis: ArrayLike = (0.0, 0.0, 1.0), toward: ArrayLike | None = None) -> SurfaceContacts:
    """The points of a surface as contacts; ``axis`` and ``toward`` as in `cutters.contact.approach`."""
    seen = approach(jet.normal, axis, toward)
    return SurfaceContacts(seen.theta, Tensor(*shape_tensor(jet, seen.uphill)))


def largest_mill_map(jet: Jet, mills: NDArray, axis: ArrayLike = (0.0, 0.0, 1.0)) -> Choice:
    """The largest mill of a catalogue (R, r), shape (m, 2), at each point of a surface, shape (n,).

    Row -1 and nan where none fits: where all gouge, where the surface is turned away from the axis (theta above
    90 deg), where it has no curvature. Local gouging only: elsewhere on the surface the mill may still hit it.
    """
    contacts = surface_contacts(jet, axis)
    return largest_mills(mills, np.where(np.isfinite(contacts.theta), contacts.theta, np.pi), contacts.part)
