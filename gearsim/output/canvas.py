"""The canvas of 3D pictures: one off-screen window for all, meshes added to its views, saved as PNG."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.colours import DARK, rgb, shades
from gearsim.output.png import write_png

_SIZE = (1300, 780)
_SHADES = 256  # of a palette
_SAMPLES = 4  # a pixel: edges look smooth, and a processor has less to draw than for the usual 8
_BEFORE = 400.0  # steps of depth: lines on a surface are drawn before it, from either side
_SHARP = 30.0  # deg between neighbours that meet in an edge


class Canvas:
    """A window without a screen. One serves all pictures: a window of its own for each costs more than to draw it."""

    def __init__(self) -> None:
        import vtkmodules.vtkRenderingFreeType
        import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 - these two are how VTK draws and writes
        from vtkmodules.vtkRenderingCore import vtkRenderWindow

        self._window = vtkRenderWindow()
        self._window.SetOffScreenRendering(True)
        self._window.SetMultiSamples(_SAMPLES)
        self._views: list[Any] = []

    def views(self, count: int = 1, size: tuple[int, int] = _SIZE) -> list[Any]:
        """A white page with views side by side, nothing in them."""
        from vtkmodules.vtkRenderingCore import vtkLightKit, vtkRenderer

        for view in self._views:
            self._window.RemoveRenderer(view)
        self._window.SetSize(*size)
        self._views = [vtkRenderer() for _ in range(count)]
        for k, view in enumerate(self._views):
            view.SetViewport(k / count, 0.0, (k + 1) / count, 1.0)
            view.SetBackground(1.0, 1.0, 1.0)
            self._window.AddRenderer(view)
            vtkLightKit().AddLightsToRenderer(view)
        return self._views

    def save(self, file: Path) -> None:
        """Draw the page and write it. Raises OSError where nothing was written."""
        write_png(self.pixels(), file)

    def pixels(self) -> NDArray:
        """Draw the page: its red, green, blue from 0 to 255, shape (height, width, 3)."""
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkRenderingCore import vtkWindowToImageFilter

        self._window.Render()
        pixels = vtkWindowToImageFilter()
        pixels.SetInput(self._window)
        pixels.SetInputBufferTypeToRGB()
        pixels.ReadFrontBufferOff()
        pixels.ShouldRerenderOff()
        pixels.Update()
        picture = pixels.GetOutput()
        width, height, _ = picture.GetDimensions()
        rows = vtk_to_numpy(picture.GetPointData().GetScalars()).reshape(height, width, 3)
        return np.asarray(rows[::-1])


def add_mesh(
    view: Any, shape: Any, colour: str, *, opacity: float = 1.0, ambient: float = 0.0, diffuse: float = 1.0,
    smooth: bool = False, sharp: bool = False, width: float = 1.0,
) -> None:  # fmt: skip
    """Add a mesh in one colour; ``smooth`` shades over its edges, ``sharp`` not over those where it bends sharply.

    ``width`` [pixels] is that of lines.
    """
    actor = _actor(with_normals(shape, sharp) if smooth else shape, ambient, diffuse)
    style = actor.GetProperty()
    style.SetColor(*rgb(colour))
    style.SetOpacity(opacity)
    style.SetLineWidth(width)
    mapper = actor.GetMapper()
    mapper.ScalarVisibilityOff()
    mapper.SetResolveCoincidentTopologyToPolygonOffset()
    mapper.SetRelativeCoincidentTopologyLineOffsetParameters(-2.0, -_BEFORE)
    view.AddActor(actor)


def add_map(
    view: Any, shape: Any, values: str, limit: float, *, missing: str = DARK, ambient: float = 0.35,
    diffuse: float = 0.65, smooth: bool = False, low: float | None = None, palette: str = "diverging",
) -> None:  # fmt: skip
    """Add a mesh coloured by values at its points from -``limit`` (or ``low``) to ``limit``, nan in one colour."""
    actor = _actor(with_normals(shape, False) if smooth else shape, ambient, diffuse)
    colour_by(actor.GetMapper(), values, colour_table(palette, -limit if low is None else low, limit, missing))
    view.AddActor(actor)


def colour_table(name: str, low: float, high: float, missing: str = DARK) -> Any:
    """A palette's colours from ``low`` to ``high``, of nan the colour ``missing``, as VTK looks them up."""
    from vtkmodules.vtkCommonCore import vtkLookupTable

    table = vtkLookupTable()
    table.SetNumberOfTableValues(_SHADES)
    for k, shade in enumerate(shades(name, _SHADES)):
        table.SetTableValue(k, *rgb(shade), 1.0)
    table.SetTableRange(low, high)
    table.SetNanColor(*rgb(missing), 1.0)
    return table


def colour_by(mapper: Any, values: str, table: Any) -> None:
    """Let a mapper colour its mesh by values at its points."""
    mapper.SetScalarVisibility(True)
    mapper.SetLookupTable(table)
    mapper.SetScalarRange(*table.GetTableRange())
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray(values)
    mapper.InterpolateScalarsBeforeMappingOn()


def _actor(shape: Any, ambient: float, diffuse: float) -> Any:
    from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

    mapper, actor = vtkPolyDataMapper(), vtkActor()
    mapper.SetInputData(shape)
    actor.SetMapper(mapper)
    actor.GetProperty().SetAmbient(ambient)
    actor.GetProperty().SetDiffuse(diffuse)
    return actor


def with_normals(shape: Any, sharp: bool) -> Any:
    """A mesh that is shaded over its edges wherever it is added; ``sharp``: not over those where it bends sharply."""
    from vtkmodules.vtkFiltersCore import vtkPolyDataNormals

    normals = vtkPolyDataNormals()
    normals.SetInputData(shape)
    normals.SetSplitting(sharp)
    normals.SetFeatureAngle(_SHARP)
    normals.Update()
    return normals.GetOutput()
