"""The reader of G-code: from text to the blocks a machine runs."""
