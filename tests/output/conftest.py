import pytest

from gearsim.output.files import staged
from gearsim.output.write import write_result
from gearsim.processes.run import run

SMALL = (
    "metrology.rows=5", "metrology.columns=17", "metrology.convergence=[9, 17]", "simulation.dexel_pitch_mm=0.6",
    "toolpath.points=33",
)  # fmt: skip


@pytest.fixture(scope="session")
def result():
    return run("spiral-bevel-flank", overrides=SMALL)


@pytest.fixture(scope="session")
def folder(result, tmp_path_factory):
    out = tmp_path_factory.mktemp("out")
    with staged(out) as stage:
        assert write_result(result, stage) == []
    return out


@pytest.fixture
def texts(monkeypatch):
    """Texts of the figures that are saved, as [(text, box in pixels)]; the file is not written."""
    from matplotlib.text import Text

    seen = []

    def look(figure, *_):
        figure.draw_without_rendering()
        unseen = set()
        for axis in (axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)):
            low, high = sorted(axis.get_view_interval())
            unseen |= {t.label1 for t in axis.get_major_ticks() if not low <= t.get_loc() <= high}
            unseen |= {t.label2 for t in axis.get_major_ticks() if not low <= t.get_loc() <= high}
        shown = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip() and t not in unseen]
        seen.append([(t.get_text(), t.get_window_extent()) for t in shown])
        page = figure.bbox
        outside = [t for t, b in seen[-1] if min(b.x0, b.y0) < 0 or b.x1 > page.x1 or b.y1 > page.y1]
        assert not outside

    monkeypatch.setattr("gearsim.output.saving.draw_png", look)
    return seen
