"""The reader of G-code: from text to the blocks a machine runs."""

from gearsim.programs.gcode.errors import ProgramError
from gearsim.programs.gcode.program import Program, read_program
from gearsim.programs.gcode.settings import ReadSettings

__all__ = ["Program", "ProgramError", "ReadSettings", "read_program"]
