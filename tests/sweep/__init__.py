"""Every key of every built-in scene deleted, mistyped and set to nonsense: what the command says of it.

``python -m tests.sweep`` goes through all of them; ``test_sweep.py`` through a few.
"""
