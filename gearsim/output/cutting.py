"""An animation of the cut: frames of a part on its way from the blank, drawn in a process of their own.

``python -m gearsim.output.cutting FILE`` reads pickled frames until there are no more. A machine without OpenGL ends
that process, not the command; and while it draws, the next stage is being cut.
"""

from __future__ import annotations

import pickle
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from tempfile import TemporaryFile

import numpy as np

from gearsim.errors import InputError, written
from gearsim.output.animation import Frame, write_animation
from gearsim.output.colours import BLANK
from gearsim.output.draw_swept import tool_skin
from gearsim.output.layers import outline
from gearsim.output.meshes import points_of, triangles_of
from gearsim.output.painting import reason
from gearsim.output.programs import duration
from gearsim.output.shapes import Classes, Shape
from gearsim.output.whole_part import seen_from
from gearsim.programs.names import distinct
from gearsim.simulation.operation import Operation
from gearsim.simulation.stages import Stage, Way, axis_end, tip_end

_COLOURING = "operation"
_TOOL, _HOLDER = "#d8b26e", "#6b7480"


def frames(way: Way, stages: Iterable[Stage]) -> Iterator[Frame]:
    """A frame a stage: the part, its faces by the operation that made them, and the tool where it is then.

    Raises InputError where nothing is there to begin with.
    """
    earlier = [d.name for d in way.saved.done] if way.saved else []
    turned = [way.turning.name] if way.turning else []
    names, past = distinct([BLANK, *earlier, *turned, *(o.name for o in way.operations)]), 0.0
    for stage in stages:
        mesh = stage.contour.mesh
        if stage.operation < 0 and not len(mesh.triangles):
            raise InputError("stock: nothing of the blank is there to be cut" + " once it is turned" * bool(turned))
        made = Classes(stage.stock.operation_of(mesh.tag) + 1, names)
        shapes = [Shape("part", mesh.points, mesh.triangles, {_COLOURING: made}, smooth=False)]
        if stage.operation < 0:
            yield Frame(shapes, f"the blank{', turned' * bool(turned)}, {_volume(way, stage):,.0f} mm3")
            continue
        operation = way.operations[stage.operation]
        seconds = float(np.nansum(operation.seconds[: stage.rows]))
        text = _text(way, stage, past + seconds)
        if stage.rows < len(operation):
            shapes += _tool(operation, stage.rows - 1)
        else:
            past += seconds
        yield Frame(shapes, text)


def _volume(way: Way, stage: Stage) -> float:
    """Of what it begins with [mm³]: exact where that is a solid."""
    return float(np.mean(stage.stock.volumes)) if way.saved or way.turning else way.blank.volume


def _text(way: Way, stage: Stage, seconds: float) -> str:
    operation, left = way.operations[stage.operation], float(np.mean(stage.stock.volumes))
    which = f"{stage.operation + 1} of {len(way.operations)}: {operation.name}, {stage.rows / len(operation):.0%}"
    clock = f", after {duration(seconds)} in feed" if seconds > 0.0 else ""
    return f"{which}{clock}, {left:,.0f} mm3 left"


def _tool(operation: Operation, row: int) -> Iterator[Shape]:
    """The tool, and what stands above it, at the end of a row."""
    tip, axis = tip_end(operation)[row], axis_end(operation)[row]
    solids = {"tool": (operation.cutter, _TOOL), "holder": (operation.holder, _HOLDER)}
    for name, (solid, colour) in solids.items():
        if solid is not None:
            skin = tool_skin(outline(solid), tip, axis)
            yield Shape(name, points_of(skin), triangles_of(skin), plain=colour)


def write_cutting(way: Way, stages: Iterable[Stage], file: Path) -> int:
    """Write an animated WebP of stages; returns the number of frames.

    Raises InputError where it cannot be drawn or written, and whatever making the stages does.
    """
    above = bool(np.mean([axis_end(o)[:, 2].mean() for o in way.operations]) >= 0.0)
    with written(file, "animation") as scratch, TemporaryFile("w+") as told:
        command = [sys.executable, "-P", "-m", "gearsim.output.cutting", str(scratch), str(above)]
        process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=told)
        try:
            count = _handed_on(frames(way, stages), process)
        except BaseException:
            process.kill()
            raise
        finally:
            code = process.wait()
        if code:
            told.seek(0)
            raise InputError(f"cannot draw {file.name}: {reason('solid', [], told.read(), code)}")
    return count


def _handed_on(made: Iterable[Frame], process: subprocess.Popen[bytes]) -> int:
    count = 0
    assert process.stdin is not None
    try:
        for frame in made:
            pickle.dump(frame, process.stdin, protocol=pickle.HIGHEST_PROTOCOL)
            process.stdin.flush()
            count += 1
        process.stdin.close()
    except BrokenPipeError:  # it has ended; its exit code says why
        pass
    return count


def _received() -> Iterator[Frame]:
    while True:
        try:
            yield pickle.load(sys.stdin.buffer)  # our own, written a moment ago
        except EOFError:
            return


if __name__ == "__main__":
    way, up = seen_from(sys.argv[2] == "True")
    write_animation(_received(), Path(sys.argv[1]), _COLOURING, way, up)
