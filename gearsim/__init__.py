"""gearsim: machines gears virtually and measures the machined tooth in micrometres."""

from gearsim.errors import GearsimError, InputError, NumericalError

__version__ = "0.1.0"
__all__ = ["GearsimError", "InputError", "NumericalError", "__version__"]
