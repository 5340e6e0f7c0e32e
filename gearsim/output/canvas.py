"""The canvas of 3D pictures: one off-screen window for all, meshes added to its views, saved as PNG."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from gearsim.output.colours import DARK, diverging, rgb
from gearsim.output.png import write_png

_SIZE = (1300, 780)
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
        write_png(rows[::-1], file)


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
    diffuse: float = 0.65, smooth: bool = False,
) -> None:  # fmt: skip
    """Add a mesh coloured by values at its points from -``limit`` to ``limit``, those that are nan in one colour."""
    from vtkmodules.vtkCommonCore import vtkLookupTable

    table = vtkLookupTable()
    table.SetNumberOfTableValues(256)
    for k, shade in enumerate(diverging(np.linspace(-1.0, 1.0, 256))):
        table.SetTableValue(k, (*map(float, shade), 1.0))
    table.SetTableRange(-limit, limit)
    table.SetNanColor(*rgb(missing), 1.0)
    actor = _actor(with_normals(shape, False) if smooth else shape, ambient, diffuse)
    mapper = actor.GetMapper()
    mapper.SetLookupTable(table)
    mapper.SetScalarRange(-limit, limit)
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray(values)
    mapper.InterpolateScalarsBeforeMappingOn()
    view.AddActor(actor)


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
