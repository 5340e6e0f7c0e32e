"""What scenes of every kind have: name, numerical settings, and the whole part as stock where it is asked for."""

from __future__ import annotations

from collections.abc import Callable

from pydantic import Field

from gearsim.scene.stock import StockTable
from gearsim.scene.tables import FileName, Table


class SceneHeader(Table):
    """Table [scene]: what the scene is called and shows."""

    name: FileName
    summary: str = ""


class SimulationTable(Table):
    """Table [simulation]: numerical settings of the removal road."""

    tolerance_mm: float = Field(default=1e-9, ge=1e-12, le=1e-2)
    compile_tolerance_mm: float = Field(default=1e-9, ge=1e-12, le=1e-2)
    interval_slots: int = Field(default=16, ge=1, le=256)
    dexel_pitch_mm: float = Field(default=0.15, gt=0.0, le=10.0)


class Scene(Table):
    """A job: the surface wanted, the cutter, the toolpath, and how it is simulated and measured."""

    scene: SceneHeader
    simulation: SimulationTable = SimulationTable()
    stock: StockTable | None = None

    @property
    def name(self) -> str:
        return self.scene.name

    def builders(self) -> tuple[Callable[[], object], ...]:
        """What is built from the tables; each raises InputError where the geometry is impossible."""
        raise NotImplementedError
