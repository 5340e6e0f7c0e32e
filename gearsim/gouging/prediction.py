"""Local gouging predicted at the contacts of a path or over a surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.cutters.contact import BEYOND, cutting_contact, locate
from gearsim.cutters.profile import Profile
from gearsim.gouging.compare import Comparison, Decision, compare_contact
from gearsim.gouging.surface import SurfaceContacts, surface_contacts
from gearsim.surfaces.nurbs import NurbsSurface
from gearsim.surfaces.patch import Jet
from gearsim.toolpaths.sculptured import SculpturedPath

_TOUCHES = 1e-6  # mm


@dataclass(frozen=True)
class Prediction:
    """Tool against part at n points: angles and tensors, their comparison, and whether the tool can touch there.

    Where it cannot (``touches`` False: the surface is turned away, steeper than the tool's flank up to its top, has no
    curvature, or is touched at its border only) nothing is predicted: `decision` is -1.
    """

    contacts: SurfaceContacts
    comparison: Comparison
    touches: NDArray[np.bool_]

    @property
    def decision(self) -> NDArray:
        """`Decision` or -1, shape (n,)."""
        return np.where(self.touches, self.comparison.decision, -1)

    @property
    def gouges(self) -> NDArray:
        return np.asarray(self.decision == Decision.GOUGES)


def predict(surface: NurbsSurface, cutter: Profile, u: NDArray, v: NDArray) -> Prediction:
    """What a tool whose axis is +z does at points of a surface, u and v of shape (n,)."""
    return predict_at(surface.jet(u, v), cutter)


def predict_at(jet: Jet, cutter: Profile, axis: ArrayLike = (0.0, 0.0, 1.0)) -> Prediction:
    """What the tool does at points (n,) given with their curvatures; ``axis``: its unit axis away from the tip."""
    contacts = surface_contacts(jet, axis)
    comparison = compare_contact(cutting_contact(cutter, contacts.theta), contacts.part)
    return Prediction(contacts, comparison, np.isfinite(comparison.least) & (contacts.theta <= 0.5 * np.pi + BEYOND))


def predict_path(surface: NurbsSurface, cutter: Profile, path: SculpturedPath) -> Prediction:
    """The same at the contacts of a path; at the surface's border a dropped tool may touch without being tangent."""
    t = path.touches
    found = predict(surface, cutter, t.u, t.v)
    with np.errstate(invalid="ignore"):
        off = np.linalg.norm(locate(cutter, t.point, t.normal).tip - t.tip, axis=1)
        return Prediction(found.contacts, found.comparison, found.touches & (off <= _TOUCHES))


def at_one(found: Prediction, i: int) -> Prediction:
    """The prediction at one of its points alone."""
    f, one = found.comparison, slice(i, i + 1)
    contacts = SurfaceContacts(found.contacts.theta[one], found.contacts.part[one])
    comparison = Comparison(*(np.ravel(x)[one] for x in (f.mean, f.amplitude, f.phase, f.least)))
    return Prediction(contacts, comparison, found.touches[one])
