"""CL data in APT words (ISO 3592/4343 style): read and written.

Read are GOTO, FROM and GODLTA with RAPID, MULTAX, TLAXIS, UNITS, FEDRAT and SPINDL; CUTTER, LOADTL, TOOLNO, LOAD and
SELECT, tool by tool. ``$$`` starts a comment, ``$`` at a line's end carries it on; neither means anything in a
text word (PARTNO, PPRINT, ...). ``PPRINT PASS name`` names the cutting moves that follow. What cannot be read right is
told in a program's notes or refused with its line; nothing is dropped.
"""

from gearsim.programs.cldata.as_read import as_read
from gearsim.programs.cldata.cutter import CutterSizes, apt_parameters, check_cutter, cutter_of, is_apt, sizes_of
from gearsim.programs.cldata.program import RAPID, CLPath, CLProgram
from gearsim.programs.cldata.reader import parse_cl, read_cl_text
from gearsim.programs.cldata.tools import CLTool
from gearsim.programs.cldata.writer import assemble, format_cl

__all__ = [
    "RAPID",
    "CLPath",
    "CLProgram",
    "CLTool",
    "CutterSizes",
    "apt_parameters",
    "as_read",
    "assemble",
    "check_cutter",
    "cutter_of",
    "format_cl",
    "is_apt",
    "parse_cl",
    "read_cl_text",
    "sizes_of",
]
