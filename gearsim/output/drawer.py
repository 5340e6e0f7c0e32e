"""3D pictures and tooth.vtp, drawn in a process of their own; tooth.vtp, which needs no OpenGL, is written first.

PyVista is loaded when something is drawn: what there is to draw is known without it.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from numpy.typing import NDArray

from gearsim.output.draw import draw_blanks, draw_envelopes, draw_toolpaths, patch_meshes
from gearsim.output.draw_swept import draw_swept
from gearsim.output.draw_tooth import draw_tooth
from gearsim.output.exr import stated
from gearsim.output.gear.draw import draw_gear
from gearsim.output.gouging.draw import draw_surfaces
from gearsim.output.presenters import collected
from gearsim.output.wanted import Wanted
from gearsim.result import Result

Arrays = dict[str, NDArray]


class Picture(NamedTuple):
    """A picture of all those arrays whose names begin with ``needs``, and its caption."""

    file: str
    needs: str
    caption: str
    draw: Callable[[Arrays, dict[str, Any], Path], None]


PICTURES = (
    Picture("surface.png", "gouge:", "The machined surface under the first tools, with the tool", draw_surfaces),
    Picture("gear.png", "section:", "The machined gear with its tool, and space 1 coloured by deviation", draw_gear),
    Picture("tooth.png", "tooth:", "The machined slot among its neighbours, coloured by its deviation", draw_tooth),
    Picture("envelope.png", "grazing:", "The surfaces with grazing curves, and the tool at both ends", draw_swept),
    Picture("toolpaths.png", "path:", "Tool axis positions of the finish passes", draw_toolpaths),
    Picture("envelopes.png", "envelope:", "The cutter's untrimmed envelopes", draw_envelopes),
    Picture("blanks.png", "mate:", "The blanks of the part and its mate in mesh", draw_blanks),
)


MESHES = "tooth.vtp"


def solid_files(result: Result) -> list[str]:
    """The names of all that ``draw_all`` would write of a result."""
    data = _arrays(result)
    meshes = [MESHES] if any(key.startswith("patch:") for key in data) else []
    return [*meshes, *(p.file for p in _drawable(data))]


def draw_all(result: Result, folder: Path, wanted: Wanted, tell: Callable[[dict[str, str]], None]) -> None:
    """Write tooth.vtp and draw every picture there are arrays for, as wanted; ``tell`` of captions before drawing."""
    import pyvista as pv

    pv.OFF_SCREEN = True
    data = _arrays(result)
    surfaces = patch_meshes(data)
    if surfaces and wanted.file(MESHES):
        whole = pv.merge(list(surfaces.values()), merge_points=False)
        skin = whole.extract_surface(algorithm=None)
        for key, text in stated(result).items():
            skin.field_data[f"gearsim.{key}"] = [text]
        _save(skin, folder / MESHES)
    pictures = [p for p in _drawable(data) if wanted.file(p.file)]
    tell({p.file: p.caption for p in pictures})
    for picture in pictures:
        picture.draw(data, surfaces, folder / picture.file)


def _save(mesh: Any, file: Path) -> None:
    """Write a mesh as VTK would, but by Python: VTK's own writing ends the process where the disk takes no more."""
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(mesh)
    writer.SetDataModeToBinary()
    writer.WriteToOutputStringOn()
    writer.Write()
    file.write_text(writer.GetOutputString(), encoding="ascii")


def _arrays(result: Result) -> Arrays:
    data: Arrays = {}
    for arrays in collected(result, "layers"):
        data |= arrays
    return data


def _drawable(data: Arrays) -> list[Picture]:
    return [p for p in PICTURES if any(key.startswith(p.needs) for key in data)]
