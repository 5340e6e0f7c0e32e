"""The envelope road: the machined surface in closed form, from the exact motion.

The machined surface has four closed-form classes (``Kind``): the envelope proper inside a smooth piece of
the path, the tool at a joint where the velocity jumps, the tool at the path's ends, and the surface swept
by a sharp edge of the profile. All are solved for along given rays; what survives trimming is machined.
"""

from gearsim.envelope.machined import TRIM_TOLERANCE, EnvelopeRoad, machined_along
from gearsim.envelope.patch import EnvelopePatch
from gearsim.envelope.surface import envelope_grid, envelope_points, prepare_envelope

__all__ = [
    "TRIM_TOLERANCE", "EnvelopePatch", "EnvelopeRoad", "envelope_grid", "envelope_points", "machined_along",
    "prepare_envelope",
]  # fmt: skip
