"""The removal road: rays, stock and the launches of the Warp kernels that cut them."""
