"""Table [cutter]: every tool of the catalogue, its keys taken from the catalogue function's parameters."""

from __future__ import annotations

from collections.abc import Callable
from inspect import Parameter, signature
from math import radians
from typing import Annotated, Any, Literal, Union

from pydantic import Field, create_model

from gearsim.cutters.catalogue import CUTTERS
from gearsim.cutters.profile import Profile
from gearsim.scene.tables import Table

_Length = Annotated[float, Field(ge=0.0, lt=1e5, allow_inf_nan=False)]
_Angle = Annotated[float, Field(gt=-90.0, lt=90.0, allow_inf_nan=False)]
_ANGLES = {"alpha", "beta", "taper", "psi_u", "psi_l"}


class CutterTable(Table):
    """A tool of the catalogue; lengths end in ``_mm``, angles in ``_deg``."""

    kind: str

    def build(self) -> Profile:
        """The tool's profile. Raises InputError where the parameters are impossible."""
        make = CUTTERS[self.kind]
        return make(**{name: _inside(getattr(self, key), key) for name, key in _keys(make).items()})


def _keys(make: Callable[..., Profile]) -> dict[str, str]:
    """The table's key of every parameter of a catalogue function."""
    names = [p for p in signature(make).parameters if p != "name"]
    return {n: f"{n}_deg" if n in _ANGLES or n.endswith("angle") else f"{n}_mm" for n in names}


def _inside(value: float, key: str) -> float:
    return radians(value) if key.endswith("_deg") else value


def _table(kind: str) -> type[CutterTable]:
    make = CUTTERS[kind]
    fields: dict[str, Any] = {"kind": (Literal[kind], ...)}
    for name, key in _keys(make).items():
        default = signature(make).parameters[name].default
        needed = default is Parameter.empty
        fields[key] = (_Angle if key.endswith("_deg") else _Length, ... if needed else default)
    return create_model(f"{kind}Table", __base__=CutterTable, **fields)


CUTTER_TABLES = {kind: _table(kind) for kind in CUTTERS}
AnyCutter: Any = Annotated[Union[tuple(CUTTER_TABLES.values())], Field(discriminator="kind")]  # noqa: UP007
