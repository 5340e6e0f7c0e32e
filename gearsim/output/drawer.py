"""3D pictures, tooth.vtp and the interactive view, made in a process of their own; what needs no OpenGL comes first.

All are made of named arrays: the process loads nothing that cuts or measures. VTK is loaded when something is drawn.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from numpy.typing import NDArray

from gearsim.output.canvas import Canvas
from gearsim.output.draw import draw_blanks, draw_envelopes, draw_toolpaths, patch_meshes
from gearsim.output.draw_swept import draw_swept
from gearsim.output.draw_tooth import draw_tooth
from gearsim.output.files import MESHES, VIEW
from gearsim.output.gear.draw import draw_gear
from gearsim.output.gouging.draw import draw_surfaces
from gearsim.output.meshes import joined, write_vtp
from gearsim.output.part_view import part_view
from gearsim.output.wanted import Wanted
from gearsim.output.whole_part import draw_whole

FRAGMENT = "_view.html"  # aside, for report.html
Arrays = dict[str, NDArray]


class Picture(NamedTuple):
    """A picture of all those arrays whose names begin with ``needs``, and its caption."""

    file: str
    needs: str
    caption: str
    draw: Callable[[Arrays, dict[str, Any], Canvas], None]


PICTURES = (
    Picture("surface.png", "gouge:", "The machined surface under the first tools, with the tool", draw_surfaces),
    Picture("gear.png", "section:", "The machined gear with its tool, and space 1 coloured by deviation", draw_gear),
    Picture("tooth.png", "tooth:", "The machined slot among its neighbours, coloured by its deviation", draw_tooth),
    Picture("part.png", "whole:", "The whole part as it was cut, by operation and by deviation", draw_whole),
    Picture("envelope.png", "grazing:", "The surfaces with grazing curves, and the tool at both ends", draw_swept),
    Picture("toolpaths.png", "path:", "Tool axis positions of the finish passes", draw_toolpaths),
    Picture("envelopes.png", "envelope:", "The cutter's untrimmed envelopes", draw_envelopes),
    Picture("blanks.png", "mate:", "The blanks of the part and its mate in mesh", draw_blanks),
)


def solid_files(data: Arrays) -> list[str]:
    """The names of all that ``draw_all`` would write of these arrays."""
    meshes = [MESHES] if any(key.startswith("patch:") for key in data) else []
    return [*meshes, *(p.file for p in _drawable(data))]


def draw_all(data: Arrays, folder: Path, wanted: Wanted, tell: Callable[[dict[str, str]], None]) -> None:
    """Write tooth.vtp and the view, draw every picture there are arrays for, as wanted; ``tell`` of captions first."""
    surfaces = patch_meshes(data)
    if surfaces and wanted.file(MESHES):
        whole = joined(surfaces.values())
        whole.GetPointData().SetActiveScalars("deviation_um")
        write_vtp(whole, dict(data["stated"]), folder / MESHES)
    if (surfaces or "whole:points" in data) and wanted.file(VIEW):
        (folder / FRAGMENT).write_text(part_view(data, surfaces), encoding="utf-8")
    pictures = [p for p in _drawable(data) if wanted.file(p.file)]
    tell({p.file: p.caption for p in pictures})
    canvas = Canvas() if pictures else None
    for picture in pictures:
        assert canvas is not None
        picture.draw(data, surfaces, canvas)
        canvas.save(folder / picture.file)


def _drawable(data: Arrays) -> list[Picture]:
    return [p for p in PICTURES if any(key.startswith(p.needs) for key in data)]
