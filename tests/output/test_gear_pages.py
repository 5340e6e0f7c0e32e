"""Gear charts: every page is drawn, at any size of deviation, and no two texts lie over each other."""

import numpy as np
import pytest

from gearsim.metrology.gear_inspection import FlankMap
from gearsim.metrology.roughness import measure_roughness
from gearsim.output.gear.pitch import draw_pitch
from gearsim.output.gear.roughness import draw_roughness
from gearsim.output.gear.sheet import inspection_sheet
from gearsim.output.gear.style import evenly, unit_for
from gearsim.output.gear.topography import draw_topography
from gearsim.output.gear.traces import draw_traces
from gearsim.output.rounding import round_below
from gearsim.output.saving import Save
from tests.metrology.gears import gear_of, inspection
from tests.output.pages import overlaps

CASES = [(15, 10.0, 1.0), (-30, -10.0, 1e-3), (15, 0.0, 8.0)]


@pytest.mark.parametrize(("teeth", "helix_deg", "size"), CASES)
def test_no_text_lies_over_another(teeth, helix_deg, size, texts, tmp_path):
    found = inspection(gear_of(teeth, helix_deg), size, missing=teeth < 0)
    draw_traces(found.profile, found.gear, found.tolerances_um, "profile", "a.png", Save(tmp_path))
    draw_traces(found.helix, found.gear, found.tolerances_um, "helix", "b.png", Save(tmp_path))
    draw_pitch(found.pitch, found.runout, found.tolerances_um, "pitch", Save(tmp_path))
    inspection_sheet(found, Save(tmp_path))
    for page in texts:
        assert not list(overlaps(page))
    unit = "nm" if size < 0.01 else "µm"
    assert any(f"[{unit}]" in text for text, _ in texts[0])
    written = {text for text, _ in texts[3]}
    assert {"Profile", "Helix", "Pitch", "class 6"} <= written
    assert ("2 missing" in written) == (teeth < 0)


def test_pages_are_written(tmp_path):
    from matplotlib.image import imread

    gear = gear_of()
    found = inspection(gear)
    inspection_sheet(found, Save(tmp_path))
    span = found.profile["left"].span
    position, z = np.linspace(span.first, span.last, 21), np.linspace(-9.5, -0.5, 31)
    um = 2e-3 * np.sin(z)[None, :] * span.share(position)[:, None]
    um[3, 4] = np.nan
    maps = {side: FlankMap(side, 0, position, z, um) for side in ("left", "right")}
    draw_topography(maps, gear, "topography", Save(tmp_path))
    x = np.linspace(0.0, 9.0, 901)
    traces = {
        "helix": measure_roughness(x, np.abs(np.sin(4.0 * x)), 1),
        "profile": measure_roughness(x[:300], np.abs(np.sin(4.0 * x[:300])), 2),
        "nothing": measure_roughness(x, np.full(901, np.nan), 1),
    }
    draw_roughness(traces, "roughness", Save(tmp_path))
    for name in ("inspection", "topography", "roughness"):
        picture = imread(tmp_path / f"{name}.png")[..., :3]
        assert picture.shape[0] > 800
        assert picture.std() > 0.05


def test_an_unmeasured_gear_can_be_drawn(tmp_path, texts):
    found = inspection(gear_of())
    for traces in (*found.profile.values(), *found.helix.values()):
        traces.deviation_um[:] = np.nan
    for pitch in found.pitch.values():
        pitch.single_um[:], pitch.cumulative_um[:] = np.nan, np.nan
    inspection_sheet(found, Save(tmp_path))
    assert not list(overlaps(texts[0]))
    assert sum(text == "not measured" for text, _ in texts[0]) == 16


@pytest.mark.parametrize(
    ("um", "texts_", "name"),
    [
        ([31.64, -2.0], ["31.6", "−2.0"], "µm"), ([3.2], ["3.20"], "µm"), ([0.2], ["200"], "nm"),
        ([0.0123], ["12.3"], "nm"), ([1e-9, np.nan], ["0.00", "–"], "nm"), ([349.1], ["349"], "µm"),
    ],
)  # fmt: skip
def test_numbers_have_three_digits_in_a_unit_that_fits(um, texts_, name):
    unit = unit_for(um)
    assert [unit.text(v) for v in um] == texts_
    assert unit.name == name


def test_round_lengths_and_even_choices():
    assert [round_below(v) for v in (1.0, 1.9, 2.0, 4.9, 7.3, 0.012)] == pytest.approx([1, 1, 2, 2, 5, 0.01])
    assert evenly(15, 4) == [0, 3, 7, 11]
    assert evenly(3, 4) == [0, 1, 2]


def test_perfect_pitches_stand_in_the_tolerance_band(texts, tmp_path, monkeypatch):
    from gearsim.output import saving

    found, limits = inspection(gear_of()), []
    for pitch in found.pitch.values():
        pitch.single_um[:], pitch.cumulative_um[:] = 1e-10, 0.0
    look = saving.draw_png
    monkeypatch.setattr(saving, "draw_png", lambda f, *a: (limits.extend(x.get_ylim() for x in f.axes), look(f, *a)))
    draw_pitch(found.pitch, found.runout, found.tolerances_um, "pitch", Save(tmp_path))
    expected = [found.tolerances_um[name] for name in ("f_p", "f_p", "F_p", "F_p")]
    assert np.allclose([high for _, high in limits], 1.2 * np.array(expected))
    assert sum(text == "[µm]" for text, _ in texts[0]) == 4


def test_perfect_traces_stand_in_the_tolerance_band(texts, tmp_path):
    found = inspection(gear_of())
    for traces in found.helix.values():
        traces.deviation_um[:] = 1e-10
    draw_traces(found.helix, found.gear, found.tolerances_um, "helix", "a.png", Save(tmp_path))
    written = [text for text, _ in texts[0]]
    assert sum(text in ("1 µm", "2 µm", "5 µm", "10 µm") for text in written) == 2  # the scale bars
    assert any("(band)" in text for text in written)
    assert not any("[nm]" in text and "mean" not in text for text in written)


def test_flat_roughness_is_told_not_drawn(texts, tmp_path):
    x = np.linspace(0.0, 9.0, 901)
    rough, flat = measure_roughness(x, np.abs(np.sin(4.0 * x)), 1), measure_roughness(x, 0.0 * x, 1)
    draw_roughness({"a": rough, "b": flat, "c": flat}, "roughness", Save(tmp_path))
    draw_roughness({"b": flat}, "roughness", Save(tmp_path))
    assert {"a", "flat to 0.1 nm, not drawn: b; c"} <= {text for text, _ in texts[0]}
    assert "b" not in {text for text, _ in texts[0]}
    assert [text for text, _ in texts[1]][-1] == "flat to 0.1 nm, not drawn: b"
    assert not any(list(overlaps(page)) for page in texts)
