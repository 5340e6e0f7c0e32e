"""What a user should know of a CL file that mills flanks."""

from __future__ import annotations

from difflib import get_close_matches

from gearsim.programs.cldata import CLProgram
from gearsim.scene.program import ProgramTable
from gearsim.surfaces.patch import SIDES


def pass_notes(program: CLProgram) -> list[str]:
    """Pass names that are no flank's, and flanks that no pass is named after while others are."""
    notes = []
    strange = {name: line for name, line in program.named if name not in SIDES}
    if strange:
        told = ", ".join(f"{name!r} (line {line}{_nearest(name)})" for name, line in strange.items())
        notes.append(f"passes named after no flank: {told}; flanks are {' and '.join(SIDES)}")
    if program.named:
        notes += [
            f"no pass is named {side}: every cutting pass counts as its own" for side in SIDES if not program.path(side)
        ]
    return notes


def posting_notes(program: CLProgram, table: ProgramTable | None) -> tuple[str, ...]:
    """Where the machine's program says other conditions than the CL file."""
    if table is None:
        return ()
    notes = []
    if program.feed is not None and program.fastest is not None and program.fastest > program.feed:
        of_what = "throughout" if len(program.tools) == 1 else "of each tool"
        feeds = f"{program.feed:g} to {program.fastest:g} mm/min"
        notes.append(f"the feeds of cutting moves are {feeds}; program.nc keeps the slowest {of_what}")
    if program.spindle is not None and program.spindle != table.spindle_rpm:
        notes.append(
            f"SPINDL states {program.spindle:g}/min; program.nc runs at the scene's program.spindle_rpm, "
            f"{table.spindle_rpm:g}"
        )
    return tuple(notes)


def _nearest(name: str) -> str:
    near = get_close_matches(name, SIDES, n=1, cutoff=0.6)
    return f", did you mean {near[0]}?" if near else ""
