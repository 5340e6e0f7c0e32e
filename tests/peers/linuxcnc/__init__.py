"""LinuxCNC's stand-alone interpreter against the reader of G-code, program by program.

``python -m tests.peers.linuxcnc --help`` runs it; the answers it gave stand in tests/data/gcode/linuxcnc.
"""
