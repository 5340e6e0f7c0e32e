"""Tables that scenes of every kind share, and the kinds of numbers that stand in them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Length = Annotated[float, Field(gt=0.0, lt=1e5, allow_inf_nan=False)]
LengthOrZero = Annotated[float, Field(ge=0.0, lt=1e5, allow_inf_nan=False)]
Angle = Annotated[float, Field(ge=5.0, le=45.0, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=2, le=4097)]


class Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=False)


class SceneHeader(Table):
    """Table [scene]: what the scene is called and shows."""

    name: str = Field(min_length=1)
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

    @property
    def name(self) -> str:
        return self.scene.name

    def builders(self) -> tuple[Callable[[], object], ...]:
        """What is built from the tables; each raises InputError where the geometry is impossible."""
        raise NotImplementedError
