"""A run's meshes in a window of their own, coloured like everywhere; for where there is a screen."""

from __future__ import annotations

import json
from itertools import cycle
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from gearsim.errors import InputError, is_file, is_folder, read_input
from gearsim.output.canvas import colour_by, colour_table, with_normals
from gearsim.output.colours import DARK, STEEL, rgb
from gearsim.output.files import LAST, MESHES
from gearsim.output.meshes import run, values_of
from gearsim.output.view import DEVIATION

_SIZE = (1200, 800)
_WITHOUT_SCREEN = ("vtkEGLRenderWindow", "vtkOSOpenGLRenderWindow")  # what VTK makes where it finds no screen
_HELP = "drag: turn   wheel: zoom   shift and drag: move   c: next colours   r: whole part   q: close"
_LIGHT = {"SetAmbient": 0.45, "SetDiffuse": 0.6}


class Ramp(NamedTuple):
    """Values at a mesh's points by their name, their title, the ends of their colours, the palette."""

    values: str
    title: str
    low: float
    high: float
    palette: str


def open_window(source: Path) -> None:
    """Show a run's folder, or a .vtp file, until the window is closed.

    Raises InputError where there is no mesh, and where there is no screen.
    """
    file = mesh_file(source)
    shape = read_mesh(file)
    ramps = colourings(shape, tolerance_um(file.with_name(LAST)))
    window = _on_screen(file.parent)
    fill(window, shape, ramps, f"gearsim: {file}")
    window.GetInteractor().Start()


def mesh_file(source: Path) -> Path:
    """The mesh of a run's folder, or the file itself. Raises InputError where there is none."""
    if is_file(source) and source.suffix == ".vtp":
        return source
    if not is_folder(source):
        raise InputError(f"{source} is neither a run's folder nor a .vtp file")
    if not is_file(source / MESHES):
        raise InputError(f"{source} holds no {MESHES}: nothing was measured there, or --only left it out")
    return source / MESHES


def read_mesh(file: Path) -> Any:
    """A mesh of VTK's XML format. Raises InputError where it is none."""
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    text = read_input(file, "mesh")
    reader = vtkXMLPolyDataReader()
    if '<VTKFile type="PolyData"' not in text[:500]:
        raise InputError(f"cannot read mesh {file}: it is no VTK XML file of PolyData")
    reader.ReadFromInputStringOn()
    reader.SetInputString(text)
    shape = run(reader)
    if not shape.GetNumberOfPolys():
        raise InputError(f"cannot read mesh {file}: it holds no faces")
    return shape


def tolerance_um(report: Path) -> float:
    """The tightest tolerance that a run's report.json states, inf where it states none or there is no report."""
    if not is_file(report):
        return np.inf
    try:
        surfaces = json.loads(read_input(report, "report")).get("surfaces", {})
        given = [um for s in surfaces.values() if s for um in s.values() if um]
    except (AttributeError, ValueError) as error:
        raise InputError(f"cannot read {report}: it is no report of a run ({error})") from error
    return float(min(given, default=np.inf))


def colourings(shape: Any, limit_um: float) -> list[Ramp]:
    """What a mesh's points can be coloured by, deviations first, up to a limit or, where that is inf, to their size."""
    data, found = shape.GetPointData(), []
    if data.HasArray("deviation_um"):
        largest = float(np.nanmax(np.abs(values_of(shape, "deviation_um")), initial=1e-4))
        limit = limit_um if np.isfinite(limit_um) else largest
        found.append(Ramp("deviation_um", DEVIATION, -limit, limit, "diverging"))
    for name, title in (("segment", "row of the program"), ("patch", "surface")):
        if data.HasArray(name):
            last = float(values_of(shape, name).max(initial=1))
            found.append(Ramp(name, title, 0.0, last, "sequential"))
    return found


