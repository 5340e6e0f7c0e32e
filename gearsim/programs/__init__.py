"""Machine and CL programs, read and written."""
