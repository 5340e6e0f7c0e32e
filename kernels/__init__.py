"""Warp functions and kernels, nothing else; imported as ``gearsim.kernels``."""

import warp as wp

wp.config.log_level = wp.LOG_ERROR  # the run's own report names device and versions
