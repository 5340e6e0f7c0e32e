"""What is written of a cylindrical gear."""
