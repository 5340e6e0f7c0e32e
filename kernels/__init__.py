"""Warp functions and kernels, nothing else; imported as ``gearsim.kernels``."""
