"""CL data written: cutting passes joined by rapid moves, as text."""

from __future__ import annotations

import numpy as np

from gearsim.cutters.profile import Profile
from gearsim.programs.cldata.cutter import sizes_of
from gearsim.programs.cldata.program import RAPID, CLPath, CLProgram
from gearsim.programs.cldata.tools import CLTool


def format_cl(program: CLProgram, title: str, feed_mm_min: float, decimals: int) -> str:
    """CL data as text with ``decimals`` digits behind the point; ``feed_mm_min`` holds for paths that state none.

    Where the tool changes, FROM states where the next one stands before its first move.
    """
    lines = [f"PARTNO {title}", "UNITS/MM", "MULTAX/ON"]
    tool = -1
    for path in program.paths:
        changed = path.tool != tool
        if changed:
            tool = path.tool
            lines += _tool(program.tools[tool])
        lines.append(f"$$ {len(path.tips) - 1} moves, {path.name}")
        rows = np.round(np.hstack([path.tips, path.axes]), decimals) + 0.0
        if changed:
            lines.append("FROM/" + ",".join(f"{v:.{decimals}f}" for v in rows[0]))
        if path.name != RAPID:
            lines += [f"PPRINT PASS {path.name}", f"FEDRAT/{path.feed or feed_mm_min:g}"]
        for row in rows[1:]:
            lines += ["RAPID"] if path.name == RAPID else []
            lines.append("GOTO/" + ",".join(f"{v:.{decimals}f}" for v in row))
    return "\n".join([*lines, "FINI", ""])


def _tool(tool: CLTool) -> list[str]:
    """What names a tool: its number and its sizes, as far as it has them."""
    lines = [f"LOADTL/{tool.number}"] if tool.number else []
    if tool.sizes is not None:
        lines.append("CUTTER/" + ",".join(f"{v:.9g}" for v in tool.sizes.sizes))
    return lines


def assemble(passes: list[CLPath], retract: float, cutter: Profile) -> CLProgram:
    """A program that runs cutting passes, with rapid moves along the tool axis before and after each.

    ``retract`` [mm] is how far the tool withdraws along its axis between the passes.
    """
    paths: list[CLPath] = []
    for path in passes:
        tips = [path.tips[0] + retract * path.axes[0], path.tips[0]]
        axes = [path.axes[0], path.axes[0]]
        if paths:
            tips.insert(0, paths[-1].tips[-1])
            axes.insert(0, paths[-1].axes[-1])
        end, end_axis = path.tips[-1], path.axes[-1]
        away = np.array([end, end + retract * end_axis])
        paths += [
            CLPath(RAPID, np.array(tips), np.array(axes)),
            path,
            CLPath(RAPID, away, np.array([end_axis, end_axis])),
        ]
    return CLProgram(tuple(paths), (CLTool(sizes=sizes_of(cutter)),))
