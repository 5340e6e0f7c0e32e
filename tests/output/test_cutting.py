"""``gearsim animate``: the cut as an animated picture, drawn aside."""

import sys
from argparse import Namespace

import numpy as np
import pytest
from PIL import Image

from gearsim.cli import main
from gearsim.output.colours import BLANK, class_colours, rgb
from gearsim.output.cutting import frames
from gearsim.processes.animate import _way as way_of
from gearsim.processes.run import plan
from gearsim.scene import load_scene
from gearsim.simulation.workshop import Workshop
from tests.output.test_animation import shares

ASKED = ["animate", "drill-grid", "--set", "stock.pitch_mm=2.3", "--pitch-mm", "2.3", "--frames", "7"]


def test_the_cut_is_seen_to_go_on(tmp_path, capsys):
    file = tmp_path / "new" / "cut.webp"
    assert main([*ASKED, "--out", str(file)]) == 0
    told = capsys.readouterr().out
    assert f"{file}: " in told
    assert " frames of 3 operations, " in told
    blank, holes, _, slot = (
        np.array([s for s, _ in shares(file, rgb(c))])
        for c in class_colours((BLANK, "through holes", "blind holes", "slot"))
    )
    picture = Image.open(file)
    assert f"{file}: {picture.n_frames} frames" in told
    assert blank[0] > 0.1
    assert holes[0] < 1e-3  # in the legend
    assert holes[0] < holes[1] < holes[-1]
    assert slot[-1] > 0.01 > 10.0 * slot[-4]
    assert [f.name for f in file.parent.iterdir()] == ["cut.webp"]


def test_what_cannot_be_is_refused(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def told(*arguments):
        assert main([*ASKED, *arguments]) == 2
        return capsys.readouterr().err

    assert "an animation's name ends in .webp" in told("--out", str(tmp_path / "cut.gif"))
    assert "the blank is only 12 mm wide" in told("--pitch-mm", "30")
    assert "--pitch-mm 0.001 makes" in told("--pitch-mm", "0.001")
    assert "--frames 100000000: pictures that need about" in told("--frames", "100000000")
    assert main(["animate", "gouge-sizes"]) == 2
    assert "cuts no part" in capsys.readouterr().err
    monkeypatch.setattr(sys, "executable", "/bin/false")
    out = tmp_path / "cut.webp"
    assert "cannot draw cut.webp: 3D pictures: the drawing process ended with code 1" in told("--out", str(out))
    assert list(tmp_path.iterdir()) == []


def test_a_pitch_is_a_number(capsys):
    with pytest.raises(SystemExit):
        main(["animate", "drill-grid", "--pitch-mm", "fine"])
    assert "expected a number from 0.001 to 1000" in capsys.readouterr().err


def test_a_saved_stock_is_seen_by_its_own_rays(tmp_path, capsys):
    """Between them its surface is only joined, which is no body to send others through."""
    stock = tmp_path / "stock.parquet"
    only = ["--no-pictures", "--only", stock.name, "--out", str(tmp_path)]
    assert main(["run", "drill-grid", "--set", "stock.pitch_mm=2.0", *only]) == 0
    saved = ["--set", f'stock.blank={{kind="saved", file="{stock}"}}', "--set", "stock.pitch_mm=2.0"]
    assert main(["animate", "drill-grid", *saved, "--pitch-mm", "2.3"]) == 2
    assert "--pitch-mm 2.3: the saved stock's rays are 2 mm apart" in capsys.readouterr().err
    job = plan(*load_scene("drill-grid", saved[1::2]))
    way = way_of(job, Namespace(pitch_mm=None, frames=2), tmp_path)
    first = next(iter(way.stages(Workshop("cpu"))))
    assert first.stock is way.saved
    frame = next(iter(frames(way, [first])))
    assert frame.text == f"the blank, {np.mean(way.saved.volumes):,.0f} mm3"
    names = frame.shapes[0].colours["operation"].names
    assert names[:4] == ("blank", "through holes", "blind holes", "slot")
    assert len(set(names)) == len(names) == 7
    y, z = (k.ravel() for k in np.meshgrid(np.arange(0.013, 40.0, 0.2), np.arange(-11.987, 0.0, 0.2)))
    way.blank.chords(np.column_stack([0.0 * y - 5.0, y, z]), np.tile([1.0, 0.0, 0.0], (len(y), 1)))  # none is refused


def test_what_is_turned_away_is_no_picture(tmp_path, capsys):
    turned = "stock.turning={outline_mm=[[200, -12], [235, -12], [235, 0], [200, 0]]}"
    assert main([*ASKED, "--set", turned, "--out", str(tmp_path / "cut.webp")]) == 2
    assert "nothing of the blank is there to be cut once it is turned" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
