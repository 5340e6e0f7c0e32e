import json
import shutil

import numpy as np
import pytest
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 - how VTK draws
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkRenderingCore import vtkRenderWindow, vtkWindowToImageFilter

from gearsim.cli import main
from gearsim.output.colours import diverging
from gearsim.output.meshes import joined, quads, write_vtp
from gearsim.output.view import DEVIATION
from gearsim.output.window import Ramp, colourings, fill, read_mesh, tolerance_um

SQUARE = np.stack([*np.meshgrid([0.0, 1.0], [0.0, 1.0]), np.zeros((2, 2))], axis=-1)
ALONG = np.array([1.0, 0.0, 0.0])


@pytest.fixture
def run(tmp_path):
    """A folder as a run leaves it: three squares, one far overcut, one not measured, one with material left."""
    squares = [
        quads(SQUARE + k * ALONG, {"deviation_um": np.full((2, 2), um), "segment": np.full((2, 2), segment)})
        for k, (um, segment) in enumerate([(-9.0, 0), (np.nan, -1), (9.0, 7)])
    ]  # fmt: skip
    write_vtp(joined(squares), {"units": "mm"}, tmp_path / "tooth.vtp")
    surfaces = {"left": {"overcut_tolerance_um": 5.0, "excess_tolerance_um": None}, "bottom": None}
    (tmp_path / "report.json").write_text(json.dumps({"surfaces": surfaces}))
    return tmp_path


def seen(window):
    pixels = vtkWindowToImageFilter()
    pixels.SetInput(window)
    pixels.Update()
    return vtk_to_numpy(pixels.GetOutput().GetPointData().GetScalars()) / 255.0


def share_near(colours, colour):
    """The share of pixels of a colour in about any light."""
    along = colours @ colour / max(np.linalg.norm(colour), 1e-9)
    length = np.linalg.norm(colours, axis=1)
    return float(((along > 0.995 * length) & (length > 0.1)).mean())


def test_a_window_shows_overcut_excess_and_what_is_missing(run):
    shape = read_mesh(run / "tooth.vtp")
    ramps = colourings(shape, tolerance_um(run / "report.json"))
    assert [(r.values, r.low, r.high) for r in ramps] == [("deviation_um", -5.0, 5.0), ("segment", 0.0, 7.0)]
    window = vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetSize(400, 300)
    fill(window, shape, ramps, "")
    pixels = seen(window)
    for end in diverging(np.array([-1.0, 1.0])):
        assert share_near(pixels, end) > 0.03
    assert (pixels.max(axis=1) < 0.05).mean() > 0.03


def test_without_a_tolerance_colours_end_where_deviations_do(run):
    shape = read_mesh(run / "tooth.vtp")
    assert tolerance_um(run / "nothing.json") == np.inf
    assert colourings(shape, np.inf)[0] == Ramp("deviation_um", DEVIATION, -9.0, 9.0, "diverging")


def test_without_a_screen_the_command_says_what_to_open_instead(run, monkeypatch, capfd):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    for shown in (run, run / "tooth.vtp"):
        assert main(["view", str(shown)]) == 2
        told = f"gearsim: there is no screen for a window here; open {run}/report.html: its 3D view needs none\n"
        assert capfd.readouterr() == ("", told)


def test_what_is_no_mesh_is_refused(run, capsys):
    def told(path):
        assert main(["view", str(path)]) == 2
        return capsys.readouterr().err

    assert told(run / "nothing") == f"gearsim: {run / 'nothing'} is neither a run's folder nor a .vtp file\n"
    (run / "other.vtp").write_text("solid")
    assert "it is no VTK XML file of PolyData" in told(run / "other.vtp")
    (run / "report.json").write_text("[]")
    assert "it is no report of a run" in told(run)
    shutil.move(run / "tooth.vtp", run / "tooth.gone")
    assert f"{run} holds no tooth.vtp: nothing was measured there" in told(run)
