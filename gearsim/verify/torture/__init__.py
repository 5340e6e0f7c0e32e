"""The removal road against an oracle that shares no code with the kernels, on rays that touch, graze and pass."""
