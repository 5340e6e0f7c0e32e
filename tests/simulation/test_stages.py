"""A part on its way: every stage is the true stock, whatever is cut later."""

import numpy as np
import pytest

from gearsim.metrology.stock_check import StockInspection
from gearsim.processes.run import plan
from gearsim.scene import load_scene
from gearsim.simulation.stages import Way, axis_end, even_stops, tip_end
from gearsim.simulation.stock import blank_stock, cut_stock
from gearsim.simulation.workshop import Workshop


@pytest.fixture(scope="module")
def way():
    job = plan(*load_scene("drill-grid", ["stock.pitch_mm=2.3"]))
    asked = next(i for i in job.inspections if isinstance(i, StockInspection))
    operations = asked.operations(job)
    return Way(asked.blank, asked.box, operations, even_stops(operations, 9))


def ends(stock):
    return np.concatenate([np.concatenate([k.lo, k.hi]) for k in stock.left])


def test_stages_are_what_their_rows_leave(way):
    workshop = Workshop("cpu")
    found = list(way.stages(workshop))
    assert len(found) == len(way)
    assert (found[0].operation, found[0].rows, found[0].stock.done) == (-1, 0, ())
    volumes = np.array([stage.stock.volumes for stage in found])
    assert np.all(np.diff(volumes, axis=0) <= 1e-9)
    for stage in (found[3], found[-1]):  # within the first operation, and at the end
        whole = [*way.operations[: stage.operation], way.operations[stage.operation].part(np.arange(stage.rows))]
        at_once = cut_stock(blank_stock(way.box, way.blank), whole, workshop)
        assert np.abs(ends(stage.stock) - ends(at_once)).max() < 2e-9
        assert stage.stock.done == at_once.done
        assert stage.contour.mesh.open_edges == 0
    assert 0 < found[3].rows < len(way.operations[0])
    assert [d.name for d in found[-1].stock.done] == ["through holes", "blind holes", "slot"]


def test_stops_end_with_every_operation_and_lie_evenly_along_the_feed(way):
    for operation, stops in zip(way.operations, way.stops, strict=True):
        assert stops[-1] == len(operation)
        assert np.all(np.diff(stops) > 0)
    many = even_stops(way.operations, 10_000)
    assert max(map(len, many)) <= max(map(len, way.operations))
    slot = way.operations[-1]
    assert tip_end(slot)[~slot.rapid][-1] == pytest.approx([64.0, 20.0, -3.0])
    assert tip_end(slot, -1.0)[~slot.rapid][-1] == pytest.approx([-4.0, 20.0, -3.0])
    assert np.allclose(axis_end(slot), [0.0, 0.0, 1.0], atol=1e-12)