def fill(window: Any, shape: Any, ramps: list[Ramp], title: str) -> None:
    """Put a mesh into a window, coloured by the first of the ramps; the key c goes on to the next, then to plain."""
    import vtkmodules.vtkRenderingFreeType  # noqa: F401 - how VTK draws texts
    from vtkmodules.vtkRenderingAnnotation import vtkScalarBarActor
    from vtkmodules.vtkRenderingCore import vtkActor, vtkLightKit, vtkPolyDataMapper, vtkRenderer

    view, mapper, actor, bar = vtkRenderer(), vtkPolyDataMapper(), vtkActor(), vtkScalarBarActor()
    mapper.SetInputData(with_normals(shape, False))
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*rgb(STEEL))
    for name, value in _LIGHT.items():
        getattr(actor.GetProperty(), name)(value)
    _dress(bar)
    view.SetBackground(1.0, 1.0, 1.0)
    for prop in (actor, bar, _help()):
        view.AddViewProp(prop)
    vtkLightKit().AddLightsToRenderer(view)
    window.AddRenderer(view)
    window.SetWindowName(title)
    turns = cycle([*ramps, None])
    _colour(mapper, bar, next(turns))

    def pressed(interactor: Any, _: str) -> None:
        if interactor.GetKeySym() == "c":
            _colour(mapper, bar, next(turns))
            window.Render()

    if window.GetInteractor():
        window.GetInteractor().AddObserver("KeyPressEvent", pressed)
    view.ResetCamera()
    window.Render()


def _colour(mapper: Any, bar: Any, ramp: Ramp | None) -> None:
    """Colour by a ramp, or plain."""
    bar.SetVisibility(ramp is not None)
    mapper.SetScalarVisibility(ramp is not None)
    if ramp is None:
        return
    table = colour_table(ramp.palette, ramp.low, ramp.high)
    table.SetBelowRangeColor(*rgb(DARK), 1.0)  # as a segment of -1: none
    table.SetUseBelowRangeColor(ramp.palette == "sequential")
    colour_by(mapper, ramp.values, table)
    bar.SetLookupTable(table)
    bar.SetTitle(f"{ramp.title}\n")


def _dress(bar: Any) -> None:
    """Black letters of one size, the bar at the right."""
    bar.UnconstrainedFontSizeOn()
    bar.SetNumberOfLabels(5)
    bar.SetLabelFormat("{:.4g}")
    bar.SetPosition(0.86, 0.15)
    bar.SetWidth(0.08)
    bar.SetHeight(0.6)
    for style in (bar.GetLabelTextProperty(), bar.GetTitleTextProperty()):
        style.SetColor(0.0, 0.0, 0.0)
        style.SetFontSize(16)
        style.ItalicOff()
        style.BoldOff()
        style.ShadowOff()


def _help() -> Any:
    from vtkmodules.vtkRenderingCore import vtkTextActor

    text = vtkTextActor()
    text.SetInput(_HELP)
    text.SetPosition(12, 12)
    text.GetTextProperty().SetColor(0.25, 0.25, 0.25)
    text.GetTextProperty().SetFontSize(16)
    return text


def _on_screen(folder: Path) -> Any:
    """A window on the screen, with what turns it. Raises InputError where there is no screen."""
    import vtkmodules.vtkInteractionStyle
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 - how VTK draws
    from vtkmodules.vtkCommonCore import vtkLogger
    from vtkmodules.vtkInteractionStyle import vtkInteractorStyleTrackballCamera
    from vtkmodules.vtkRenderingCore import vtkRenderWindow, vtkRenderWindowInteractor

    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)  # it would tell of the missing screen as a warning
    window = vtkRenderWindow()
    if window.GetClassName() in _WITHOUT_SCREEN:
        raise InputError(f"there is no screen for a window here; open {folder / 'report.html'}: its 3D view needs none")
    window.SetSize(*_SIZE)
    interactor = vtkRenderWindowInteractor()
    interactor.SetInteractorStyle(vtkInteractorStyleTrackballCamera())
    interactor.SetRenderWindow(window)
    return window
