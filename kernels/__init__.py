"""Warp functions and kernels, nothing else; imported as ``gearsim.kernels``."""

import warp as wp

wp.config.quiet = True  # the run's own report names device and versions
