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
