"""Other programs that answer the same question as gearsim, and their answers kept as data."""
